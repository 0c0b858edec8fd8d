// SPDX-License-Identifier: MIT
#include "dampline/effect/grids.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dampline/effect/conclusion.hpp"

namespace dampline::effect {
namespace {

/// Ratios of neighbours, by round; the last one is kept.
struct Ratios {
  double length, time, frequency, pitch, slip, damping, gap, width;
};
constexpr std::array<Ratios, 3> kRatios{{{1.08, 1.3, 1.03, 1.12, 1.3, 1.6, 1.15, 3.0},
                                         {1.04, 1.15, 1.015, 1.05, 1.12, 1.3, 1.07, 1.4},
                                         {1.03, 1.1, 1.01, 1.03, 1.08, 1.2, 1.04, 1.25}}};
constexpr double kWidestPlayMps = 16.0e-3;

/// The point at a place between those of a grid.
template <std::size_t N>
double point_at(const std::array<double, N>& grid, double place) noexcept {
  const auto low = static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(N) - 2.0));
  return grid[low] * std::pow(grid[low + 1] / grid[low], place - static_cast<double>(low));
}

template <std::size_t N>
void around(double centre, double ratio, std::array<double, N>& grid) noexcept {
  const double middle = 0.5 * (static_cast<double>(N) - 1.0);
  for (std::size_t i = 0; i < N; ++i)
    grid[i] = centre * std::pow(ratio, static_cast<double>(i) - middle);
}
template <std::size_t N>
void around_place(double place, double ratio, std::array<double, N>& grid) noexcept {
  around(point_at(grid, place), ratio, grid);
}

/// Speeds close to each other fade alike, and which of them fits best is an error's of the
/// velocity: the octaves stay, and the one that counts is on what lay between.
void speeds_around(double centre_mps, std::array<double, kStribeckSpeeds>& grid) noexcept {
  for (std::size_t i = 0; i < kStribeckSpeeds; ++i)
    grid[i] = centre_mps * std::exp2(static_cast<double>(i) - static_cast<double>(kFineStribeck));
}

/// A grid of two dimensions: lines of points, one after the other.
template <std::size_t Points, std::size_t Lines, class Shape>
struct Plane {
  double Shape::*along;
  double Shape::*across;

  /// Between the points of a grid.
  template <std::size_t N>
  [[nodiscard]] Shape at(const Step& step, const std::array<Shape, N>& grid) const noexcept {
    static_assert(Points * Lines <= N);
    const std::size_t line = step.chosen.variant / Points;
    const std::size_t point = step.chosen.variant % Points;
    std::array<double, Points> in_line{};
    for (std::size_t i = 0; i < Points; ++i) in_line[i] = grid[line * Points + i].*along;
    std::array<double, Lines> lines{};
    for (std::size_t i = 0; i < Lines; ++i) lines[i] = grid[i * Points + point].*across;
    Shape out{};
    out.*along = point_at(in_line, step.place - static_cast<double>(line * Points));
    out.*across = point_at(lines, static_cast<double>(line) + step.line_offset);
    return out;
  }
  /// Draws a grid together; ratios of neighbours. Points that are left repeat the last one.
  template <std::size_t N>
  void around(const Shape& centre, double along_ratio, double across_ratio,
              std::array<Shape, N>& grid) const noexcept {
    for (std::size_t i = 0; i < N; ++i) {
      const std::size_t line = std::min(i / Points, Lines - 1);
      const std::size_t point = std::min(i - line * Points, Points - 1);
      grid[i].*along = centre.*along * std::pow(along_ratio, from_middle(point, Points));
      grid[i].*across = centre.*across * std::pow(across_ratio, from_middle(line, Lines));
    }
  }

 private:
  static double from_middle(std::size_t i, std::size_t count) noexcept {
    return static_cast<double>(i) - 0.5 * (static_cast<double>(count) - 1.0);
  }
};
constexpr Plane<kPitchFrequencies, kPitchModes / kPitchFrequencies, PitchShape> kPitchPlane{
    &PitchShape::frequency_hz, &PitchShape::slip_m};
constexpr Plane<kFineFrequencies, kFineDampings, FlexibleShape> kFlexiblePlane{
    &FlexibleShape::frequency_hz, &FlexibleShape::damping_ratio};
constexpr Plane<kFineGaps, kFinePlayWidths, PlayShape> kPlayPlane{&PlayShape::gap,
                                                                  &PlayShape::width_mps};

/// One line of a grid that is not fine yet; what lies across is the same for all.
template <class Shape, std::size_t N>
Shape on_one_line(const Step& step, const std::array<Shape, N>& grid,
                  double Shape::*along) noexcept {
  std::array<double, N> line{};
  for (std::size_t i = 0; i < N; ++i) line[i] = grid[i].*along;
  Shape out = grid[step.chosen.variant];
  out.*along = point_at(line, step.place);
  return out;
}

/// In equilibrium the spring's mean force is none: the kink lies beside the mean of the motion by
/// half the difference over the stiffness times the mean of |x|, which is, of a Gaussian motion
/// whose mean lies m of its deviation off, sqrt(2 / pi) (1 + m^2 / 2).
double kink_of(double difference_npm, double stiffness_npm) noexcept {
  const double a = std::clamp(0.5 * difference_npm / stiffness_npm, -1.0, 1.0) *
                   std::sqrt(2.0 / std::numbers::pi);
  return a / std::sqrt(1.0 - a * a);
}

void play_around(const Step& step, const Ratios& r, Grids& grids) noexcept {
  PlayShape found = play_of(step, grids);
  found.width_mps =
      std::clamp(found.width_mps, kInnerWidthMps * std::sqrt(r.width), kWidestPlayMps);
  kPlayPlane.around(found, r.gap, r.width, grids.play);
}

bool step_around(const Step& step, double stiffness_npm, const Ratios& r, Grids& grids) noexcept {
  switch (step.chosen.effect) {
    case Effect::kAsymmetricStiffness:
      if (!(stiffness_npm > 0.0)) return false;
      grids.kink = kink_of(step.parameter[0].estimate.value, stiffness_npm);
      return true;
    case Effect::kStribeck:
      speeds_around(point_at(grids.stribeck_mps, step.place), grids.stribeck_mps);
      return true;
    case Effect::kBumpStop:
      around_place(step.place, r.length, grids.bump_gap);
      return true;
    case Effect::kPreslidingHysteresis:
      around_place(step.place, r.length, grids.dahl_distance);
      return true;
    case Effect::kBacklash:
      play_around(step, r, grids);
      return true;
    case Effect::kViscoelastic:
      around_place(step.place, r.time, grids.relaxation_s);
      return true;
    case Effect::kUnmodelledMode:
      if (step.chosen.form == kPitchForm) {
        kPitchPlane.around(pitch_of(step, grids), r.pitch, r.slip, grids.pitch);
      } else {
        kFlexiblePlane.around(flexible_of(step, grids), r.frequency, r.damping, grids.flexible);
      }
      return true;
    default:
      return false;
  }
}

}  // namespace

std::size_t line_of(Effect effect, bool is_pitch, const Grids& grids) noexcept {
  if (effect == Effect::kBacklash && grids.is_fine(effect)) return kFineGaps;
  if (effect != Effect::kUnmodelledMode) return kMostCandidates;
  if (is_pitch) return kPitchFrequencies;
  return grids.is_fine(effect) ? kFineFrequencies : kFlexibleModes;
}

PitchShape pitch_of(const Step& step, const Grids& grids) noexcept {
  return kPitchPlane.at(step, grids.pitch);
}

FlexibleShape flexible_of(const Step& step, const Grids& grids) noexcept {
  return grids.is_fine(Effect::kUnmodelledMode)
             ? kFlexiblePlane.at(step, grids.flexible)
             : on_one_line(step, grids.flexible, &FlexibleShape::frequency_hz);
}

PlayShape play_of(const Step& step, const Grids& grids) noexcept {
  return grids.is_fine(Effect::kBacklash) ? kPlayPlane.at(step, grids.play)
                                          : on_one_line(step, grids.play, &PlayShape::gap);
}

bool as_kink(Explanation& e) noexcept {
  Step& step = e.step[0];
  const Candidate& c = step.chosen;
  const bool one_sided = c.form == kOneSidedUp || c.form == kOneSidedDown;
  if (e.step_count == 0 || c.effect != Effect::kBumpStop || !one_sided) return false;
  if (!(e.grids.bump_gap[c.variant] < kKinkWithin)) return false;
  const double stiffer_npm = step.parameter[0].estimate.value;
  e.final_stiffness_npm.value += 0.5 * stiffer_npm;
  step.parameter[0].estimate.value = c.form == kOneSidedUp ? stiffer_npm : -stiffer_npm;
  step.parameter[0].name = "asymmetric_stiffness_difference";
  step.parameter_count = 1;
  for (std::size_t r = 0; r < step.runner_up_count; ++r) {
    if (step.runner_up[r].effect != Effect::kAsymmetricStiffness) continue;
    step.runner_up[r].effect = Effect::kBumpStop;
    step.other[r] = c;
  }
  step.chosen.effect = Effect::kAsymmetricStiffness;
  step.chosen.form = kPlainForm;
  step.chosen.variant = 0;
  return true;
}

bool draw_together(const Explanation& e, int round, Grids& grids) noexcept {
  const auto r = static_cast<std::size_t>(std::clamp(round, 0, 2));
  bool any = false;
  grids = e.grids;
  for (const Step& step : e.steps()) {
    if (!step_around(step, e.final_stiffness_npm.value, kRatios[r], grids)) continue;
    grids.fine[static_cast<std::size_t>(step.chosen.effect)] = true;
    any = true;
  }
  return any;
}

}  // namespace dampline::effect
