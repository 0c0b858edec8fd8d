// SPDX-License-Identifier: MIT
#include "dampline/density/fokker_planck.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>

#include "tests/density/white_run.hpp"

namespace dampline {
namespace {

constexpr std::uint64_t kFirstSeed = 101;  // 1...12 served to choose limits and bandwidths
constexpr std::uint64_t kSeeds = 12;

struct Worst {
  double weak{0.0}, weak_curve{0.0}, paper{0.0}, known{0.0}, known_curve{0.0};
};

void note(double& worst, double error) { worst = std::max(worst, std::abs(error)); }

TEST(FokkerPlanck, FindsTheLevelAndTheCurveOfWhiteInput) {
  Worst worst;
  double weak_mean = 0.0;
  double paper_mean = 0.0;
  double pulls = 0.0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed) {
    const auto run = white_run({.seed = seed}, 300.0);
    const auto found = run->estimates(kMassKg, kStiffnessNpm);
    ASSERT_TRUE(found.weak.verdict.trusted) << seed;
    ASSERT_TRUE(found.paper.verdict.trusted) << seed;
    ASSERT_TRUE(found.known_input.verdict.trusted) << seed;
    const double weak = found.weak.level_n.value / kLevelN - 1.0;
    const double paper = found.paper.level_n.value / kLevelN - 1.0;
    weak_mean += weak / kSeeds;
    paper_mean += paper / kSeeds;
    pulls += std::pow((found.weak.level_n.value - kLevelN) / found.weak.level_n.std, 2) / kSeeds;
    note(worst.weak, weak);
    note(worst.paper, paper);
    note(worst.known, found.known_input.level_n.value / kLevelN - 1.0);
    note(worst.weak_curve, curve_error(found.weak, run->velocities()));
    note(worst.known_curve, curve_error(found.known_input, run->velocities()));
  }
  std::cout << "weak: mean " << 100.0 * weak_mean << " %, worst " << 100.0 * worst.weak
            << " %, curve " << 100.0 * worst.weak_curve << " %; paper: mean " << 100.0 * paper_mean
            << " %, worst " << 100.0 * worst.paper << " %; pulls " << std::sqrt(pulls) << '\n';
  EXPECT_LT(worst.weak, 0.03);
  EXPECT_LT(worst.weak_curve, 0.10);
  EXPECT_LT(worst.paper, 0.05);
  EXPECT_LT(worst.known, 1e-3);
  EXPECT_LT(worst.known_curve, 1e-3);
  EXPECT_GT(std::sqrt(pulls), 0.5);  // stated deviations are those that are found
  EXPECT_LT(std::sqrt(pulls), 1.6);
}

TEST(FokkerPlanck, ShowsTheAsymmetryOnlyOfAnAbsoluteDeflection) {
  const sim::WhiteInputConfig white{
      .seed = 5, .friction_positive_n = 9150.0, .friction_negative_n = 7562.0};
  for (const bool absolute : {true, false}) {
    const auto run = white_run(white, 300.0, {.deflection_is_absolute = absolute});
    const auto found = run->estimates(kMassKg, kStiffnessNpm);
    double sum = 0.0;  // of F(v) over both signs: twice the constant, over the nodes
    std::size_t nodes = 0;
    for (std::size_t i = 0; i < found.known_input.points; ++i) {
      if (std::abs(found.known_input.curve[i].velocity_mps) < 3e-3) continue;
      sum += found.known_input.curve[i].force_n;
      ++nodes;
    }
    EXPECT_NEAR(sum / static_cast<double>(nodes), absolute ? 0.5 * (9150.0 - 7562.0) : 0.0, 30.0);
    EXPECT_NEAR(found.weak.level_n.value / kLevelN, 1.0, 0.03);
  }
}

// The whole: a viscous part appears as a slope of the curve.
TEST(FokkerPlanck, FindsAViscousSlope) {
  const auto run = white_run({.seed = 6, .viscous_nspm = 3.0e5, .input_level = 2.0e-2}, 1'000.0);
  const auto found = run->estimates(kMassKg, kStiffnessNpm);
  const MethodResult& weak = found.weak;
  ASSERT_TRUE(weak.verdict.has_number);
  ASSERT_EQ(weak.points, 2 * (kCurveSegments + 1));
  const auto force_n = [&](std::size_t node) {  // odd part; node 6: 19 mm/s, node 8: 40 mm/s
    return 0.5 * (weak.curve[9 + node].force_n - weak.curve[8 - node].force_n);
  };
  const double slope = (force_n(8) - force_n(6)) / 21.0e-3;
  EXPECT_NEAR(slope / 3.0e5, 1.0, 0.25);
}

TEST(FokkerPlanck, ForgetsWhatWasBefore) {
  FokkerPlanck now{{.memory_s = 40.0}};
  const auto ride = [&](double friction_n, std::uint64_t seed, double length_s,
                        std::int64_t from_tick) {
    sim::WhiteInput source{
        {.seed = seed, .friction_positive_n = friction_n, .friction_negative_n = friction_n}};
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(300.0 * length_s); ++i) {
      Motion m = source.next();
      m.tick += from_tick;
      now.update(m);
    }
  };
  ride(8000.0, 1, 200.0, 0);
  ride(4000.0, 2, 400.0, 60'000);
  const auto found = now.estimates(kMassKg, kStiffnessNpm);
  ASSERT_TRUE(found.known_input.verdict.has_number);
  EXPECT_NEAR(found.known_input.level_n.value, 4000.0, 10.0);
  EXPECT_NEAR(found.weak.level_n.value, 4000.0, 0.15 * 4000.0);
}

TEST(FokkerPlanck, TwoHalvesMergeToTheWhole) {
  const FokkerPlanckConfig config{.velocity_mps = {.low = -0.1, .high = 0.1},
                                  .deflection_m = {.low = -5e-3, .high = 5e-3}};
  FokkerPlanck whole{config};
  FokkerPlanck first{config};
  FokkerPlanck second{config};
  sim::WhiteInput source{{.seed = 8}};
  for (int i = 0; i < 60'000; ++i) {
    const Motion m = source.next();
    whole.update(m);
    (i < 30'000 ? first : second).update(m);
  }
  const auto merged = first.merge(second);
  ASSERT_TRUE(merged.ok());
  EXPECT_EQ(merged.value(), 60'000U);
  for (std::size_t b = 0; b < kVelocityBins; ++b) {
    EXPECT_EQ(first.velocities().mass(b), whole.velocities().mass(b));
  }
  const auto a = first.estimates(kMassKg, kStiffnessNpm);
  const auto b = whole.estimates(kMassKg, kStiffnessNpm);
  EXPECT_NEAR(a.known_input.level_n.value, b.known_input.level_n.value, 1e-6);
  // The periodograms that the cut goes through are lost.
  EXPECT_NEAR(a.weak.level_n.value / b.weak.level_n.value, 1.0, 0.01);
  FokkerPlanckConfig other = config;
  other.velocity_mps.high = 0.2;
  const auto refused = first.merge(FokkerPlanck{other});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error(), Errc::kMismatch);
}

TEST(FokkerPlanck, ChecksItsConfiguration) {
  EXPECT_TRUE(FokkerPlanck::check({}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.sample_rate_hz = 100.0}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.velocity_mps = {}}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.memory_s = 0.5}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.anti_alias_corner_hz = -1.0}).ok());
  FokkerPlanckConfig nodes;
  nodes.curve_nodes_mps[3] = nodes.curve_nodes_mps[2];
  EXPECT_FALSE(FokkerPlanck::check(nodes).ok());
  EXPECT_FALSE(FokkerPlanck::check({.memory_s = std::numeric_limits<double>::quiet_NaN()}).ok());
}

}  // namespace
}  // namespace dampline
