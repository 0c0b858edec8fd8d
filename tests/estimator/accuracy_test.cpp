// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "bench/accuracy_case.hpp"

namespace dampline {
namespace {

/// The accuracy table in small: one condition, one fresh seed, 60 s.
class AccuracyAfter60s : public testing::TestWithParam<std::tuple<std::size_t, std::uint64_t>> {};
INSTANTIATE_TEST_SUITE_P(FourConditions, AccuracyAfter60s,
                         testing::Combine(testing::Values(0U, 1U, 2U, 3U),
                                          testing::Values(90210U, 90211U)));

TEST_P(AccuracyAfter60s, IsWithinTheStatedBounds) {
  const auto [condition, seed] = GetParam();
  const bench::AccuracyCase c = bench::standard_cases()[condition];
  SCOPED_TRACE(c.name);
  const bench::RunErrors errors = bench::run_case(c, seed, {60.0});
  const bench::Errors& e = errors.at[0];
  ASSERT_TRUE(e.snapshot.valid);
  EXPECT_LE(std::abs(e.coulomb), 0.01);
  EXPECT_LE(std::abs(e.stiffness), 0.03);
  EXPECT_LE(std::abs(e.false_viscous), 0.02);
  EXPECT_LE(e.curve, 0.035);
  EXPECT_LE(std::abs(e.coulomb_sigmas), 4.0);
  EXPECT_LE(std::abs(e.stiffness_sigmas), 4.0);
  EXPECT_LE(errors.velocity, 0.09);
  EXPECT_LE(errors.deflection, condition % 2 == 0 ? 0.30 : 0.60);
  EXPECT_FALSE(e.snapshot.std_is_lower_bound);
}

TEST(Estimator, CannotTellAnAsymmetryFromAccelerations) {
  bench::AccuracyCase even = bench::standard_cases()[0];
  bench::AccuracyCase odd = even;
  even.simulation.truck.friction_positive_n = even.simulation.truck.friction_negative_n = 8356.0;
  odd.simulation.truck.friction_positive_n = 7562.0;
  odd.simulation.truck.friction_negative_n = 9150.0;
  const Snapshot a = bench::run_case(even, 4, {60.0}).at[0].snapshot;
  const Snapshot b = bench::run_case(odd, 4, {60.0}).at[0].snapshot;
  EXPECT_NEAR(a.coulomb_n.value / b.coulomb_n.value, 1.0, 0.005);
  EXPECT_NEAR(a.stiffness_npm.value / b.stiffness_npm.value, 1.0, 0.005);
}

TEST(Estimator, TellsFrictionLevelsApart) {
  bench::AccuracyCase more = bench::standard_cases()[0];
  more.simulation.truck.friction_scale = 1.3;
  EXPECT_LE(std::abs(bench::run_case(more, 5, {60.0}).at[0].coulomb), 0.01);
}

/// Little motion, so that the truck sticks for a third of the time: one width of the law would have
/// the level 3 % high.
TEST(Estimator, KnowsTheLevelWhereTheTruckSticks) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    bench::AccuracyCase c = bench::standard_cases()[0];
    c.simulation.speed.speed_mps = 50.0 / 3.6;
    c.simulation.track.short_wave_mps2 = 0.5;
    const bench::Errors e = bench::run_case(c, seed, {200.0}).at[0];
    ASSERT_TRUE(e.snapshot.valid);
    EXPECT_GT(e.snapshot.stick_share, 0.25);
    EXPECT_TRUE(e.snapshot.std_is_lower_bound);
    EXPECT_LE(std::abs(e.coulomb), 0.025);
    EXPECT_LE(std::abs(e.coulomb_sigmas), 2.0);
    EXPECT_LE(std::abs(e.stiffness_sigmas), 2.0);
    EXPECT_LE(e.snapshot.coulomb_n.std, 0.025 * e.snapshot.coulomb_n.value);
  }
}

}  // namespace
}  // namespace dampline
