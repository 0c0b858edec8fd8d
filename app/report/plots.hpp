// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/report/gnuplot.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// The damping curve with its band, and below it how many samples support each part.
[[nodiscard]] PlotScript plot_curve(const RunResult& result);
/// The same curve as other methods see it; what is not to be trusted is grey.
[[nodiscard]] PlotScript plot_methods(const RunResult& result);
/// Densities of deflection and velocity.
[[nodiscard]] PlotScript plot_densities(const RunResult& result);
/// Every followed parameter over time, with its band.
[[nodiscard]] PlotScript plot_convergence(const RunResult& result);
/// Deflection and velocity: an excerpt.
[[nodiscard]] PlotScript plot_motion(const RunResult& result);
/// A rig's measured and fitted force over velocity and over time: an excerpt.
[[nodiscard]] PlotScript plot_force(const RunResult& result);
/// One row per kind of event over the whole record.
[[nodiscard]] PlotScript plot_events(const RunResult& result);
/// One row per reason over the whole record.
[[nodiscard]] PlotScript plot_excluded(const RunResult& result);
/// How late the frames of a live run were, with p50 to the largest written in.
[[nodiscard]] PlotScript plot_lateness(const RunResult& result);
/// One row per fault and channel over the whole record: what it spoils, and where it was seen.
[[nodiscard]] PlotScript plot_faults(const RunResult& result);

// Of an explanation.

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

}  // namespace dampline::app
