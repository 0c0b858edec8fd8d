// SPDX-License-Identifier: MIT
// The estimate for small parts beside the full one, over the same samples; bench/small_parts prints
// the same over 48 records.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "bench/accuracy_case.hpp"
#include "dampline/identifier.hpp"
#include "tests/estimator/record.hpp"

namespace dampline {
namespace {

/// What the full and the small estimate say of a record.
std::pair<Snapshot, Snapshot> both(const std::vector<Sample>& record,
                                   const EstimatorConfig& config = {}) {
  const auto small = std::make_unique<SmallIdentifier>(IdentifierConfig{.estimator = config});
  for (const Sample& sample : record) small->push(sample);
  small->finish();
  return {identify(record, config).snapshot, small->snapshot()};
}

double apart(const Estimate& a, const Estimate& b) { return std::abs(b.value / a.value - 1.0); }

void expect_alike(const Snapshot& full, const Snapshot& small) {
  ASSERT_TRUE(full.valid && small.valid);
  EXPECT_EQ(full.blocks_in_estimate, small.blocks_in_estimate);
  EXPECT_LT(apart(full.coulomb_n, small.coulomb_n), 1e-4);
  EXPECT_LT(apart(full.stiffness_npm, small.stiffness_npm), 2e-4);
  EXPECT_NEAR(small.coulomb_n.std / full.coulomb_n.std, 1.0, 0.5);
  EXPECT_NEAR(small.stiffness_npm.std / full.stiffness_npm.std, 1.0, 0.6);
  EXPECT_NEAR(small.held_out_nmse / full.held_out_nmse, 1.0, 0.2);
  for (std::size_t i = 0; i < kCurveSegments; ++i)
    if (full.curve[i].samples > 1000) {
      EXPECT_NEAR(small.curve[i].force_n / full.curve[i].force_n, 1.0, 2e-3) << i;
    }
}

class SmallParts : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(FourConditions, SmallParts, testing::Values(0U, 1U, 2U, 3U));

TEST_P(SmallParts, SayWhatTheFullEstimateSays) {
  const bench::AccuracyCase c = bench::standard_cases()[GetParam()];
  SCOPED_TRACE(c.name);
  sim::SimulationConfig simulation = c.simulation;
  simulation.seed = 90310;
  EstimatorConfig config;
  config.moving_mass_kg = simulation.truck.moving_mass_kg;
  const auto [full, small] = both(simulate(simulation, 120.0), config);
  expect_alike(full, small);
  EXPECT_LE(std::abs(small.coulomb_n.value / c.coulomb_n() - 1.0),
            4.0 * small.coulomb_n.std / c.coulomb_n());
}

TEST(SmallParts, SayItAcrossGapsAndStuckSamples) {
  std::vector<Sample> record = laden_record();
  for (std::size_t i = 12000; i < 12200; ++i) record[i].accel_mps2[1] = 1.0;
  record.erase(record.begin() + 18000, record.begin() + 18900);
  const auto [full, small] = both(record);
  expect_alike(full, small);
  EXPECT_EQ(full.counts.stuck, small.counts.stuck);
  EXPECT_EQ(full.counts.rows, small.counts.rows);
}

TEST(SmallParts, ForgetAsTheFullEstimateDoes) {
  const auto [full, small] =
      both(laden_record(), {.memory = Memory::kForgetting, .memory_s = 30.0});
  ASSERT_TRUE(full.valid && small.valid);
  EXPECT_LT(apart(full.coulomb_n, small.coulomb_n), 2e-3);
  EXPECT_LT(apart(full.stiffness_npm, small.stiffness_npm), 5e-3);
}

TEST(SmallParts, RefuseWhatTheyHaveNoRoomFor) {
  EXPECT_TRUE(SmallEstimator::check({}).ok());
  EXPECT_FALSE(SmallEstimator::check({.sample_rate_hz = 301.0}).ok());
  EXPECT_FALSE(SmallEstimator::check({.memory = Memory::kWindow, .memory_s = 60.0}).ok());
}

}  // namespace
}  // namespace dampline
