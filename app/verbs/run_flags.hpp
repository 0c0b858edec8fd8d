// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "app/config/config.hpp"
#include "app/report/page.hpp"
#include "app/run/directory.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app {

/// Of the verbs that make a run directory.
struct RunFlags {
  std::string config;
  std::string out;
  bool json{false};
  bool quiet{false};
  bool force{false};
  bool no_report{false};
  bool strict{false};

  /// Where the run goes that was made of `source`.
  [[nodiscard]] std::filesystem::path place(const std::string& source) const {
    if (!out.empty()) return out;
    return free_run_name(std::filesystem::current_path(),
                         source == "-" ? "stdin" : std::filesystem::path{source}.stem().string());
  }
  /// What the last line on the terminal names.
  [[nodiscard]] std::string outcome(const std::filesystem::path& place) const {
    return drivers::printable((no_report ? place : place / "report.html").string());
  }
  [[nodiscard]] bool show_progress() const { return !quiet && ::isatty(STDERR_FILENO) == 1; }
  [[nodiscard]] Config load() const { return config.empty() ? Config{} : load_config(config); }
  void write(const RunFiles& files, RunDirectory& directory) const {
    stage_files(files, directory);
    if (!no_report) stage_report(files, directory);
    directory.commit();
  }
  /// The exit code. What is not shown is said on the standard error.
  [[nodiscard]] int verdict(const RunResult& result) const {
    constexpr int kNotTrusted = 3;
    if (result.trust == Trust::kTrusted) return 0;
    if (json || quiet || strict)
      warn(fmt::format("{}: {}", name_of(result.trust), fmt::join(result.trust_reasons, " ")));
    return strict ? kNotTrusted : 0;
  }
  void add_strict(CLI::App& verb) {
    verb.add_flag("--strict", strict, "end with 3 where the result is not to be trusted");
  }
};

}  // namespace dampline::app
