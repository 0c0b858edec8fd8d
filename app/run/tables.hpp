// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/run/result.hpp"

namespace dampline::app {

/// The tables of a run directory as CSV text with a header, and back. Times are in seconds from the
/// beginning of the record. The readers throw RunError naming `origin` and the line.
/// curve.csv: after the curve itself a force and its deviation for each of `methods`.
[[nodiscard]] std::string to_csv(const std::vector<CurveRow>& curve,
                                 const std::vector<MethodSummary>& methods);
[[nodiscard]] std::string to_csv(const std::vector<DensityTable>& densities);
[[nodiscard]] std::string to_csv(const Convergence& convergence);
[[nodiscard]] std::string to_csv(const std::vector<MotionRow>& motion);
[[nodiscard]] std::string to_csv(const std::vector<ForceRow>& force);
[[nodiscard]] std::string to_csv(const std::vector<Excluded>& excluded);
[[nodiscard]] std::string to_csv(const std::vector<RunEvent>& events);
[[nodiscard]] std::string to_csv(const std::vector<LatenessRow>& lateness);

/// Fills the curve, and the curves of the methods of `result`, which are there already.
void read_curve(std::string_view text, const std::string& origin, RunResult& result);
[[nodiscard]] std::vector<DensityTable> read_densities(std::string_view text,
                                                       const std::string& origin);
[[nodiscard]] Convergence read_convergence(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<MotionRow> read_motion(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<ForceRow> read_force(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<Excluded> read_excluded(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<RunEvent> read_events(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<LatenessRow> read_lateness(std::string_view text,
                                                     const std::string& origin);

}  // namespace dampline::app
