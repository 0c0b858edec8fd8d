// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <vector>

#include "app/verify/phase/simulated.hpp"
#include "published/phase/friction_map.hpp"
#include "published/phase/planarity.hpp"

namespace dampline::phase_test {

/// The slowest velocity that surely moves, given the share of noise.
inline double least_speed_mps(const std::vector<sim::StrobedPoint>& points, double noise) {
  double sum = 0.0;
  for (const sim::StrobedPoint& p : points) sum += p.point.velocity_mps * p.point.velocity_mps;
  return kMovingSigmas * noise * std::sqrt(sum / static_cast<double>(points.size())) + 1e-9;
}

/// Planarity of sections whose input's amplitude and mean are not known.
inline PlanarityVerdict planarity(const std::vector<sim::StrobedPoint>& points, double noise) {
  PlanarityTest<1> test{least_speed_mps(points, noise)};
  int regime = 0;
  for (const sim::StrobedPoint& p : points) {
    if (p.regime != regime) test.end_regime();
    regime = p.regime;
    test.add(p.point, p.phase_rad);
  }
  return test.verdict();
}

/// Regimes that a fixed seed draws; each seed another set of them and of the noise.
inline sim::SectionSweep random_sweep(double noise, std::uint64_t seed) {
  return {.regimes = sim::random_regimes(18, seed),
          .phases = 8,
          .periods = 12,
          .skipped_periods = 0,
          .steps_per_flash = 40,
          .start_spread = 2.0,
          .noise = noise,
          .seed = seed};
}

}  // namespace dampline::phase_test
