// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "app/report/svg/figure.hpp"
#include "app/run/result.hpp"

namespace dampline::app {

/// A number's unit as a plot shows it, and the factor to it: kN and MN/m where N and N/m would need
/// many digits.
struct PlotUnit {
  double factor{1.0};
  std::string name;
};
[[nodiscard]] inline PlotUnit plot_unit(const std::string& unit, double largest) {
  constexpr double kLargeN = 2e3;
  constexpr double kLargeNpm = 1e5;
  if (unit == "N" && largest >= kLargeN) return {1e-3, "kN"};
  if (unit == "N/m" && largest >= kLargeNpm) return {1e-6, "MN/m"};
  return {1.0, unit};
}

/// For the largest force of `rows`.
template <class Row>
[[nodiscard]] PlotUnit force_unit(const std::vector<Row>& rows, double Row::*force) {
  double largest = 0.0;
  for (const Row& row : rows) largest = std::max(largest, std::fabs(row.*force));
  return plot_unit("N", largest);
}

/// Every so many of `count` points of one line are drawn; more are not seen.
[[nodiscard]] inline std::size_t plot_stride(std::size_t count) {
  constexpr std::size_t kMostPoints = 3000;
  return std::max<std::size_t>(1, (count + kMostPoints - 1) / kMostPoints);
}

/// A name with blanks.
[[nodiscard]] inline std::string plot_label(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

/// The damping curve with its band, and below it how many samples support each part.
[[nodiscard]] Plot plot_curve(const RunResult& result);
/// The same curve as other methods see it; what is not to be trusted is grey.
[[nodiscard]] Plot plot_methods(const RunResult& result);
/// Densities of deflection and velocity.
[[nodiscard]] Plot plot_densities(const RunResult& result);
/// Every followed parameter over time, with its band.
[[nodiscard]] Plot plot_convergence(const RunResult& result);
/// Deflection and velocity: an excerpt.
[[nodiscard]] Plot plot_motion(const RunResult& result);
/// A rig's measured and fitted force over velocity and over time: an excerpt.
[[nodiscard]] Plot plot_force(const RunResult& result);
/// One row per kind of event over the whole record.
[[nodiscard]] Plot plot_events(const RunResult& result);
/// One row per reason over the whole record.
[[nodiscard]] Plot plot_excluded(const RunResult& result);
/// How late the frames of a live run were, with p50 to the largest written in.
[[nodiscard]] Plot plot_lateness(const RunResult& result);
/// One row per fault and channel over the whole record: what it spoils, and where it was seen.
[[nodiscard]] Plot plot_faults(const RunResult& result);

// Of a run with row_method; else nothing.

/// The estimate of each window, with the deviation that it states itself.
[[nodiscard]] Plot plot_windows(const RunResult& result);
/// Coefficients of variation over time.
[[nodiscard]] Plot plot_cov(const RunResult& result);
/// Fitted and held-out errors of the term sets.
[[nodiscard]] Plot plot_term_sets(const RunResult& result);

// Of an explanation.

/// What is left before and after, over deflection, velocity, frequency and time.
[[nodiscard]] Plot plot_residual(const Evidence& evidence);
/// Force over velocity and over deflection: data, model before and after.
[[nodiscard]] Plot plot_loops(const Evidence& evidence);
/// The damping force in steady sliding, before and after.
[[nodiscard]] Plot plot_law(const Evidence& evidence);
/// Measured against predicted of the `record`-th record that was never fitted.
[[nodiscard]] Plot plot_prediction(const Evidence& evidence, std::uint32_t record);
/// How many of these records there are.
[[nodiscard]] std::uint32_t predicted_records(const Evidence& evidence);

}  // namespace dampline::app
