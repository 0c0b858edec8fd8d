// SPDX-License-Identifier: MIT
// The vehicle under a track, with sensors, and its level through the shipped identifier.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "app/record/frames.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "dampline/identifier.hpp"
#include "sim_hw/nodes.hpp"
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

/// A pitching car as it is simulated and configured from the command line.
struct WholeCar {
  SimulationConfig simulation;
  IdentifierConfig identifier;
  explicit WholeCar(Load load, TruckPosition instrumented, bool extras)
      : simulation{vehicle_run(load, instrumented)} {
    ModeEffects& modes = simulation.truck.modes;
    modes.pitch_inertia_kgm2 = kFramePitchInertiaKgm2;
    simulation.extra_sensors = extras;
    const VehicleMasses masses = masses_of(*simulation.vehicle, simulation.truck);
    identifier.estimator.moving_mass_kg = masses.own_kg;
    if (!extras) return;
    identifier.estimator.far_mass_kg = masses.other_kg;
    identifier.estimator.frame_pitch_mass_kg =
        modes.pitch_inertia_kgm2 / std::pow(modes.pitch_half_wheelbase_m, 2);
  }
  [[nodiscard]] double level_n() const {
    return 0.5 * (simulation.truck.friction_positive_n + simulation.truck.friction_negative_n);
  }
};

TEST(VehicleSimulation, IsExplainedByThePitchOfItsFrame) {
  const WholeCar car{Load::kLaden, TruckPosition::kTrailing, false};
  const auto identifier = std::make_unique<BasicIdentifier<kDiagnosisParts>>(car.identifier);
  Simulation simulation{car.simulation};
  for (int i = 0; i < 90 * kSampleRateHz; ++i) identifier->push(to_sample(simulation.next()));
  identifier->finish();
  const auto explainer = std::make_unique<effect::Explainer>();
  const effect::Explanation found = identifier->explanation(
      *explainer, {.moving_mass_kg = car.identifier.estimator.moving_mass_kg});
  ASSERT_EQ(found.step_count, 1U);
  EXPECT_EQ(found.step[0].chosen.effect, effect::Effect::kUnmodelledMode);
  EXPECT_EQ(found.step[0].chosen.form, effect::kPitchForm);
  EXPECT_LT(found.base_coulomb_n.value, 0.95 * car.level_n());
  EXPECT_NEAR(found.final_coulomb_n.value, car.level_n(), 0.03 * car.level_n());
  const double stiffness_npm = car.simulation.truck.stiffness_npm;
  EXPECT_NEAR(found.final_stiffness_npm.value, stiffness_npm, 0.05 * stiffness_npm);
}

/// Of the known input, at the mass and the stiffness of the reduction.
TrustVerdict known_input_of(const SimulationConfig& config, double mass_kg) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{.moving_mass_kg = mass_kg});
  const auto densities = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{});
  Simulation simulation{config};
  for (int i = 0; i < 60 * kSampleRateHz; ++i) {
    const UpdateResult result = identifier->update(to_sample(simulation.next()));
    if (result.has_motion) densities->update(result.motion);
  }
  return densities->estimates(mass_kg, config.truck.stiffness_npm).known_input.verdict;
}

TEST(VehicleSimulation, IsNotTrustedToTheKnownInputWhereItsFramesPitch) {
  for (const Load load : {Load::kLaden, Load::kEmpty}) {
    const SimulationConfig alone = reference_run(load, 60.0, 7);
    EXPECT_TRUE(known_input_of(alone, alone.truck.moving_mass_kg).trusted);
    const WholeCar car{load, TruckPosition::kLeading, false};
    const TrustVerdict whole =
        known_input_of(car.simulation, car.identifier.estimator.moving_mass_kg);
    EXPECT_FALSE(whole.trusted);
    EXPECT_TRUE(whole.violates(Reason::kBentCurve));
  }
}

TEST(VehicleSimulation, IsATruckAgainByTwoMoreAccelerometers) {
  const WholeCar car{Load::kLaden, TruckPosition::kTrailing, true};
  const auto identifier = std::make_unique<Estimator>(car.identifier.estimator);
  Simulation simulation{car.simulation};
  for (int i = 0; i < 60 * kSampleRateHz; ++i)
    static_cast<void>(identifier->update(to_sample(simulation.next())));
  identifier->finish();
  const Snapshot found = identifier->snapshot();
  EXPECT_NEAR(found.coulomb_n.value, car.level_n(), 0.01 * car.level_n());
  EXPECT_NEAR(found.stiffness_npm.value, car.simulation.truck.stiffness_npm, 2.0e5);
}

TEST(VehicleSimulation, SendsItsExtrasInFramesOfTheirOwn) {
  const WholeCar car{Load::kEmpty, TruckPosition::kLeading, true};
  app::Config config;
  config.car.frame_pitch_mass_kg = 1850.0;
  for (const bool both : {false, true}) {
    if (both) config.car.far_mass_kg = 1200.0;
    SampleAssembler assembler{app::can_channels(config)};
    Simulation simulation{car.simulation};
    SensorNodes nodes{{}, 1};
    std::vector<SimulatedSample> sent;
    std::size_t next = 0;
    for (int i = 0; i < 300; ++i) {
      sent.push_back(simulation.next());
      for (const CanFrame& frame : nodes.pack(sent.back())) assembler.push(frame);
      for (const CanFrame& frame : nodes.pack_extras(sent.back())) assembler.push(frame);
      for (Sample sample; assembler.pop(sample); ++next) {
        EXPECT_NEAR(sample.extra_mps2[0], sent[next].extra_mps2[0], 1e-4);
        EXPECT_NEAR(sample.extra_mps2[1], both ? sent[next].extra_mps2[1] : 0.0, 1e-4);
      }
    }
    EXPECT_GE(next, 299U);
    assembler.flush();
    EXPECT_EQ(ledger_of(assembler.counts(), 0).foreign, both ? 0U : 300U);
  }
}

}  // namespace
}  // namespace dampline::sim
