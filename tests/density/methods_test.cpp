// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <memory>

#include "dampline/identifier.hpp"
#include "sim_hw/simulation.hpp"
#include "tests/density/white_run.hpp"

namespace dampline {
namespace {

FokkerPlanckEstimates track_run(const sim::SimulationConfig& config, double length_s) {
  const EstimatorConfig identifier_config{.moving_mass_kg = config.truck.moving_mass_kg};
  const auto identifier = std::make_unique<Estimator>(identifier_config);
  const auto density = std::make_unique<FokkerPlanck>(density_config(identifier_config));
  sim::Simulation simulation{config};
  for (int i = 0; i < static_cast<int>(length_s * sim::kSampleRateHz); ++i) {
    const UpdateResult result = identifier->update(sim::to_sample(simulation.next()));
    if (result.has_motion) density->update(result.motion);
  }
  return density->estimates(config.truck.moving_mass_kg, config.truck.stiffness_npm);
}

struct Ride {
  sim::Load load;
  double speed_kmh;
  double amplitude;
};

class OnTrack : public testing::TestWithParam<Ride> {};

TEST_P(OnTrack, KnownInputIsRightAndTheOthersAreRefused) {
  const Ride ride = GetParam();
  auto config = sim::reference_run(ride.load, ride.speed_kmh, 301);
  config.track.amplitude_m_rad = ride.amplitude;
  const double level_n =
      0.5 * (config.truck.friction_positive_n + config.truck.friction_negative_n);
  const auto found = track_run(config, 60.0);
  EXPECT_TRUE(found.known_input.verdict.trusted);
  EXPECT_NEAR(found.known_input.level_n.value / level_n, 1.0, 0.02);
  for (const MethodResult* method : {&found.paper, &found.weak}) {
    EXPECT_TRUE(method->verdict.has_number);
    EXPECT_FALSE(method->verdict.trusted);
    EXPECT_GT(method->verdict[Reason::kColouredInput].size,
              1.5 * method->verdict[Reason::kColouredInput].limit);
  }
}

INSTANTIATE_TEST_SUITE_P(Conditions, OnTrack,
                         testing::Values(Ride{sim::Load::kLaden, 60.0, sim::kTrackAmplitudeLow},
                                         Ride{sim::Load::kLaden, 80.0, sim::kTrackAmplitudeHigh},
                                         Ride{sim::Load::kEmpty, 60.0, sim::kTrackAmplitudeHigh},
                                         Ride{sim::Load::kEmpty, 80.0, sim::kTrackAmplitudeLow}));

TEST(Densities, LeavesStandstillOut) {
  auto config = sim::reference_run(sim::Load::kLaden, 80.0, 302);
  config.speed.standstills[0] = {70.0, 100.0};
  const EstimatorConfig identifier_config{};
  const auto identifier = std::make_unique<Estimator>(identifier_config);
  const auto density = std::make_unique<FokkerPlanck>(density_config(identifier_config));
  sim::Simulation simulation{config};
  for (int i = 0; i < 120 * sim::kSampleRateHz; ++i) {
    const UpdateResult result = identifier->update(sim::to_sample(simulation.next()));
    if (result.has_motion) density->update(result.motion);
  }
  EXPECT_GT(density->still(), 29U * 300U);
  EXPECT_LT(density->velocities().density(kVelocityBins / 2), 200.0);
}

TEST(Densities, TakesMemoryAndNodesFromTheIdentifier) {
  EstimatorConfig config{.memory = Memory::kWindow, .memory_s = 120.0};
  config.anti_alias.corner_hz = 50.0;
  config.curve_nodes_mps[0] = 2.0e-3;
  const FokkerPlanckConfig out = density_config(config);
  EXPECT_EQ(out.memory_s, 60.0);
  EXPECT_EQ(out.anti_alias_corner_hz, 50.0);
  EXPECT_EQ(out.curve_nodes_mps[0], 2.0e-3);
  EXPECT_TRUE(FokkerPlanck::check(out).ok());
}

}  // namespace
}  // namespace dampline
