// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/run/result.hpp"

namespace dampline::app {

/// gnuplot scripts with their data, to which the terminal is still to be set. Empty where the
/// result has nothing to draw.
struct PlotScript {
  std::string script;
  int width{960};
  int height{420};
};

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

}  // namespace dampline::app
