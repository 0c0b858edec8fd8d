// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/library.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "app/diagnosis/common/explanation.hpp"
#include "app/rig/result.hpp"

namespace dampline::app::rig {
namespace {

constexpr std::array<double, 5> kFrictionOfScale{1e-5, 5e-5, 2.5e-4, 1e-3, 3e-3};
constexpr double kNoiseTimes = 3.0;  // a shorter stop would follow the noise
constexpr double kShortestMemory = 6e-3;
constexpr double kTravelSteps =
    0.5;  // of the motion's rms from sample to sample: a shorter one is a sign
constexpr double kMemoryRatio = 1.25;
constexpr double kLongestMemory = 0.8;
constexpr double kSharp = 3.0;  // times the width that an error of the velocity makes
/// Widths of a smooth law of friction, of the speed's rms.
constexpr double kNarrowest = 0.01;
constexpr double kWidest = 0.3;  // a wider one is hardly another than viscous damping
/// Times of a spring behind a dashpot, of half the range over the speed's rms: from a damper to a
/// spring.
constexpr double kShortestTime = 0.1;
constexpr double kLongestTime = 3.0;
constexpr double kTimeRatio = 1.5;
constexpr double kFewestSteps = 2.0;  // samples in a time
constexpr double kSteady = 1.3;  // between the speeds that a fifth of the time is below and above

bool is_steady(const std::vector<Series>& records) {
  std::vector<double> speed;
  for (const Series& s : records)
    for (const double v : s.velocity_mps) speed.push_back(std::abs(v));
  const auto at = [&](std::size_t fifths) {
    const auto place = speed.begin() + static_cast<std::ptrdiff_t>(speed.size() * fifths / 5);
    std::nth_element(speed.begin(), place, speed.end());
    return *place;
  };
  return at(4) < kSteady * at(1);
}

bool needs_speeds(const std::string& effect) {
  return effect == "viscous" || effect == "progressive_damping" || effect == "asymmetric_viscous" ||
         effect == "quadratic_damping" || effect == "stribeck" || effect == "viscoelastic";
}

void add_memory(Library& out, const Scale& scale) {
  for (const double share : ratios(kShortestMemory, kLongestMemory, kMemoryRatio)) {
    const double a = share * scale.deflection_m;
    if (a < kNoiseTimes * scale.noise_m || a < kTravelSteps * scale.step_m) continue;
    const Eigen::Index stop = out.add({Kind::kStop, a, 0.0});
    out.candidates.push_back({"presliding_hysteresis", a, {stop}, 1});
    const Eigen::Index up = out.add({Kind::kGapUp, a, 0.0});
    const Eigen::Index down = out.add({Kind::kGapDown, a, 0.0});
    out.candidates.push_back({"backlash", a, {up, down}, 1});
    out.candidates.push_back({"backlash", a, {out.add({Kind::kEdge, a, 0.0})}, 1});
  }
}

void add_friction(Library& out, const Scale& scale) {
  const double a = scale.sign_mps;
  out.candidates.push_back(
      {"progressive_friction", 0.0, {out.add({Kind::kProgressive, a, 0.0})}, 0});
  out.candidates.push_back(
      {"progressive_friction", 0.0, {out.add({Kind::kProgressiveAbsolute, a, 0.0})}, 0});
  for (const double share : ratios(0.05, 2.0, 1.6)) {
    const double speed = share * scale.velocity_mps;
    for (const Kind shape : law::kFadingForms)
      out.candidates.push_back({"stribeck", speed, {out.add({shape, a, speed})}, 1});
  }
}

void add_damping(Library& out, const core::Terms& base) {
  const Eigen::Index v = out.add({Kind::kVelocity, 0.0, 0.0});
  out.viscous = v;
  const Eigen::Index speed = out.add({Kind::kSpeed, 0.0, 0.0});
  if (base.viscous != core::Branches::kNone) out.base.push_back(v);
  if (base.viscous == core::Branches::kSeparate) out.base.push_back(speed);
  if (base.viscous == core::Branches::kNone) {
    out.candidates.push_back({"viscous", 0.0, {v}, 1});
    out.candidates.push_back({"asymmetric_viscous", 0.0, {v, speed}, 1});
  }
  if (base.viscous == core::Branches::kCommon)
    out.candidates.push_back({"asymmetric_viscous", 0.0, {speed}, 0});
  out.candidates.push_back(
      {"quadratic_damping", 0.0, {out.add({Kind::kSpeedSquared, 0.0, 0.0})}, 1});
  out.candidates.push_back(
      {"progressive_damping", 0.0, {out.add({Kind::kSquareVelocity, 0.0, 0.0})}, 0});
}

void add_viscoelastic(Library& out, const Scale& scale) {
  for (const double time_s : viscoelastic_times(scale))
    out.candidates.push_back({"viscoelastic", time_s, {out.add({Kind::kMaxwell, time_s})}, 1});
}

void add_stiffness(Library& out, const Scale& scale) {
  const Eigen::Index square = out.add({Kind::kSquare, 0.0, 0.0});
  const Eigen::Index cube = out.add({Kind::kCube, 0.0, 0.0});
  const Eigen::Index magnitude = out.add({Kind::kMagnitude, 0.0, 0.0});
  out.candidates.push_back({"quadratic_stiffness", 0.0, {square}, 0});
  out.candidates.push_back({"cubic_stiffness", 0.0, {cube}, 0});
  out.candidates.push_back({"asymmetric_stiffness", 0.0, {magnitude}, 0});
  for (const double share : {0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9}) {
    const double gap = share * scale.deflection_m;
    const Eigen::Index up = out.add({Kind::kBumpUp, gap, 0.0});
    const Eigen::Index down = out.add({Kind::kBumpDown, gap, 0.0});
    out.candidates.push_back({"bump_stop", gap, {up, down}, 1});
    out.candidates.push_back({"bump_stop", gap, {up}, 1});
    out.candidates.push_back({"bump_stop", gap, {down}, 1});
  }
}

}  // namespace

std::vector<double> ratios(double from, double to, double ratio) {
  const auto steps = static_cast<int>(std::ceil(std::log(to / from) / std::log(ratio)));
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(std::max(steps, 0)));
  for (int i = 0; i < steps; ++i) out.push_back(from * std::pow(ratio, i));
  return out;
}

std::vector<double> viscoelastic_times(const Scale& scale) {
  const double slow_s = scale.deflection_m / scale.velocity_mps;
  const double interval_s = scale.step_m / scale.velocity_mps;
  std::vector<double> out = ratios(kShortestTime * slow_s, kLongestTime * slow_s, kTimeRatio);
  std::erase_if(out, [&](double time_s) { return time_s <= kFewestSteps * interval_s; });
  return out;
}

Eigen::Index Library::add(const Regressor& column) {
  columns.push_back(column);
  return static_cast<Eigen::Index>(columns.size()) - 1;
}

Scale scale_of(const std::vector<Series>& records) {
  Scale out;
  double squares = 0.0;
  double samples = 0.0;
  for (const Series& s : records) {
    out.deflection_m =
        std::max(out.deflection_m, 0.5 * (s.deflection_m.maxCoeff() - s.deflection_m.minCoeff()));
    squares += s.velocity_mps.squaredNorm();
    samples += static_cast<double>(s.size());
    out.noise_m = std::max(out.noise_m, s.noise_m);
    out.sign_mps = std::max(out.sign_mps, s.config.sign_width_mps);
  }
  out.velocity_mps = std::sqrt(squares / samples);
  out.step_m = out.velocity_mps * records.front().interval_s;
  out.steady = is_steady(records);
  return out;
}

bool is_memory_travel(double travel_m, const Scale& scale) noexcept {
  return travel_m > 0.9 * kShortestMemory * scale.deflection_m;
}

bool is_base_declared(const ModelConfig& model) {
  return model.base_is_set || model.base != ModelConfig{}.base;
}

bool is_smooth(const Regressor& column, const Scale& scale) noexcept {
  return column.kind == Kind::kSign && column.a > (1.0 + 1e-9) * kSharp * scale.sign_mps;
}

Library make_library(const Config& config, const Scale& scale) {
  const core::Terms base = terms_of(config.model);
  Library out;
  out.base_terms = term_names(base);
  for (const double share : kFrictionOfScale) {
    const double a = share * scale.deflection_m;
    if (a < kNoiseTimes * scale.noise_m && share < kFrictionOfScale.back()) continue;
    out.friction.push_back(out.add({Kind::kStop, a, 0.0}));
  }
  for (const double times : {0.3, 1.0, kSharp})
    out.friction.push_back(out.add({Kind::kSign, times * scale.sign_mps, 0.0}));
  const double beyond_mps = std::max(kSharp * scale.sign_mps, kNarrowest * scale.velocity_mps);
  for (const double share : ratios(beyond_mps, kWidest * scale.velocity_mps, kFrictionWidthRatio))
    out.friction.push_back(out.add({Kind::kSign, kFrictionWidthRatio * share, 0.0}));
  if (base.inertia) out.base.push_back(out.add({Kind::kInertia, 0.0, 0.0}));
  out.base_friction = base.coulomb != core::Branches::kNone;
  out.offset = out.add({Kind::kOne, 0.0, 0.0});
  out.spring = out.add({Kind::kDeflection, 0.0, 0.0});
  out.mass = out.add({Kind::kAcceleration, 0.0, 0.0});
  out.base_offset = base.offset || base.coulomb == core::Branches::kSeparate;
  out.base_spring = base.stiffness;
  out.may_add_spring = config.model.stiffness == "auto";
  if (out.base_offset) out.base.push_back(out.offset);
  if (out.base_spring) out.base.push_back(out.spring);
  add_damping(out, base);
  add_friction(out, scale);
  add_stiffness(out, scale);
  add_memory(out, scale);
  out.base_searched = searched_base(config.model);
  const auto& wanted = config.model.candidates;
  const auto is_named = [&](const std::string& name) {
    return std::find(wanted.begin(), wanted.end(), name) != wanted.end();
  };
  const auto is_wanted = [&](const std::string& name) {
    return app::is_wanted(config.model, name);
  };
  // Beside all others it would stand in for a mass or for damping in slow motion: where nobody
  // named it, it is looked for where a memory leads.
  if (is_named("viscoelastic")) add_viscoelastic(out, scale);
  out.wants_viscoelastic = is_wanted("viscoelastic") && !is_named("viscoelastic") && !scale.steady;
  out.wants_skew = is_wanted("time_skew");
  out.wants_drift = is_wanted("time_drift");
  out.wants_mode = is_wanted("unmodelled_mode");
  out.wants_impacts = is_wanted("impulsive_input");
  if (!out.base_friction) {
    for (const Eigen::Index sign : out.friction)
      out.candidates.push_back({"coulomb", 0.0, {sign}, 1});
  }
  if (!out.base_offset) out.candidates.push_back({"offset_force", 0.0, {out.offset}, 0});
  std::erase_if(out.candidates, [&](const Candidate& c) {
    const auto& kept = out.base_searched;
    if (std::find(kept.begin(), kept.end(), c.effect) != kept.end()) return false;
    return !is_wanted(c.effect) || (scale.steady && needs_speeds(c.effect));
  });
  return out;
}

BankElement add_bank_element(Library& library, double travel_m) {
  BankElement out{travel_m, {}, {}};
  for (int m = 0; m < Regressor::kHats; ++m)
    out.hats.push_back(library.add({Kind::kHat, travel_m, static_cast<double>(m)}));
  for (const double side : {1.0, -1.0}) {
    out.speed.push_back(library.add({Kind::kFall, travel_m, side}));
    out.speed.push_back(library.add({Kind::kBreakaway, travel_m, side}));
  }
  return out;
}

}  // namespace dampline::app::rig
