// SPDX-License-Identifier: MIT
// Runs side by side: what each found, and how far it is from the first.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/result.hpp"

namespace dampline::app::compare {

/// What a comparison needs of a run directory.
struct Run {
  std::string name;  ///< as given
  RunResult result;
  Config config;
};

/// Reads the runs. Throws RunError naming the run that cannot be read, or that cannot be compared
/// with the first, with the reason: a rig with a truck, another basis of the statistics (rate,
/// drift filter, curve nodes, windows), another stated mass, another method, another unit.
[[nodiscard]] std::vector<Run> read_runs(const std::vector<std::string>& directories);

/// The friction level: "coulomb", or the mean of both directions (their errors as if independent);
/// and the stiffness. None where the run has no such parameter.
[[nodiscard]] std::optional<Parameter> level_of(const RunResult& result);
[[nodiscard]] std::optional<Parameter> stiffness_of(const RunResult& result);

/// A parameter that two runs have, later minus first.
struct Difference {
  std::string name;
  std::string unit;
  double value{0.0};
  double std{0.0};         ///< both runs' together, as if independent
  double percent{0.0};     ///< of the first
  double deviations{0.0};  ///< value / std
};
[[nodiscard]] std::vector<Difference> differences(const RunResult& first, const RunResult& other);

/// What a reader must know: runs of one record, deviations that are lower bounds, other laws.
[[nodiscard]] std::vector<std::string> notes_on(const std::vector<Run>& runs);

/// A header and a row for each run: run, vehicle, truck, start, level, stiffness, law, trust.
[[nodiscard]] std::vector<std::vector<std::string>> overview(const std::vector<Run>& runs);
/// A header and a row for each run but the first; empty where no parameter is common to all.
[[nodiscard]] std::vector<std::vector<std::string>> difference_table(const std::vector<Run>& runs);

/// For the terminal.
[[nodiscard]] std::string to_text(const std::vector<Run>& runs);
/// comparison.json, "dampline.comparison/1".
[[nodiscard]] std::string to_json(const std::vector<Run>& runs);
/// One page, compare.html: the tables, level and stiffness over the date with bands.
[[nodiscard]] std::string make_page(const std::vector<Run>& runs);

}  // namespace dampline::app::compare
