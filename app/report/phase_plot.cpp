// SPDX-License-Identifier: MIT
#include "app/report/phase_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace dampline::app {
namespace {

constexpr int kShades = 12;

/// A channel as it is drawn.
struct Channel {
  const char* label;
  double factor;  // from the unit of the data
  double PhasePoint::*of;
};
constexpr Channel kDeflection{"y (mm)", 1e3, &PhasePoint::deflection_m};
constexpr Channel kVelocity{"v (mm/s)", 1e3, &PhasePoint::velocity_mps};
constexpr Channel kAccel{"y'' (m/s\u00b2)", 1.0, &PhasePoint::accel_mps2};

struct Plane {
  const PhasePicture& picture;
  Channel x, y;
};

/// Cells from `first` to `last` along an axis.
struct Cells {
  std::size_t first{kPictureCells}, last{0};
  void add(std::size_t i) {
    first = std::min(first, i);
    last = std::max(last, i);
  }
  /// With one empty cell around, where there is one.
  [[nodiscard]] std::pair<double, double> range(double low, double high) const {
    const double cell = (high - low) / kPictureCells;
    const auto begin = static_cast<double>(first == 0 ? 0 : first - 1);
    const auto end = static_cast<double>(std::min(last + 2, kPictureCells));
    return {low + begin * cell, low + end * cell};
  }
};

double largest(const PhasePicture& p) {
  float most = 0.0F;
  for (const auto& column : p.density)
    most = std::max(most, *std::max_element(column.begin(), column.end()));
  return static_cast<double>(most);
}

/// Cells of the same shade in one path. The shade follows the root of the density, so that the
/// rare parts are seen as well.
void add_cells(const Plane& plane, svg::Panel& panel) {
  const PhasePicture& p = plane.picture;
  std::array<std::vector<svg::Box>, kShades> shades;
  const double most = largest(p);
  const double width = (p.x_high - p.x_low) / kPictureCells;
  const double height = (p.y_high - p.y_low) / kPictureCells;
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      const double share = static_cast<double>(p.density[i][j]) / most;
      if (!(share > 0.0)) continue;
      const int shade = std::min(static_cast<int>(std::sqrt(share) * kShades), kShades - 1);
      const auto x = [&](std::size_t cell) {
        return plane.x.factor * (p.x_low + static_cast<double>(cell) * width);
      };
      const auto y = [&](std::size_t cell) {
        return plane.y.factor * (p.y_low + static_cast<double>(cell) * height);
      };
      shades.at(static_cast<std::size_t>(shade)).push_back({x(i), x(i + 1), y(j), y(j + 1)});
    }
  }
  for (int shade = 0; shade < kShades; ++shade)
    panel.boxes(shades.at(static_cast<std::size_t>(shade)), svg::Ink::kBlue,
                0.08 + 0.92 * (shade + 1.0) / kShades);
}

std::vector<svg::Point> section_points(const PhaseSnapshot& s, const Plane& plane) {
  std::vector<svg::Point> out;
  for (std::size_t phase = 0; phase < kSectionPhases; ++phase)
    for (std::size_t i = 0; i < s.section_count[phase]; ++i) {
      const PhasePoint& p = s.section[phase][i];
      out.push_back({plane.x.factor * p.*plane.x.of, plane.y.factor * p.*plane.y.of});
    }
  return out;
}

std::string refusal(const PhasePicture& p) {
  switch (p.state) {
    case PictureState::kEmpty:
      return "no motion in the record";
    case PictureState::kConstant:
      return "a channel that does not vary";
    case PictureState::kClipped:
      return fmt::format("{:.1f} % of the samples outside", 100.0 * p.outside_share);
    case PictureState::kGood:
      break;
  }
  return "";
}

/// The part of the picture that holds anything.
std::pair<svg::Axis, svg::Axis> axes_of(const Plane& plane) {
  const PhasePicture& p = plane.picture;
  Cells columns;
  Cells rows;
  for (std::size_t i = 0; i < kPictureCells; ++i)
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      if (!(p.density[i][j] > 0.0F)) continue;
      columns.add(i);
      rows.add(j);
    }
  const auto [x_low, x_high] = columns.range(p.x_low, p.x_high);
  const auto [y_low, y_high] = rows.range(p.y_low, p.y_high);
  return {{plane.x.label, plane.x.factor * x_low, plane.x.factor * x_high},
          {plane.y.label, plane.y.factor * y_low, plane.y.factor * y_high}};
}

svg::Panel phase_panel(const PhaseSnapshot& s, const Plane& plane) {
  constexpr double kSquare = 400.0;
  const PhasePicture& p = plane.picture;
  const std::string reason = refusal(p);
  const bool drawn = p.state == PictureState::kGood ||
                     (p.state == PictureState::kClipped && p.outside_share < 1.0);
  if (!drawn) {
    svg::Panel empty{{plane.x.label}, {plane.y.label}, kSquare};
    empty.title(reason);
    return empty;
  }
  auto [x, y] = axes_of(plane);
  svg::Panel panel{std::move(x), std::move(y), kSquare};
  panel.title(reason);
  add_cells(plane, panel);
  panel.dots(section_points(s, plane), svg::Ink::kOrange, 1.8);
  return panel;
}

}  // namespace

Plot plot_phase(const PhaseSnapshot& s) {
  return {{phase_panel(s, {s.velocity_over_deflection, kDeflection, kVelocity}),
           phase_panel(s, {s.accel_over_deflection, kDeflection, kAccel}),
           phase_panel(s, {s.accel_over_velocity, kVelocity, kAccel})},
          true};
}

std::string describe_period(const PhaseSnapshot& s) {
  const Period& p = s.period;
  const char* whose = s.period_is_known ? "the given period" : "a period";
  switch (p.state) {
    case PeriodState::kNotEnough:
      return fmt::format("The record is too short to tell whether the motion has {}.", whose);
    case PeriodState::kNoMotion:
      return "Nothing moves: there is no period to look for.";
    case PeriodState::kNone:
      return fmt::format("The motion does not have {}: no sections.", whose);
    case PeriodState::kFound:
      break;
  }
  return fmt::format(
      "Sections at {} phases of the period {:.5g} s (standard deviation {:.1g} s; {:.0f} % of the "
      "velocity's variance is periodic, confidence {:.3f}).",
      kSectionPhases, p.period_s, p.period_std_s, 100.0 * p.height, p.confidence);
}

}  // namespace dampline::app
