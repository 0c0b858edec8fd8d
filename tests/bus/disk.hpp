// SPDX-License-Identifier: MIT
#pragma once
#include <sys/mount.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace dampline::bus {

/// A small file system of the test's own.
class Disk {
 public:
  explicit Disk(std::filesystem::path place, std::string size = "4m")
      : place_{std::move(place)}, options_{"size=" + size} {
    std::filesystem::create_directories(place_);
    if (::mount("tmpfs", place_.c_str(), "tmpfs", 0, options_.c_str()) != 0)
      throw std::runtime_error{"cannot mount a small file system"};
  }
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;
  ~Disk() {
    read_only(false);
    ::umount2(place_.c_str(), MNT_DETACH);
  }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return place_; }
  void fill() const {
    std::ofstream ballast{place_ / "ballast"};
    const std::string block(1U << 20U, 'x');  // the last one is written as far as there is room
    while (ballast << block << std::flush) continue;
  }
  void empty() const { std::filesystem::remove(place_ / "ballast"); }
  void read_only(bool on) const {
    const unsigned long access = on ? static_cast<unsigned long>(MS_RDONLY) : 0UL;
    ::mount("tmpfs", place_.c_str(), "tmpfs", MS_REMOUNT | access, options_.c_str());
  }

 private:
  std::filesystem::path place_;
  std::string options_;
};

}  // namespace dampline::bus
