// SPDX-License-Identifier: MIT
#include "app/verify/phase/friction_oscillator.hpp"

#include <cmath>

namespace dampline::sim {
namespace {

constexpr int kHalvings = 60;     // locates an event to rounding
constexpr int kMaxEvents = 1000;  // of one step

double sign_of(double x) { return x > 0.0 ? 1.0 : -1.0; }

}  // namespace

double OscillatorDrive::at(double time_s) const noexcept {
  return mean_mps2 + swing_mps2 * std::sin(rate_rad_s * time_s + phase_rad);
}

FrictionOscillator::FrictionOscillator(const OscillatorLaw& law, const OscillatorDrive& drive,
                                       double step_s, const PhasePoint& start)
    : law_{law}, drive_{drive}, step_s_{step_s}, state_{start.deflection_m, start.velocity_mps} {
  if (law_.reversal_m != 0.0) side_ = 1.0 + state_.y / law_.reversal_m >= 0.0 ? 1 : -1;
  choose_sign();
}

/// On the side of the kink where the step began, so that a step's law is smooth.
double FrictionOscillator::friction(double y) const noexcept {
  if (law_.reversal_m == 0.0) return law_.friction_mps2;
  const double factor = 1.0 + y / law_.reversal_m;
  return law_.friction_mps2 * (law_.may_turn_negative ? factor : side_ * factor);
}

double FrictionOscillator::net_without_friction(double time_s, const State& s) const noexcept {
  return drive_.at(time_s) - law_.viscous_per_s * s.v - law_.stiffness_per_s2 * s.y -
         law_.cubic_per_m2s2 * s.y * s.y * s.y;
}

double FrictionOscillator::accel(double time_s, const State& s) const noexcept {
  const double sign = law_.creep_mps > 0.0 ? std::tanh(s.v / law_.creep_mps) : sign_;
  return net_without_friction(time_s, s) - sign * friction(s.y);
}

FrictionOscillator::State FrictionOscillator::runge_kutta(double length_s) const noexcept {
  const double h = length_s;
  const auto at = [&](double share, const State& slope) {
    return State{state_.y + share * h * slope.y, state_.v + share * h * slope.v};
  };
  const auto slope = [&](double share, const State& s) {
    return State{s.v, accel(time_s_ + share * h, s)};
  };
  const State a = slope(0.0, state_);
  const State b = slope(0.5, at(0.5, a));
  const State c = slope(0.5, at(0.5, b));
  const State d = slope(1.0, at(1.0, c));
  return {state_.y + h / 6.0 * (a.y + 2.0 * b.y + 2.0 * c.y + d.y),
          state_.v + h / 6.0 * (a.v + 2.0 * b.v + 2.0 * c.v + d.v)};
}

bool FrictionOscillator::leaves_mode(const State& s) const noexcept {
  if (law_.reversal_m != 0.0 && side_ * (1.0 + s.y / law_.reversal_m) < 0.0) return true;
  return law_.creep_mps <= 0.0 && sign_ * s.v < 0.0;
}

bool FrictionOscillator::breaks_loose(double time_s) const noexcept {
  return std::abs(net_without_friction(time_s, state_)) > friction(state_.y);
}

/// At v = 0: which way the force pulls, if it overcomes the friction.
void FrictionOscillator::choose_sign() {
  if (law_.creep_mps > 0.0) return;
  if (state_.v != 0.0) {
    sign_ = static_cast<int>(sign_of(state_.v));
    return;
  }
  const double net = net_without_friction(time_s_, state_);
  sign_ = std::abs(net) > friction(state_.y) ? static_cast<int>(sign_of(net)) : 0;
}

/// Slips for at most `length_s`, to the first event; returns how long.
double FrictionOscillator::slip(double length_s) {
  const State end = runge_kutta(length_s);
  if (!leaves_mode(end)) {
    state_ = end;
    time_s_ += length_s;
    return length_s;
  }
  double inside = 0.0;
  double outside = length_s;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (leaves_mode(runge_kutta(middle)) ? outside : inside) = middle;
  }
  const State last = runge_kutta(outside);
  const bool kink = law_.reversal_m != 0.0 && side_ * (1.0 + last.y / law_.reversal_m) < 0.0;
  const bool reversal = law_.creep_mps <= 0.0 && sign_ * last.v < 0.0;
  state_ = last;
  time_s_ += outside;
  if (kink) side_ = -side_;
  if (reversal) {
    state_.v = 0.0;
    choose_sign();
  }
  return outside;
}

/// Sticks for at most `length_s`; returns how long.
double FrictionOscillator::stick(double length_s) {
  if (!breaks_loose(time_s_ + length_s)) {
    time_s_ += length_s;
    return length_s;
  }
  double inside = 0.0;
  double outside = length_s;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (breaks_loose(time_s_ + middle) ? outside : inside) = middle;
  }
  time_s_ += outside;
  choose_sign();
  return outside;
}

void FrictionOscillator::step() {
  const double target = time_s_ + step_s_;
  double left = step_s_;
  for (int events = 0; left > 0.0 && events < kMaxEvents; ++events)
    left -= sticks() ? stick(left) : slip(left);
  time_s_ = target;
}

void FrictionOscillator::drive(const OscillatorDrive& next) {
  drive_ = next;
  choose_sign();
}

PhasePoint FrictionOscillator::point() const noexcept {
  return {state_.y, state_.v, sticks() ? 0.0 : accel(time_s_, state_)};
}

}  // namespace dampline::sim
