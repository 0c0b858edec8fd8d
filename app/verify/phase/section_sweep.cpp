// SPDX-License-Identifier: MIT
#include "app/verify/phase/section_sweep.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "published/phase/harmonic_meter.hpp"
#include "sim_hw/noise.hpp"

namespace dampline::sim {
namespace {

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
