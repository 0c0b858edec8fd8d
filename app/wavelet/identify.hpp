// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/result.hpp"
#include "app/wavelet/equations.hpp"
#include "app/wavelet/measured.hpp"

namespace dampline::app::wavelet {

/// What a user sets.
struct Settings {
  MeasuredOptions record;
  std::vector<std::string> terms;  ///< one text, or one of each element
  std::vector<double> mass_kg;     ///< empty: not known
  Wavelet wavelet{Wavelet::kD8};
  std::optional<int> level;  ///< absent: by level_for()
  std::size_t window_rows{0};
  bool gated{true};
  bool compares{false};
};

/// Of the levels at which a period of the motion still has 12 steps, of D6 24, the one where
/// deviations and the difference to another wavelet are least; where rows may not reach across
/// reversals, of those that fit between them. question.level is not looked at.
[[nodiscard]] int level_for(const Measured& measured, const Question& question);

/// Reads the record, fits the terms, and puts the result into the words of a run. Throws UsageError
/// for settings that contradict each other, RunError for the record.
[[nodiscard]] RunResult identify(const Config& config, const Settings& settings);

/// The terminal's table: term, estimate, deviation, unit, t, COV; errors; term sets.
[[nodiscard]] std::string table_of(const RunResult& result);

}  // namespace dampline::app::wavelet
