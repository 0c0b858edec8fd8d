// SPDX-License-Identifier: MIT
#pragma once
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace dampline::bus {

/// Status and output of a program that has ended.
struct Ended {
  int status{-1};  ///< exit code; 128 + signal when killed
  std::string output;
  std::string error;
};

/// A running program; no shell. Killed when it goes out of scope.
class Child {
 public:
  /// Throws std::system_error when there is no such program. Output goes to files in `folder`.
  Child(const std::vector<std::string>& command, const std::filesystem::path& folder);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();

  [[nodiscard]] pid_t pid() const noexcept { return pid_; }
  void signal(int number) const noexcept;
  [[nodiscard]] bool running() noexcept;
  /// Waits for the end; kills the program after `limit` of the machine's time.
  Ended wait(std::chrono::nanoseconds limit = std::chrono::hours{48});
  /// What it has printed until now.
  [[nodiscard]] std::string output() const;
  [[nodiscard]] std::string error() const;
  [[nodiscard]] const std::filesystem::path& output_file() const noexcept { return output_; }

 private:
  std::filesystem::path output_;
  std::filesystem::path error_;
  pid_t pid_{-1};
  int status_{-1};
  bool ended_{false};
};

/// Runs a program to its end. Throws when it fails, with all that it printed.
std::string run(const std::vector<std::string>& command);

/// A folder of the test's own that goes away with it.
class Folder {
 public:
  Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder();
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

[[nodiscard]] std::string read_file(const std::filesystem::path& path);

}  // namespace dampline::bus
