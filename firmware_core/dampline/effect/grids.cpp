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
  double length, time, frequency, pitch, slip, damping;
};
constexpr std::array<Ratios, 3> kRatios{{{1.08, 1.3, 1.03, 1.12, 1.3, 1.6},
                                         {1.04, 1.15, 1.015, 1.05, 1.12, 1.3},
                                         {1.03, 1.1, 1.01, 1.03, 1.08, 1.2}}};

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

/// Steps from the middle of three lines or of the points of a line.
double from_middle(std::size_t i, std::size_t count) noexcept {
  return static_cast<double>(i) - 0.5 * (static_cast<double>(count) - 1.0);
}

void pitch_around(const Step& step, const Ratios& r, Grids& grids) noexcept {
  const PitchShape found = pitch_of(step, grids);
  for (std::size_t i = 0; i < kPitchModes; ++i) {
    grids.pitch[i] = {
        found.frequency_hz *
            std::pow(r.pitch, from_middle(i % kPitchFrequencies, kPitchFrequencies)),
        found.slip_m *
            std::pow(r.slip, from_middle(i / kPitchFrequencies, kPitchModes / kPitchFrequencies))};
  }
}

void flexible_around(const Step& step, const Ratios& r, Grids& grids) noexcept {
  const FlexibleShape found = flexible_of(step, grids);
  for (std::size_t i = 0; i < kFlexibleModes; ++i) {
    const std::size_t line = std::min(i / kFineFrequencies, kFineDampings - 1);
    const std::size_t point = std::min(i - line * kFineFrequencies, kFineFrequencies - 1);
    grids.flexible[i] = {
        found.frequency_hz * std::pow(r.frequency, from_middle(point, kFineFrequencies)),
        found.damping_ratio * std::pow(r.damping, from_middle(line, kFineDampings))};
  }
}

/// In equilibrium the spring's mean force is none: the kink lies beside the mean of the motion by
/// half the difference over the stiffness times the mean of |x|, which is, of a Gaussian motion
/// whose mean lies m of its deviation off, sqrt(2 / pi) (1 + m^2 / 2).
double kink_of(double difference_npm, double stiffness_npm) noexcept {
  const double a = std::clamp(0.5 * difference_npm / stiffness_npm, -1.0, 1.0) *
                   std::sqrt(2.0 / std::numbers::pi);
  return a / std::sqrt(1.0 - a * a);
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
      around_place(step.place, r.length, grids.backlash_gap);
      return true;
    case Effect::kViscoelastic:
      around_place(step.place, r.time, grids.relaxation_s);
      return true;
    case Effect::kUnmodelledMode:
      if (step.chosen.form == kPitchForm) {
        pitch_around(step, r, grids);
      } else {
        flexible_around(step, r, grids);
      }
      return true;
    default:
      return false;
  }
}

}  // namespace

std::size_t line_of(Effect effect, bool is_pitch, const Grids& grids) noexcept {
  if (effect != Effect::kUnmodelledMode) return kMostCandidates;
  if (is_pitch) return kPitchFrequencies;
  return grids.is_fine(effect) ? kFineFrequencies : kFlexibleModes;
}

PitchShape pitch_of(const Step& step, const Grids& grids) noexcept {
  constexpr std::size_t kLines = kPitchModes / kPitchFrequencies;
  const std::size_t line = step.chosen.variant / kPitchFrequencies;
  const std::size_t point = step.chosen.variant % kPitchFrequencies;
  std::array<double, kPitchFrequencies> hz{};
  for (std::size_t i = 0; i < kPitchFrequencies; ++i)
    hz[i] = grids.pitch[line * kPitchFrequencies + i].frequency_hz;
  std::array<double, kLines> slip_m{};
  for (std::size_t i = 0; i < kLines; ++i)
    slip_m[i] = grids.pitch[i * kPitchFrequencies + point].slip_m;
  return {point_at(hz, static_cast<double>(point) + step.place - step.chosen.variant),
          point_at(slip_m, static_cast<double>(line) + step.line_offset)};
}

FlexibleShape flexible_of(const Step& step, const Grids& grids) noexcept {
  std::array<double, kFlexibleModes> hz{};
  for (std::size_t i = 0; i < kFlexibleModes; ++i) hz[i] = grids.flexible[i].frequency_hz;
  const std::size_t v = step.chosen.variant;
  if (!grids.is_fine(Effect::kUnmodelledMode))
    return {point_at(hz, step.place), grids.flexible[v].damping_ratio};
  const std::size_t line = v / kFineFrequencies;
  std::array<double, kFineFrequencies> part{};
  std::copy_n(hz.begin() + static_cast<std::ptrdiff_t>(line * kFineFrequencies), part.size(),
              part.begin());
  std::array<double, kFineDampings> damping{};
  for (std::size_t i = 0; i < kFineDampings; ++i)
    damping[i] = grids.flexible[i * kFineFrequencies].damping_ratio;
  return {point_at(part, step.place - static_cast<double>(line * kFineFrequencies)),
          point_at(damping, static_cast<double>(line) + step.line_offset)};
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
  for (std::size_t i = 0; i < e.step_count; ++i) {
    if (!step_around(e.step[i], e.final_stiffness_npm.value, kRatios[r], grids)) continue;
    grids.fine[static_cast<std::size_t>(e.step[i].chosen.effect)] = true;
    any = true;
  }
  return any;
}

}  // namespace dampline::effect
