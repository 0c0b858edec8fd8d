// SPDX-License-Identifier: MIT
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/proof/command.hpp"

namespace dampline::service {

using Ended = proof::CommandResult;

/// With the standard error in the output; status 127: there is no such program.
inline Ended shell(const std::string& command) {
  return proof::run_command("{ " + command + "; } 2>&1");
}

/// For a shell; a path with a quote in it is not foreseen.
inline std::string quoted(const std::filesystem::path& path) {
  std::string text(1, '\'');
  return text.append(path.string()).append(1, '\'');
}

inline bool has_program(const std::string& name) { return shell("command -v " + name).status == 0; }

inline std::string text_of(const std::filesystem::path& path) {
  std::ifstream file{path};
  EXPECT_TRUE(file) << path << " is not there";
  return {std::istreambuf_iterator<char>{file}, {}};
}

/// A folder of the test's own that goes away with it.
class Folder {
 public:
  Folder() {
    const auto* info = testing::UnitTest::GetInstance()->current_test_info();
    path_ = std::filesystem::path{testing::TempDir()} /
            (std::string{"dampline_service_"} + info->name());
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { std::filesystem::remove_all(path_); }
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace dampline::service
