// SPDX-License-Identifier: MIT
#include "app/report/phase_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/report/gnuplot.hpp"
#include "app/report/html.hpp"

namespace dampline::app {
namespace {

constexpr double kWidth = 960.0;
constexpr double kHeight = 330.0;
constexpr double kPanel = 236.0;  // side of a panel
constexpr double kTop = 24.0;
constexpr double kFirstLeft = 62.0;
constexpr double kPitch = 318.0;
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

/// Cells from `first` to `last` along an axis, drawn between two places on the page.
struct Axis {
  double low{0.0}, high{0.0};  // in the unit that is shown
  double from{0.0}, to{0.0};   // on the page
  [[nodiscard]] double at(double value) const {
    return from + (to - from) * (value - low) / (high - low);
  }
};

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

/// 1, 2 or 5 times a power of ten: about four ticks on the axis.
double tick_step(double width) {
  const double rough = width / 4.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double digit = rough / power;
  return power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
}

std::string ticks(const Axis& axis, bool along_x, double base) {
  std::string out;
  const double step = tick_step(axis.high - axis.low);
  for (double k = std::ceil(axis.low / step); k * step <= axis.high; k += 1.0) {
    const double at = axis.at(k * step);
    const std::string label = fmt::format("{:.6g}", k * step + 0.0);
    if (along_x)
      out += fmt::format(
          "<path d='M{0:.1f} {1:.1f}v4'/><text x='{0:.1f}' y='{2:.1f}' text-anchor='middle'>{3}"
          "</text>",
          at, base, base + 17.0, label);
    else
      out += fmt::format(
          "<path d='M{1:.1f} {0:.1f}h-4'/><text x='{2:.1f}' y='{3:.1f}' text-anchor='end'>{4}"
          "</text>",
          at, base, base - 7.0, at + 4.0, label);
  }
  return out;
}

/// Cells of the same shade in one path. The shade follows the root of the density, so that the
/// rare parts are seen as well.
std::string cells(const PhasePicture& p, const Channel& cx, const Channel& cy, const Axis& x,
                  const Axis& y) {
  std::array<std::string, kShades> paths;
  const double most = largest(p);
  const double width = (p.x_high - p.x_low) / kPictureCells;
  const double height = (p.y_high - p.y_low) / kPictureCells;
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      const double share = static_cast<double>(p.density[i][j]) / most;
      if (!(share > 0.0)) continue;
      const double left = x.at(cx.factor * (p.x_low + static_cast<double>(i) * width));
      const double right = x.at(cx.factor * (p.x_low + static_cast<double>(i + 1) * width));
      const double bottom = y.at(cy.factor * (p.y_low + static_cast<double>(j) * height));
      const double top = y.at(cy.factor * (p.y_low + static_cast<double>(j + 1) * height));
      const int shade = std::min(static_cast<int>(std::sqrt(share) * kShades), kShades - 1);
      paths[static_cast<std::size_t>(shade)] +=
          fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h-{:.1f}z", left, top, right - left,
                      bottom - top, right - left);
    }
  }
  std::string out;
  for (int shade = 0; shade < kShades; ++shade) {
    const std::string& path = paths[static_cast<std::size_t>(shade)];
    if (path.empty()) continue;
    out += fmt::format("<path fill='{}' fill-opacity='{:.2f}' stroke='none' d='{}'/>", kPlotBlue,
                       0.08 + 0.92 * (shade + 1.0) / kShades, path);
  }
  return out;
}

std::string section_points(const PhaseSnapshot& s, const Plane& plane, const Axis& x,
                           const Axis& y) {
  std::string out;
  for (std::size_t phase = 0; phase < kSectionPhases; ++phase) {
    for (std::size_t i = 0; i < s.section_count[phase]; ++i) {
      const PhasePoint& p = s.section[phase][i];
      const double px = plane.x.factor * p.*plane.x.of;
      const double py = plane.y.factor * p.*plane.y.of;
      if (px < x.low || px > x.high || py < y.low || py > y.high) continue;
      out += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='1.6'/>", x.at(px), y.at(py));
    }
  }
  if (out.empty()) return out;
  return fmt::format("<g fill='{}' stroke='none' fill-opacity='0.8'>{}</g>", kPlotOrange, out);
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

std::string panel(const PhaseSnapshot& s, const Plane& plane, double left) {
  const PhasePicture& p = plane.picture;
  const double bottom = kTop + kPanel;
  std::string out = fmt::format("<rect x='{}' y='{}' width='{}' height='{}' fill='none'/>", left,
                                kTop, kPanel, kPanel);
  out += fmt::format("<text x='{}' y='{}' text-anchor='middle'>{}</text>", left + 0.5 * kPanel,
                     bottom + 38.0, escape_html(plane.x.label));
  out +=
      fmt::format("<text transform='translate({} {}) rotate(-90)' text-anchor='middle'>{}</text>",
                  left - 46.0, kTop + 0.5 * kPanel, escape_html(plane.y.label));
  const std::string reason = refusal(p);
  const bool drawn = p.state == PictureState::kGood ||
                     (p.state == PictureState::kClipped && p.outside_share < 1.0);
  if (!reason.empty())
    out += fmt::format("<text x='{}' y='{}' text-anchor='middle' style='fill:{}'>{}</text>",
                       left + 0.5 * kPanel, drawn ? kTop - 8.0 : kTop + 0.5 * kPanel, kPlotOrange,
                       reason);
  if (!drawn) return out;
  Cells columns;
  Cells rows;
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      if (!(p.density[i][j] > 0.0F)) continue;
      columns.add(i);
      rows.add(j);
    }
  }
  const auto [x_low, x_high] = columns.range(p.x_low, p.x_high);
  const auto [y_low, y_high] = rows.range(p.y_low, p.y_high);
  const Axis x{plane.x.factor * x_low, plane.x.factor * x_high, left, left + kPanel};
  const Axis y{plane.y.factor * y_low, plane.y.factor * y_high, bottom, kTop};
  return cells(p, plane.x, plane.y, x, y) + section_points(s, plane, x, y) + out +
         ticks(x, true, bottom) + ticks(y, false, left);
}

}  // namespace

std::string plot_phase(const PhaseSnapshot& s, const std::string& name) {
  const std::array<Plane, 3> planes{Plane{s.velocity_over_deflection, kDeflection, kVelocity},
                                    Plane{s.accel_over_deflection, kDeflection, kAccel},
                                    Plane{s.accel_over_velocity, kVelocity, kAccel}};
  std::string out = fmt::format(
      "<svg xmlns='http://www.w3.org/2000/svg' id='{}' viewBox='0 0 {} {}' width='{}' height='{}' "
      "role='img' font-family='Helvetica,Arial,DejaVu Sans,sans-serif' font-size='13'>"
      "<rect width='100%' height='100%' fill='#ffffff'/><g stroke='#555555' stroke-width='1' "
      "fill='none'><g stroke-width='1'>",
      escape_html(name), kWidth, kHeight, kWidth, kHeight);
  out += "<style>#" + escape_html(name) + " text{stroke:none;fill:#333333}</style>";
  double left = kFirstLeft;
  for (const Plane& plane : planes) {
    out += panel(s, plane, left);
    left += kPitch;
  }
  return out + "</g></g></svg>";
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
