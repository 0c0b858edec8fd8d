// SPDX-License-Identifier: MIT
#include "app/verbs/programs.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "app/error.hpp"
#include "app/run/provenance.hpp"

namespace dampline::app {
namespace {

/// `target` is what builds the program.
int become(const std::string& name, const char* target, char** arguments) {
  const auto folder = program_file().parent_path();
  for (const std::string& place : {name, "../libexec/dampline/" + name})
    execv((folder / place).c_str(), arguments);
  throw RunError{
      fmt::format("{0}: found no {1}/{2} and no {1}/../libexec/dampline/{2}; expected the program "
                  "that the target {3} builds, and cmake --install installs",
                  arguments[0], folder.string(), name, target)};
}

}  // namespace

void list_verify_verb(CLI::App& program) {
  program.add_subcommand("verify",
                         "Recompute published cases and print them beside the published figures");
}

int run_verify(char** arguments) { return become("dampline-verify", "dampline_verify", arguments); }

bool asks_for_method(char** arguments) {
  if (std::string_view{arguments[0]} != "identify") return false;
  for (char** argument = arguments + 1; *argument != nullptr; ++argument) {
    const std::string_view text{*argument};
    if (text == "--method" || text.starts_with("--method=")) return true;
  }
  return false;
}

bool is_rank(char** arguments) {
  if (std::string_view{arguments[0]} != "archive") return false;
  for (const char* launcher : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"})
    if (std::getenv(launcher) != nullptr) return true;
  return false;
}

int run_rank(char** arguments) {
  return become("dampline-archive-mpi", "dampline_archive_mpi", arguments);
}

int run_method(char** arguments) {
  return become("dampline-wavelet", "dampline_wavelet", arguments);
}

}  // namespace dampline::app
