// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/verify/wavelet/figures.hpp"

namespace dampline::app {

[[nodiscard]] std::string text_of(const CaseFigures& figures);
[[nodiscard]] std::string text_of(const CheckGroup& group);
[[nodiscard]] std::string json_of(const WaveletFigures& figures);
/// Tables for a README: one row per table and parameter, then one per check.
[[nodiscard]] std::string markdown_of(const WaveletFigures& figures);

/// "3", "3, 4".
[[nodiscard]] std::string table_names(const std::vector<std::string>& tables);
/// "<= 4", ">= 0.1, <= 0.2", or "-" where nothing is promised.
[[nodiscard]] std::string bound_text(const Check& check);
/// As printed, or "-" where there is none.
[[nodiscard]] std::string text_of(const std::optional<Printed>& figure);

}  // namespace dampline::app
