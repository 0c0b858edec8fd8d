// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/report/plots.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// What an explanation shows; all of them empty for a run that explained nothing.

/// What is left before and after, over deflection, velocity, frequency and time.
[[nodiscard]] PlotScript plot_residual(const Evidence& evidence);
/// Force over velocity and over deflection: data, model before and after.
[[nodiscard]] PlotScript plot_loops(const Evidence& evidence);
/// The damping force in steady sliding, before and after.
[[nodiscard]] PlotScript plot_law(const Evidence& evidence);
/// Measured against predicted of the `record`-th record that was never fitted.
[[nodiscard]] PlotScript plot_prediction(const Evidence& evidence, std::uint32_t record);
/// How many of these records there are.
[[nodiscard]] std::uint32_t predicted_records(const Evidence& evidence);

/// Verdict, errors and what is left, as HTML.
/// The verdict and the error before and after in one sentence.
[[nodiscard]] std::string explanation_headline(const Evidence& evidence);
[[nodiscard]] std::string verdict_section(const Evidence& evidence);
/// Every candidate that was near: gain, significance, verdict.
[[nodiscard]] std::string candidate_section(const Evidence& evidence);
/// Errors on records that were never fitted.
[[nodiscard]] std::string validation_section(const Evidence& evidence);

}  // namespace dampline::app
