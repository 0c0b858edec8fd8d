// SPDX-License-Identifier: MIT
#include "sim_hw/truck.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::sim {
namespace {

enum : std::size_t {
  kY,
  kV,
  kPitch,
  kPitchRate,
  kBend,
  kBendRate,
  kZeta1,
  kZeta2,
  kStretch1,
  kStretch2
};

}  // namespace

TruckConfig laden_truck() noexcept { return {}; }

TruckConfig empty_truck() noexcept {
  TruckConfig config;
  config.moving_mass_kg = 9700.0;
  config.stiffness_npm = 2.0e6;
  config.friction_positive_n = 3154.0;
  config.friction_negative_n = 2720.0;
  return config;
}

Truck::Truck(const TruckConfig& config)
    : config_(config),
      plain_(config.modes.pitch_inertia_kgm2 <= 0.0 && config.modes.flexible_share <= 0.0 &&
             config.hysteresis.presliding_distance_m <= 0.0 &&
             config.hysteresis.viscoelastic_npm <= 0.0),
      drifts_(config.drift.active()) {
  set_parameters(0.0);
  if (drifts_) set_parameters(config.drift.start_s - 1.0);
}

void Truck::set_parameters(double time_s) noexcept {
  const double progress = drifts_ ? drift_progress(config_.drift, time_s) : 0.0;
  const auto scaled = [&](double value, double factor) {
    return value * (1.0 + (factor - 1.0) * progress);
  };
  const double friction = scaled(config_.friction_scale, config_.drift.friction_factor);
  mass_kg_ = scaled(config_.moving_mass_kg, config_.drift.mass_factor);
  stiffness_npm_ = scaled(config_.stiffness_npm, config_.drift.stiffness_factor);
  friction_positive_n_ = friction * config_.friction_positive_n;
  friction_negative_n_ = friction * config_.friction_negative_n;
}

void Truck::set_motion(double deflection_m, double velocity_mps) noexcept {
  state_ = {};
  state_[kY] = deflection_m;
  state_[kV] = velocity_mps;
  static_cast<void>(rate(state_, {}));
}

Truck::Force Truck::force(double y, double v, const Memory& memory) const noexcept {
  const HysteresisEffects& history = config_.hysteresis;
  const bool presliding = history.presliding_distance_m > 0.0;
  const double sign = presliding ? memory.zeta : smooth_sign(v / config_.law_width_mps);
  double friction = sign * (sign > 0.0 ? friction_positive_n_ : friction_negative_n_) *
                    friction_factor(config_.damping, y, v);
  if (history.backlash_gap_m > 0.0)
    friction *= memory.play.engagement(history.backlash_gap_m, y, v);
  friction += history.viscoelastic_npm * memory.stretch_m;
  return {friction + added_damping_n(config_.damping, v),
          stiffness_npm_ * y + added_stiffness_n(config_.stiffness, y)};
}

Truck::State Truck::rate(const State& state, const Excitation& excitation) noexcept {
  const ModeEffects& modes = config_.modes;
  const auto& wheelset = excitation.wheelset_mps2;
  State rates{};
  Force total{};
  if (modes.pitch_inertia_kgm2 > 0.0) {
    const double d = state[kPitch];
    const double d_rate = state[kPitchRate];
    const Force first = force(state[kY] + 2.0 * d, state[kV] + 2.0 * d_rate,
                              {state[kZeta1], state[kStretch1], play_[0]});
    const Force second = force(state[kY] - 2.0 * d, state[kV] - 2.0 * d_rate,
                               {state[kZeta2], state[kStretch2], play_[1]});
    total = {0.5 * (first.damping_n + second.damping_n),
             0.5 * (first.restoring_n + second.restoring_n)};
    const double moment_arm = modes.pitch_half_wheelbase_m;
    const double difference =
        0.5 * (first.damping_n + first.restoring_n - second.damping_n - second.restoring_n);
    rates[kPitch] = d_rate;
    rates[kPitchRate] = -moment_arm * moment_arm / modes.pitch_inertia_kgm2 * difference -
                        0.5 * (wheelset[0] - wheelset[1]);
  } else {
    total = force(state[kY], state[kV], {state[kZeta1], state[kStretch1], play_[0]});
  }
  double push = excitation.force_n - total.damping_n - total.restoring_n;
  double mass = mass_kg_;
  if (modes.flexible_share > 0.0) {
    const double omega = 2.0 * std::numbers::pi * modes.flexible_frequency_hz;
    const double bend = 2.0 * modes.flexible_damping_ratio * omega * state[kBendRate] +
                        omega * omega * state[kBend];
    push += modes.flexible_share * mass_kg_ * bend;
    mass *= 1.0 - modes.flexible_share;
    rates[kBend] = state[kBendRate];
    rates[kBendRate] = -push / mass - bend;
  }
  const double frame = push / mass;
  rates[kY] = state[kV];
  rates[kV] = 2.0 * frame - wheelset[0] - wheelset[1];
  if (const double distance = config_.hysteresis.presliding_distance_m; distance > 0.0) {
    rates[kZeta1] = dahl_rate_ps(distance, state[kZeta1], state[kV] + 2.0 * state[kPitchRate]);
    rates[kZeta2] = dahl_rate_ps(distance, state[kZeta2], state[kV] - 2.0 * state[kPitchRate]);
  }
  if (config_.hysteresis.viscoelastic_npm > 0.0) {
    const double time_s = config_.hysteresis.viscoelastic_s;
    rates[kStretch1] =
        stretch_rate_mps(time_s, state[kStretch1], state[kV] + 2.0 * state[kPitchRate]);
    rates[kStretch2] =
        stretch_rate_mps(time_s, state[kStretch2], state[kV] - 2.0 * state[kPitchRate]);
  }
  seen_ = {state[kY], state[kV], frame, total.damping_n, total.restoring_n};
  return rates;
}

template <std::size_t N>
void Truck::part(const Excitation& start, const Excitation& middle, const Excitation& end,
                 double step_s) noexcept {
  const auto moved = [&](const State& slope, double length) {
    State next{};
    for (std::size_t i = 0; i < N; ++i) next[i] = state_[i] + length * slope[i];
    return next;
  };
  const State k1 = rate(state_, start);
  const State k2 = rate(moved(k1, 0.5 * step_s), middle);
  const State k3 = rate(moved(k2, 0.5 * step_s), middle);
  const State k4 = rate(moved(k3, step_s), end);
  for (std::size_t i = 0; i < N; ++i) {
    state_[i] += step_s / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
  }
}

// The slope of tanh at rest makes the fastest rate of the system; Runge-Kutta 4 is stable to 2.8
// times its inverse and accurate well below.
int Truck::parts_of(double step_s) const noexcept {
  const double level = std::max(friction_positive_n_, friction_negative_n_) *
                       (1.0 + std::abs(config_.damping.stribeck_share));
  const bool presliding = config_.hysteresis.presliding_distance_m > 0.0;
  const double slope =
      (presliding ? 0.0 : level / config_.law_width_mps) +
      std::max(config_.damping.viscous_positive_nspm, config_.damping.viscous_negative_nspm);
  const ModeEffects& modes = config_.modes;
  double fastest = 2.0 * slope / (mass_kg_ * (1.0 - modes.flexible_share));
  if (modes.pitch_inertia_kgm2 > 0.0) {
    const double arm = modes.pitch_half_wheelbase_m;
    fastest += 2.0 * slope * arm * arm / modes.pitch_inertia_kgm2;
  }
  if (config_.hysteresis.viscoelastic_npm > 0.0) fastest += 1.0 / config_.hysteresis.viscoelastic_s;
  if (presliding) fastest += 0.1 / config_.hysteresis.presliding_distance_m;  // at 0.1 m/s
  return std::clamp(static_cast<int>(std::ceil(fastest * step_s)), 1, 64);
}

void Truck::step(const Excitation& start, const Excitation& middle, const Excitation& end,
                 double time_s, double step_s) noexcept {
  if (drifts_) set_parameters(time_s + 0.5 * step_s);
  const int parts = parts_of(step_s);
  const double length = step_s / parts;
  for (int i = 0; i < parts; ++i) {
    const double u = static_cast<double>(i) / parts;
    const double width = 1.0 / parts;
    const Excitation a = i == 0 ? start : between(start, middle, end, u);
    const Excitation m = parts == 1 ? middle : between(start, middle, end, u + 0.5 * width);
    const Excitation b = i == parts - 1 ? end : between(start, middle, end, u + width);
    if (plain_) {
      part<2>(a, m, b, length);
    } else {
      part<kStates>(a, m, b, length);
    }
    if (const double gap = config_.hysteresis.backlash_gap_m; gap > 0.0) {
      play_[0].follow(gap, state_[kY] + 2.0 * state_[kPitch]);
      play_[1].follow(gap, state_[kY] - 2.0 * state_[kPitch]);
    }
  }
  static_cast<void>(rate(state_, end));
}

}  // namespace dampline::sim
