// SPDX-License-Identifier: MIT
#include "app/verbs/verify.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "app/error.hpp"

namespace dampline::app {

void list_verify_verb(CLI::App& program) {
  program.add_subcommand("verify",
                         "Recompute published cases and print them beside the published figures");
}

int run_verify(char** arguments) {
  const auto folder = std::filesystem::read_symlink("/proc/self/exe").parent_path();
  for (const char* place : {"dampline-verify", "../libexec/dampline/dampline-verify"})
    execv((folder / place).c_str(), arguments);
  throw RunError{fmt::format(
      "verify: found no {0}/dampline-verify and no {0}/../libexec/dampline/dampline-verify; "
      "expected the program that the target dampline_verify builds, and cmake --install installs",
      folder.string())};
}

}  // namespace dampline::app
