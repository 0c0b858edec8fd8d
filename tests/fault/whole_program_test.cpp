// SPDX-License-Identifier: MIT
// Some of what tests/fault/calls does with every system call.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

namespace dampline::fault {
namespace {

#if defined(__x86_64__) && !defined(DAMPLINE_SANITIZED)

TEST(WholeProgram, EndsWellOrSaysWhyWhateverCallFails) {
  const std::string command = DAMPLINE_SOURCE_DIR
      "/tests/fault/calls all --sample 12 --jobs 1 "
      "--build '" DAMPLINE_BINARY_DIR "'";
  const int status = std::system(command.c_str());  // NOLINT(cert-env33-c) a test's own script
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

#endif

}  // namespace
}  // namespace dampline::fault
