// SPDX-License-Identifier: MIT
#include "app/verify/oscillator/oscillator.hpp"

#include <cmath>

namespace dampline::sim {
namespace {

constexpr int kBisections = 40;

double at(const BaseMotion& base, double u) noexcept {
  return (1.0 - u) * (1.0 - 2.0 * u) * base.start_mps2 + 4.0 * u * (1.0 - u) * base.middle_mps2 +
         u * (2.0 * u - 1.0) * base.end_mps2;
}

/// The place in (from, 1] where `holds` ends, given that it holds at `from` and not at 1.
template <class Predicate>
double last_place(double from, const Predicate& holds) noexcept {
  double low = from;
  double high = 1.0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = 0.5 * (low + high);
    (holds(middle) ? low : high) = middle;
  }
  return high;
}

}  // namespace

void Oscillator::set_motion(double deflection_m, double velocity_mps) noexcept {
  state_ = {deflection_m, velocity_mps};
  direction_ = velocity_mps < 0.0 ? -1 : 1;
}

double Oscillator::accel(const State& at, double base_mps2) const noexcept {
  const double square = at.z * at.z;
  const double friction =
      direction_ * (config_.coulomb_mps2 + config_.coulomb_slope_ps2 * std::abs(at.z));
  return -base_mps2 - (config_.viscous_ps + config_.quadratic_viscous_pm2s * square) * at.v -
         (config_.stiffness_ps2 + config_.cubic_stiffness_pm2s2 * square) * at.z - friction;
}

Oscillator::State Oscillator::moved(const BaseMotion& base, double from, double to,
                                    double step_s) const noexcept {
  const double h = (to - from) * step_s;
  const double start = at(base, from);
  const double middle = at(base, 0.5 * (from + to));
  const double end = at(base, to);
  const auto ahead = [&](double v, double a, double length) {
    return State{state_.z + length * v, state_.v + length * a};
  };
  const double a1 = accel(state_, start);
  const State s2 = ahead(state_.v, a1, 0.5 * h);
  const double a2 = accel(s2, middle);
  const State s3 = ahead(s2.v, a2, 0.5 * h);
  const double a3 = accel(s3, middle);
  const State s4 = ahead(s3.v, a3, h);
  const double a4 = accel(s4, end);
  return {state_.z + h / 6.0 * (state_.v + 2.0 * (s2.v + s3.v) + s4.v),
          state_.v + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)};
}

int Oscillator::start_direction(double base_mps2) const noexcept {
  const double z = state_.z;
  const double push =
      -base_mps2 - (config_.stiffness_ps2 + config_.cubic_stiffness_pm2s2 * z * z) * z;
  const double friction = config_.coulomb_mps2 + config_.coulomb_slope_ps2 * std::abs(z);
  if (std::abs(push) <= friction) return 0;
  return push > 0.0 ? 1 : -1;
}

double Oscillator::slide(const BaseMotion& base, double from, double step_s) noexcept {
  const State end = moved(base, from, 1.0, step_s);
  const bool reversed = end.v * direction_ < 0.0;
  if (!reversed || !has_friction()) {
    state_ = end;
    return 1.0;
  }
  const double stop = last_place(
      from, [&](double u) { return moved(base, from, u, step_s).v * direction_ >= 0.0; });
  state_ = {moved(base, from, stop, step_s).z, 0.0};
  const int next = start_direction(at(base, stop));
  direction_ = next;
  return stop;
}

double Oscillator::stick(const BaseMotion& base, double from) noexcept {
  if (start_direction(at(base, 1.0)) == 0) return 1.0;
  const double loose =
      last_place(from, [&](double u) { return start_direction(at(base, u)) == 0; });
  direction_ = start_direction(at(base, loose));
  return loose;
}

void Oscillator::step(const BaseMotion& base, double step_s) noexcept {
  for (double place = 0.0; place < 1.0;) {
    place = sticks() ? stick(base, place) : slide(base, place, step_s);
  }
}

}  // namespace dampline::sim
