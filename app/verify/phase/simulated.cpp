// SPDX-License-Identifier: MIT
#include "app/verify/phase/simulated.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "published/phase/resonance.hpp"
#include "sim_hw/noise.hpp"

namespace dampline::sim {
namespace {

constexpr int kHalvings = 60;     // locates an event to rounding
constexpr int kMaxEvents = 1000;  // of one step

/// Where `holds` begins, given that it holds at `length_s` and not at 0.
template <class Predicate>
double first_place(double length_s, const Predicate& holds) {
  double inside = 0.0;
  double outside = length_s;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (holds(middle) ? outside : inside) = middle;
  }
  return outside;
}

double sign_of(double x) { return x > 0.0 ? 1.0 : -1.0; }

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kUnbounded = 1e6;  // a deflection that grows beyond it grows for ever

void add_noise(std::vector<StrobedPoint>& points, double share, std::uint64_t seed) {
  Random random{seed, Stream::kSensors};
  for (double PhasePoint::*channel :
       {&PhasePoint::deflection_m, &PhasePoint::velocity_mps, &PhasePoint::accel_mps2}) {
    double sum = 0.0;
    for (const StrobedPoint& p : points) sum += p.point.*channel * p.point.*channel;
    const double std = share * std::sqrt(sum / static_cast<double>(points.size()));
    for (StrobedPoint& p : points) p.point.*channel += std * random.normal();
  }
}

/// Adds one regime's flashes; returns where it ends.
PhasePoint run_regime(const OscillatorLaw& law, const SectionSweep& sweep, OscillatorDrive drive,
                      int regime, const PhasePoint& start, std::vector<StrobedPoint>& out) {
  drive.phase_rad = 0.0;
  const double flash_s = kTurn / drive.rate_rad_s / sweep.phases;
  FrictionOscillator oscillator{law, drive, flash_s / sweep.steps_per_flash, start};
  for (int flash = 0; flash < sweep.periods * sweep.phases; ++flash) {
    const int phase = flash % sweep.phases;
    if (flash >= sweep.skipped_periods * sweep.phases)
      out.push_back({oscillator.point(), regime, phase, kTurn * phase / sweep.phases,
                     oscillator.input_mps2(), oscillator.sticks()});
    for (int i = 0; i < sweep.steps_per_flash; ++i) oscillator.step();
  }
  return oscillator.point();
}

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
  const double outside =
      first_place(length_s, [&](double s) { return leaves_mode(runge_kutta(s)); });
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
  const double outside = first_place(length_s, [&](double s) { return breaks_loose(time_s_ + s); });
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

std::vector<StrobedPoint> strobe(const OscillatorLaw& law, const SectionSweep& sweep) {
  std::vector<StrobedPoint> out;
  Random random{sweep.seed, Stream::kShocks};
  PhasePoint state;
  int regime = 0;
  for (const OscillatorDrive& drive : sweep.regimes) {
    for (int start = 0; start < sweep.starts; ++start) {
      if (sweep.start_spread > 0.0)
        state = {sweep.start_spread * (2.0 * random.uniform() - 1.0),
                 sweep.start_spread * (2.0 * random.uniform() - 1.0), 0.0};
      state = run_regime(law, sweep, drive, regime++, state, out);
    }
  }
  if (sweep.noise > 0.0) add_noise(out, sweep.noise, sweep.seed);
  return out;
}

std::vector<OscillatorDrive> moving_regimes() {
  std::vector<OscillatorDrive> out;
  for (const double mean : {-1.0, 1.0, 3.0})
    for (const double swing : {1.2, 3.0, 6.0})
      for (const double rate : {0.5, 1.0, 2.0}) out.push_back({mean, swing, rate, 0.0});
  return out;
}

std::vector<OscillatorDrive> random_regimes(int count, std::uint64_t seed) {
  Random random{seed, Stream::kTrack};
  std::vector<OscillatorDrive> out;
  for (int i = 0; i < count; ++i) {
    const double mean = -1.0 + 4.0 * random.uniform();
    const double swing = 1.2 + 4.8 * random.uniform();
    const double rate = 0.5 * std::pow(4.0, random.uniform());
    out.push_back({mean, swing, rate, 0.0});
  }
  return out;
}

double steady_amplitude(const OscillatorLaw& law, const OscillatorDrive& drive, int settle_periods,
                        int measured_periods, int steps_per_period) {
  const double step_s = kTurn / drive.rate_rad_s / steps_per_period;
  FrictionOscillator oscillator{law, drive, step_s};
  for (int i = 0; i < settle_periods * steps_per_period; ++i) {
    oscillator.step();
    if (!(std::abs(oscillator.point().deflection_m) < kUnbounded))
      return std::numeric_limits<double>::infinity();
  }
  HarmonicMeter meter{drive.rate_rad_s};
  const PhasePoint first = oscillator.point();
  bool moved = false;
  for (int i = 0; i < measured_periods * steps_per_period; ++i) {
    const PhasePoint p = oscillator.point();
    meter.add(oscillator.time_s(), p.deflection_m);
    moved = moved || p.deflection_m != first.deflection_m;
    oscillator.step();
  }
  return moved ? meter.amplitude().value : 0.0;
}

}  // namespace dampline::sim
