// SPDX-License-Identifier: MIT
// The vehicle under a track, with sensors, and its level through the shipped identifier.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "dampline/damping/estimator.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {
namespace {

SimulationConfig vehicle_run(Load load, TruckPosition instrumented,
                             const VehicleConfig& base = {}) {
  SimulationConfig config = reference_run(load, 80.0, 4);
  config.vehicle = base;
  config.vehicle->instrumented = instrumented;
  return config;
}

VehicleConfig uncoupled_vehicle() {
  VehicleConfig config;
  config.gyration_radius_m = config.half_pivot_distance_m;
  return config;
}

TEST(VehicleSimulation, OfTheReductionIsThatOfTheTruck) {
  Simulation truck{reference_run(Load::kLaden, 80.0, 4)};
  Simulation vehicle{vehicle_run(Load::kLaden, TruckPosition::kLeading, uncoupled_vehicle())};
  for (int i = 0; i < 3000; ++i) {
    const SimulatedSample a = truck.next();
    const SimulatedSample b = vehicle.next();
    ASSERT_NEAR(a.instant.velocity_mps, b.instant.velocity_mps, 1e-10);
    ASSERT_EQ(a.counts[1], b.counts[1]);
    ASSERT_EQ(a.counts[2], b.counts[2]);
    ASSERT_NEAR(a.counts[0], b.counts[0], 1.0);
  }
}

TEST(VehicleSimulation, LetsTheTrailingTruckFollow) {
  VehicleConfig base;
  constexpr int kDelay = 120;  // samples
  base.half_pivot_distance_m = 0.5 * 80.0 / 3.6 * kDelay / kSampleRateHz;
  const auto quiet = [&](TruckPosition position) {
    SimulationConfig config = vehicle_run(Load::kLaden, position, base);
    config.sensors.noise_mps2 = config.sensors.bias_mps2 = config.sensors.drift_mps2 = 0.0;
    return config;
  };
  Simulation leading{quiet(TruckPosition::kLeading)};
  Simulation trailing{quiet(TruckPosition::kTrailing)};
  std::vector<SimulatedSample> first;
  int frames_alike = 0;
  for (int i = 0; i < 3000; ++i) {
    first.push_back(leading.next());
    const SimulatedSample b = trailing.next();
    if (i < kDelay) continue;
    const SimulatedSample& a = first[static_cast<std::size_t>(i - kDelay)];
    ASSERT_NEAR(a.position_m, b.position_m, 1e-9);
    ASSERT_NEAR(a.counts[1], b.counts[1], 1.0);
    ASSERT_NEAR(a.counts[2], b.counts[2], 1.0);
    frames_alike += std::abs(a.counts[0] - b.counts[0]) <= 1 ? 1 : 0;
  }
  EXPECT_LT(frames_alike, 2000);  // each end of the body feels the other
}

TEST(VehicleSimulation, GivesEachTruckNoiseOfItsOwn) {
  VehicleConfig base;
  base.half_pivot_distance_m = 1e-9;  // the same place
  base.gyration_radius_m = 1e-9;
  Simulation leading{vehicle_run(Load::kLaden, TruckPosition::kLeading, base)};
  Simulation trailing{vehicle_run(Load::kLaden, TruckPosition::kTrailing, base)};
  int different = 0;
  for (int i = 0; i < 300; ++i)
    different += leading.next().counts[0] != trailing.next().counts[0] ? 1 : 0;
  EXPECT_GT(different, 100);
}

/// Level and stiffness that the shipped identifier finds, by `mass_kg`.
Snapshot identified(const SimulationConfig& config, double mass_kg, int seconds) {
  Simulation simulation{config};
  EstimatorConfig identifier_config;
  identifier_config.moving_mass_kg = mass_kg;
  const auto identifier = std::make_unique<Estimator>(identifier_config);
  for (int i = 0; i < seconds * kSampleRateHz; ++i)
    static_cast<void>(identifier->update(to_sample(simulation.next())));
  return identifier->snapshot();
}

TEST(VehicleSimulation, HasALevelThatTheIdentifierFinds) {
  const Snapshot reduced = identified(
      vehicle_run(Load::kLaden, TruckPosition::kTrailing, uncoupled_vehicle()), 37200.0, 60);
  ASSERT_TRUE(reduced.valid);
  EXPECT_NEAR(reduced.coulomb_n.value, 8356.0, 0.015 * 8356.0);
  EXPECT_NEAR(reduced.stiffness_npm.value, 5.26e6, 0.03 * 5.26e6);
}

}  // namespace
}  // namespace dampline::sim
