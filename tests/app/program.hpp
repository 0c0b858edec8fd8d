// SPDX-License-Identifier: MIT
#pragma once
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace dampline::app {

/// Where the program stands: the build, or what DAMPLINE_BINARY_DIR names.
inline std::string binary_dir() {
  const char* const given = std::getenv("DAMPLINE_BINARY_DIR");
  return given != nullptr ? given : DAMPLINE_BINARY_DIR;
}

/// The program as a person runs it, in a folder of its own that goes away with it.
class Program {
 public:
  struct Outcome {
    int code{-1};
    std::string output;
    std::string error;
  };

  Program() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path{testing::TempDir()} /
              (std::string{"dampline_"} + info->test_suite_name() + "_" + info->name() + "_" +
               std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() { std::filesystem::remove_all(folder_); }

  /// Runs `dampline ARGUMENTS` by the shell, in the folder; `before` may set limits or pipe into
  /// it.
  Outcome run(const std::string& arguments, const std::string& before = "") const {
    const std::string command = "cd '" + folder_.string() + "' && " + before + " '" + binary_dir() +
                                "/dampline' " + arguments + " > .stdout 2> .stderr";
    const int status = std::system(command.c_str());  // NOLINT(cert-env33-c) a test of the program
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128, read(".stdout"), read(".stderr")};
  }
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  [[nodiscard]] bool exists(const std::string& name) const {
    return std::filesystem::exists(path(name));
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream stream{path(name), std::ios::binary};
    return {std::istreambuf_iterator<char>{stream}, {}};
  }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream{path(name), std::ios::binary} << content;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace dampline::app
