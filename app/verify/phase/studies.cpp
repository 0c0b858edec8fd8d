// SPDX-License-Identifier: MIT
#include "app/verify/phase/studies.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::app {
namespace {

using sim::StrobedPoint;

double least_speed_mps(const std::vector<StrobedPoint>& points, double noise) {
  double sum = 0.0;
  for (const StrobedPoint& p : points) sum += p.point.velocity_mps * p.point.velocity_mps;
  return kMovingSigmas * noise * std::sqrt(sum / static_cast<double>(points.size())) + 1e-9;
}

std::vector<StrobedPoint> random_sections(const sim::OscillatorLaw& law, double noise,
                                          std::uint64_t seed) {
  return sim::strobe(law, {.regimes = sim::random_regimes(18, seed),
                           .phases = 8,
                           .periods = 12,
                           .skipped_periods = 0,
                           .steps_per_flash = 40,
                           .start_spread = 2.0,
                           .noise = noise,
                           .seed = seed});
}

SectionMeans<8> steady_sections(const sim::OscillatorLaw& law, double swing_mps2, double noise,
                                std::uint64_t seed) {
  SectionMeans<8> means;
  for (const StrobedPoint& p : sim::strobe(law, {.regimes = {{0.0, swing_mps2, 0.8, 0.0}},
                                                .phases = 8,
                                                .periods = 100,
                                                .skipped_periods = 50,
                                                .steps_per_flash = 40,
                                                .noise = noise,
                                                .seed = seed}))
    means.add(p.phase, p.point, p.input_mps2);
  return means;
}

std::vector<StrobedPoint> structural_sections(const std::vector<sim::OscillatorDrive>& regimes,
                                              double start_spread, int starts, double noise,
                                              std::uint64_t seed) {
  return sim::strobe({.friction_mps2 = 1.0, .reversal_m = kStudyReversalM},
                     {.regimes = regimes,
                      .phases = 8,
                      .periods = 3,
                      .skipped_periods = 0,
                      .steps_per_flash = 40,
                      .start_spread = start_spread,
                      .starts = starts,
                      .noise = noise,
                      .seed = seed});
}

void compare(const FrictionCurve<kStudyNodes>& curve, FrictionStudy& out) {
  double friction = 0.0;
  double restoring = 0.0;
  double friction_size = 0.0;
  double restoring_size = 0.0;
  for (const FrictionNode& n : curve.nodes) {
    if (!n.resolved) continue;
    const double g = std::abs(1.0 + n.deflection_m / kStudyReversalM);
    const double error = n.friction_mps2.value - g;
    friction += error * error;
    friction_size += g * g;
    restoring += std::pow(n.restoring_mps2.value - n.deflection_m, 2);
    restoring_size += n.deflection_m * n.deflection_m;
    out.friction_inside += std::abs(error) < 2.0 * n.friction_mps2.std ? 1 : 0;
    ++out.nodes;
  }
  out.friction_error = std::sqrt(friction / friction_size);
  out.restoring_error = std::sqrt(restoring / restoring_size);
}

/// Every `stride`-th flash counts; nodes over +- reach.
FrictionStudy map_friction(const std::vector<StrobedPoint>& points, double reach_m, int stride,
                           double noise) {
  using Map = FrictionMap<kStudyNodes>;
  Map map = Map::make({-reach_m, reach_m, least_speed_mps(points, noise)}).value();
  for (const StrobedPoint& p : points)
    if (p.phase % stride == 0) map.add(p.point, p.input_mps2);
  FrictionStudy out{.points = map.points(),
                    .stuck = map.slow(),
                    .law = FrictionLawFit<kStudyNodes, false>::fit(map),
                    .curve = map.curve()};
  compare(out.curve, out);
  return out;
}

}  // namespace

std::size_t AmplitudeSweep::largest() const {
  return static_cast<std::size_t>(std::max_element(amplitude_m.begin(), amplitude_m.end()) -
                                  amplitude_m.begin());
}

bool AmplitudeSweep::has_peak_inside() const {
  const std::size_t at = largest();
  return amplitude_m[at] > 0.0 && at > 0 && at + 1 < amplitude_m.size();
}

AmplitudeSweep sweep_amplitude(const sim::OscillatorLaw& law, double swing_mps2,
                               const SweepBand& band) {
  AmplitudeSweep out;
  for (int i = 0; i < band.count; ++i) {
    const double rate =
        band.low_rad_s + (band.high_rad_s - band.low_rad_s) * i / (band.count - 1.0);
    out.rate_rad_s.push_back(rate);
    out.amplitude_m.push_back(sim::steady_amplitude(law, {0.0, swing_mps2, rate, 0.0},
                                                    band.settle_periods, 3, band.steps_per_period));
  }
  return out;
}

Resonance viscous_resonance() {
  const AmplitudeSweep sweep = sweep_amplitude({.viscous_per_s = 1.0}, 0.5,
                                               {.low_rad_s = 0.5, .high_rad_s = 0.9, .count = 9});
  ResonanceFit fit;
  for (std::size_t i = 0; i < sweep.rate_rad_s.size(); ++i)
    fit.add(sweep.rate_rad_s[i], sweep.amplitude_m[i]);
  return fit.resonance();
}

PlanarityVerdict study_planarity(const sim::OscillatorLaw& law, double noise, std::uint64_t seed) {
  const std::vector<StrobedPoint> points = random_sections(law, noise, seed);
  PlanarityTest<1> test{least_speed_mps(points, noise)};
  int regime = 0;
  for (const StrobedPoint& p : points) {
    if (p.regime != regime) test.end_regime();
    regime = p.regime;
    test.add(p.point, p.phase_rad);
  }
  return test.verdict();
}

PlanarityIndices study_indices(const sim::OscillatorLaw& law, double noise, std::uint64_t seed) {
  const std::vector<StrobedPoint> points = random_sections(law, noise, seed);
  PlanarityTest<0> one{least_speed_mps(points, noise)};
  PlanarityTest<0> all{least_speed_mps(points, noise)};
  for (const StrobedPoint& p : points) {
    all.add(p.point, p.phase_rad, p.input_mps2);
    if (p.phase == 2) one.add(p.point, p.phase_rad, p.input_mps2);
  }
  return {one.verdict().index, all.verdict().index};
}

ScalingVerdict study_scaling(const sim::OscillatorLaw& law, double noise, std::uint64_t seed) {
  return judge_scaling(steady_sections(law, 1.5, noise, 2 * seed),
                       steady_sections(law, 3.0, noise, 2 * seed + 1));
}

FrictionStudy study_friction(double noise, std::uint64_t seed, int phases) {
  const auto points = structural_sections(sim::moving_regimes(), 3.0, 24 * 8 / phases, noise, seed);
  return map_friction(points, 6.0, 8 / phases, noise);
}

FrictionStudy study_published_inputs(const PublishedInputs& inputs, double start_spread,
                                     double noise, std::uint64_t seed) {
  std::vector<sim::OscillatorDrive> regimes;
  for (const double rate : inputs.rates_rad_s) {
    for (const double swing : inputs.swings_mps2) {
      for (const double mean : inputs.means_mps2) regimes.push_back({mean, swing, rate, 0.0});
    }
  }
  const int starts = start_spread > 0.0 ? 24 : 1;
  return map_friction(structural_sections(regimes, start_spread, starts, noise, seed), 6.0, 1,
                      noise);
}

}  // namespace dampline::app
