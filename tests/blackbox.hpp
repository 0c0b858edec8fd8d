// SPDX-License-Identifier: MIT
// Black boxes for tests: frames whose content follows from their number, and what is read back.
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "drivers/blackbox/shelf.hpp"
#include "drivers/blackbox/source.hpp"
#include "drivers/blackbox/writer.hpp"

namespace dampline::test {

namespace fs = std::filesystem;

constexpr std::int64_t kSecondNs = 1'000'000'000;
constexpr std::int64_t kStartNs = 1'700'000'000 * kSecondNs;

/// Memory where there is such a file system: these tests write small files thousands of times.
inline fs::path quick_folder() {
  const fs::path memory{"/dev/shm"};
  return ::access(memory.c_str(), W_OK) == 0 ? memory : fs::temp_directory_path();
}

/// A directory that is not there yet, for the time of one test.
class BoxFolder {
 public:
  explicit BoxFolder(const fs::path& parent = quick_folder()) {
    static int number = 0;
    path_ =
        parent / ("dampline_box_" + std::to_string(::getpid()) + "_" + std::to_string(number++));
    fs::remove_all(path_);
  }
  ~BoxFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  BoxFolder(const BoxFolder&) = delete;
  BoxFolder& operator=(const BoxFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] fs::path file(std::uint32_t number) const {
    return path_ / drivers::blackbox_file_name(number);
  }
  [[nodiscard]] std::size_t files() const {
    std::error_code error;
    return drivers::list_blackbox(path_, error).size();
  }

 private:
  fs::path path_;
};

inline std::string bytes_of(const fs::path& path) {
  std::ifstream stream{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

inline void write_bytes(const fs::path& path, const std::string& bytes) {
  std::ofstream{path, std::ios::binary | std::ios::trunc}.write(
      bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The content tells the number, and the kind changes with it.
inline CanFrame numbered_frame(std::uint64_t number) {
  CanFrame frame;
  frame.time_ns = kStartNs + static_cast<std::int64_t>(number) * 1'111'000;
  frame.id = 0x310 + static_cast<std::uint32_t>(number % 3);
  frame.length = 8;
  for (std::size_t i = 0; i < 8; ++i) frame.data[i] = static_cast<std::uint8_t>(number >> (8 * i));
  frame.interface_index = number % 7 == 3 ? 1 : 0;
  frame.extended = number % 5 == 2;
  frame.time_source = number % 2 == 0 ? TimeSource::kSoftware : TimeSource::kHardware;
  if (number % 11 == 4) {
    frame.fd = true;
    frame.fd_flags = 5;
    frame.length = 24;
  }
  return frame;
}

inline std::uint64_t number_of(const CanFrame& frame) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < 8; ++i) number |= std::uint64_t{frame.data[i]} << (8 * i);
  return number;
}

inline bool same(const CanFrame& a, const CanFrame& b) {
  return a.time_ns == b.time_ns && a.id == b.id && a.length == b.length &&
         a.interface_index == b.interface_index && a.extended == b.extended &&
         a.remote == b.remote && a.error == b.error && a.fd == b.fd && a.fd_flags == b.fd_flags &&
         a.time_source == b.time_source && a.data == b.data;
}

/// True when this is a frame of ours, to the last bit: none other may ever be read.
inline bool is_true(const CanFrame& frame) { return same(frame, numbered_frame(number_of(frame))); }

inline drivers::BlackboxConfig box_config(const fs::path& directory) {
  drivers::BlackboxConfig config;
  config.directory = directory;
  config.interfaces = {"can0", "vcan10"};
  return config;
}

inline std::unique_ptr<drivers::BlackboxWriter> open_box(const drivers::BlackboxConfig& config) {
  auto opened = drivers::BlackboxWriter::open(config);
  EXPECT_TRUE(opened.ok()) << opened.error_text();
  return opened.ok() ? std::move(opened.value()) : nullptr;
}

/// Frames `first`...`first + count - 1` in files of their own, and the end.
inline void write_box(const drivers::BlackboxConfig& config, std::uint64_t first,
                      std::uint64_t count) {
  const auto writer = open_box(config);
  ASSERT_NE(writer, nullptr);
  for (std::uint64_t i = first; i < first + count; ++i) writer->write(numbered_frame(i));
  writer->close();
  ASSERT_EQ(writer->health().lost, 0U);
}

struct BoxContent {
  bool opened{false};
  Errc end{Errc::kNotReady};
  std::string error;
  std::vector<CanFrame> frames;
  std::vector<hal::Event> events;
  hal::SourceHealth health{};
  drivers::BlackboxFindings findings{};

  [[nodiscard]] bool all_true() const {
    for (const CanFrame& frame : frames)
      if (!is_true(frame)) return false;
    return true;
  }
  [[nodiscard]] std::vector<std::uint64_t> numbers() const {
    std::vector<std::uint64_t> all;
    for (const CanFrame& frame : frames) all.push_back(number_of(frame));
    return all;
  }
  [[nodiscard]] std::vector<hal::Event> of(hal::EventKind kind) const {
    std::vector<hal::Event> some;
    for (const hal::Event& event : events)
      if (event.kind == kind) some.push_back(event);
    return some;
  }
};

inline BoxContent read_box(const fs::path& path, std::size_t some = 64) {
  BoxContent content;
  auto source = drivers::BlackboxSource::open({path, {}});
  content.opened = source.ok();
  content.error = source.error_text();
  if (!source.ok()) return content;
  std::vector<CanFrame> part(some);
  for (;;) {
    const auto count = source.value()->read(part);
    if (count.ok())
      content.frames.insert(content.frames.end(), part.begin(),
                            part.begin() + static_cast<std::ptrdiff_t>(count.value()));
    hal::Event event;
    while (source.value()->next_event(event)) content.events.push_back(event);
    if (count.ok()) continue;
    content.end = count.error();
    break;
  }
  content.health = source.value()->health();
  content.findings = source.value()->findings();
  if (content.end != Errc::kEndOfStream) content.error = source.value()->error_text();
  return content;
}

/// first, first + 1, ..., first + count - 1
inline std::vector<std::uint64_t> range(std::uint64_t first, std::uint64_t count) {
  std::vector<std::uint64_t> numbers(count);
  for (std::uint64_t i = 0; i < count; ++i) numbers[i] = first + i;
  return numbers;
}

}  // namespace dampline::test
