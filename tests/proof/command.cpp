// SPDX-License-Identifier: MIT
#include "tests/proof/command.hpp"

#include <sys/wait.h>

#include <array>
#include <cstdio>

namespace dampline::proof {

CommandResult run_command(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) return {-1, {}};
  std::string output;
  std::array<char, 4096> chunk{};
  while (const std::size_t got = std::fread(chunk.data(), 1, chunk.size(), pipe)) {
    output.append(chunk.data(), got);
  }
  const int ended = ::pclose(pipe);
  return {WIFEXITED(ended) ? WEXITSTATUS(ended) : -1, output};
}

}  // namespace dampline::proof
