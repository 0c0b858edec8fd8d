// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <exception>
#include <functional>

#include "app/error.hpp"
#include "app/run/run_toml.hpp"
#include "app/verbs/config.hpp"
#include "app/verbs/explain.hpp"
#include "app/verbs/export.hpp"
#include "app/verbs/identify.hpp"
#include "app/verbs/report.hpp"
#include "app/verbs/simulate.hpp"
#include "app/verbs/verify.hpp"

namespace {

constexpr int kRunFailed = 1;
constexpr int kWrongUsage = 2;

int fail(const char* text, int code) {
  fmt::print(stderr, "dampline: error: {}\n", text);
  return code;
}

int run(const std::function<int()>& action) {
  try {
    const int code = action();
    // A full disk or a closed pipe behind standard output is a failed run, not a success.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      return fail("standard output cannot be written", kRunFailed);
    return code;
  } catch (const dampline::app::UsageError& error) {
    return fail(error.what(), kWrongUsage);
  } catch (const std::exception& error) {
    return fail(error.what(), kRunFailed);
  }
}

}  // namespace

int main(int argc, char** argv) {
  // Both are reported where the write fails, with the file's name.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);

  CLI::App program{
      "Identifies how a freight-car truck dissipates energy, from accelerometers in service"};
  program.name("dampline");
  program.set_version_flag("--version", "dampline " + dampline::app::version());
  program.require_subcommand(1);
  std::function<int()> action;
  dampline::app::add_identify_verb(program, action);
  dampline::app::add_explain_verb(program, action);
  dampline::app::add_simulate_verb(program, action);
  dampline::app::add_report_verb(program, action);
  dampline::app::add_export_verb(program, action);
  dampline::app::add_verify_verb(program, action);
  dampline::app::add_config_verb(program, action);
  try {
    program.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? 0 : kWrongUsage;
  }
  return run(action);
}
