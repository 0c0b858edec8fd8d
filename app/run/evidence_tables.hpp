// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "app/run/evidence.hpp"

namespace dampline::app {

/// The tables of an explanation as CSV text with a header, and back. The readers throw RunError
/// naming `origin` and the line. residual.csv, loops.csv, law.csv, prediction.csv.
[[nodiscard]] std::string to_csv(const std::vector<ResidualRow>& residual);
[[nodiscard]] std::string to_csv(const std::vector<LoopRow>& loops);
[[nodiscard]] std::string to_csv(const std::vector<LawRow>& law);
[[nodiscard]] std::string to_csv(const std::vector<PredictedRow>& prediction);

[[nodiscard]] std::vector<ResidualRow> read_residual(std::string_view text,
                                                     const std::string& origin);
[[nodiscard]] std::vector<LoopRow> read_loops(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<LawRow> read_law(std::string_view text, const std::string& origin);
[[nodiscard]] std::vector<PredictedRow> read_prediction(std::string_view text,
                                                        const std::string& origin);

}  // namespace dampline::app
