// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/run/result.hpp"

namespace dampline::app {

// The tables of a run directory as CSV text with a header, and back. Times are in seconds from the
// beginning of the record. The readers throw RunError naming `origin` and the line.

/// Of ResidualRow, LoopRow, LawRow, MotionRow, ForceRow, Excluded, RunEvent, LatenessRow, TermSet.
template <class Row>
[[nodiscard]] std::string to_csv(const std::vector<Row>& rows);
template <class Row>
[[nodiscard]] std::vector<Row> read_table(std::string_view text, const std::string& origin);

/// curve.csv: after the curve itself a force and its deviation for each of `methods`.
[[nodiscard]] std::string to_csv(const std::vector<CurveRow>& curve,
                                 const std::vector<MethodSummary>& methods);
[[nodiscard]] std::string to_csv(const std::vector<DensityTable>& densities);
[[nodiscard]] std::string to_csv(const Convergence& convergence);
/// cov.csv; `parameters` names the columns.
[[nodiscard]] std::string to_csv(const std::vector<CovRow>& rows,
                                 const std::vector<Parameter>& parameters);
[[nodiscard]] std::string to_csv(const std::vector<PredictedRow>& prediction);

/// Fills the curve, and the curves of the methods of `result`, which are there already.
void read_curve(std::string_view text, const std::string& origin, RunResult& result);
[[nodiscard]] std::vector<DensityTable> read_densities(std::string_view text,
                                                       const std::string& origin);
[[nodiscard]] Convergence read_convergence(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<CovRow> read_cov(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<PredictedRow> read_prediction(std::string_view text,
                                                        const std::string& origin);

}  // namespace dampline::app
