// SPDX-License-Identifier: MIT
#include "simulated_rig.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace dampline::test {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr int kStepsPerSample = 10;

double rounded(double x, double step) { return step > 0.0 ? step * std::round(x / step) : x; }

}  // namespace

SimulatedRig::SimulatedRig(const Truth& truth, std::vector<Tone> tones)
    : truth_{truth}, tones_{std::move(tones)} {}

double SimulatedRig::drive_n(double time_s) const {
  double sum = 0.0;
  for (const Tone& tone : tones_)
    sum += tone.force_n * std::sin(kTwoPi * tone.frequency_hz * time_s + tone.phase_rad);
  return sum;
}

/// The part of the motion that follows the tones, without friction.
SimulatedRig::State SimulatedRig::forced(double time_s) const {
  State out{time_s, 0.0, 0.0, 0};
  for (const Tone& tone : tones_) {
    const double w = kTwoPi * tone.frequency_hz;
    const std::complex<double> impedance{truth_.stiffness_npm - truth_.mass_kg * w * w,
                                         truth_.viscous_nspm * w};
    const std::complex<double> x =
        std::polar(tone.force_n, w * time_s + tone.phase_rad) / impedance;
    out.deflection_m += x.imag();
    out.velocity_mps += (std::complex<double>{0.0, w} * x).imag();
  }
  return out;
}

SimulatedRig::State SimulatedRig::slide(const State& from, double time_s) const {
  const double decay = truth_.viscous_nspm / (2.0 * truth_.mass_kg);
  const double w = std::sqrt(truth_.stiffness_npm / truth_.mass_kg - decay * decay);
  const double shift = -from.direction * truth_.coulomb_n / truth_.stiffness_npm;
  const State start = forced(from.time_s);
  const double a = from.deflection_m - start.deflection_m - shift;
  const double b = (from.velocity_mps - start.velocity_mps + decay * a) / w;
  const double t = time_s - from.time_s;
  const double c = std::cos(w * t);
  const double s = std::sin(w * t);
  const double fade = std::exp(-decay * t);
  State out = forced(time_s);
  out.deflection_m += shift + fade * (a * c + b * s);
  out.velocity_mps += fade * ((b * w - decay * a) * c - (a * w + decay * b) * s);
  out.direction = from.direction;
  return out;
}

SimulatedRig::State SimulatedRig::advance(const State& from, double time_s) const {
  if (from.direction != 0) return slide(from, time_s);
  return {time_s, from.deflection_m, 0.0, 0};
}

bool SimulatedRig::changes(const State& from, const State& to) const {
  if (from.direction != 0) return to.velocity_mps * from.direction < 0.0;
  const double pull = drive_n(to.time_s) - truth_.stiffness_npm * to.deflection_m;
  return std::abs(pull) > truth_.coulomb_n;
}

SimulatedRig::State SimulatedRig::turn(const State& at) const {
  const double pull = drive_n(at.time_s) - truth_.stiffness_npm * at.deflection_m;
  State out = at;
  out.velocity_mps = 0.0;
  const bool leaves = at.direction == 0 || std::abs(pull) > truth_.coulomb_n;
  out.direction = leaves ? (pull > 0.0 ? 1 : -1) : 0;
  return out;
}

SimulatedRig::State SimulatedRig::step(State state, double time_s) const {
  const double start_s = state.time_s;
  for (int i = 1; i <= kStepsPerSample; ++i) {
    const double end_s = start_s + (time_s - start_s) * i / kStepsPerSample;
    for (int turns = 0; turns < 4 && changes(state, advance(state, end_s)); ++turns) {
      double before = state.time_s;
      double after = end_s;
      for (int n = 0; n < 60; ++n) {
        const double middle = 0.5 * (before + after);
        (changes(state, advance(state, middle)) ? after : before) = middle;
      }
      state = turn(advance(state, after));
    }
    state = advance(state, end_s);
  }
  return state;
}

std::vector<rig::Sample> SimulatedRig::record(double rate_hz, double length_s,
                                              const Sensors& sensors, std::uint64_t seed) {
  std::vector<rig::Sample> out;
  State state;
  const auto samples = static_cast<std::int64_t>(rate_hz * length_s);
  const auto settle = static_cast<std::int64_t>(2.0 * rate_hz);
  for (std::int64_t tick = -settle; tick < samples; ++tick) {
    if (tick == -settle) state.time_s = static_cast<double>(tick) / rate_hz;
    rig::Sample sample;
    sample.tick = tick;
    sample.deflection_m = state.deflection_m;
    sample.force_n = drive_n(state.time_s) + truth_.offset_n;
    if (tick >= 0) out.push_back(sample);
    state = step(state, static_cast<double>(tick + 1) / rate_hz);
  }
  return measure(std::move(out), sensors, seed);
}

std::vector<rig::Sample> measure(std::vector<rig::Sample> record,
                                 const SimulatedRig::Sensors& sensors, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> gauss;
  for (rig::Sample& sample : record) {
    sample.deflection_m = rounded(sample.deflection_m + sensors.deflection_noise_m * gauss(random),
                                  sensors.deflection_step_m);
    sample.force_n =
        rounded(sample.force_n + sensors.force_noise_n * gauss(random), sensors.force_step_n);
  }
  return record;
}

}  // namespace dampline::test
