// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "sim_hw/noise.hpp"
#include "tests/estimator/record.hpp"

namespace dampline {
namespace {

TEST(Estimator, FitsInHalfAMebibyte) {
  std::cout << "sizeof(Estimator) = " << sizeof(Estimator) << " bytes\n";
  EXPECT_LT(sizeof(Estimator), 512U * 1024U);
}

TEST(Estimator, GivesMotionOfAnEarlierSampleAtAConstantLag) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  std::int64_t lag = -1;
  int motions = 0;
  std::int64_t last_tick = -1;
  for (const Sample& s : laden_record()) {
    const UpdateResult result = identifier->update(s);
    if (!result.has_motion) continue;
    ++motions;
    if (lag < 0) lag = s.tick - result.motion.tick;
    ASSERT_EQ(s.tick - result.motion.tick, lag);
    if (last_tick >= 0) {
      ASSERT_EQ(result.motion.tick, last_tick + 1);
    }
    last_tick = result.motion.tick;
  }
  EXPECT_GT(motions, 27000);
  EXPECT_NEAR(static_cast<double>(lag) / 300.0, identifier->motion_latency_s(), 1e-9);
  EXPECT_LT(identifier->motion_latency_s(), 5.0);
  EXPECT_LT(identifier->velocity_latency_s(), 3.0);
}

class MotionAtRate : public testing::TestWithParam<double> {};

// At the highest rate the accelerations have to be kept longest.
TEST_P(MotionAtRate, CarriesTheAccelerationsOfItsOwnSample) {
  const auto identifier =
      std::make_unique<Estimator>(EstimatorConfig{.sample_rate_hz = GetParam()});
  int motions = 0;
  for (std::int64_t tick = 0; tick < 6000; ++tick) {
    const double t = static_cast<double>(tick);
    Sample sample{.tick = tick};
    sample.accel_mps2 = {std::sin(0.1 * t), std::sin(0.07 * t) + 0.01 * t, std::cos(0.05 * t)};
    const UpdateResult result = identifier->update(sample);
    if (!result.has_motion) continue;
    ++motions;
    const auto then = static_cast<double>(result.motion.tick);
    const double input = -(std::sin(0.07 * then) + 0.01 * then + std::cos(0.05 * then));
    ASSERT_DOUBLE_EQ(result.motion.frame_mps2, std::sin(0.1 * then));
    ASSERT_NEAR(result.motion.input_mps2(), input, 1e-12);
  }
  EXPECT_GT(motions, 2000);
}
INSTANTIATE_TEST_SUITE_P(Rates, MotionAtRate, testing::Values(150.0, 300.0, 400.0));

// Motion of a sample is told later than its velocity is counted.
TEST(Estimator, CountsVelocitiesByTheNearestNodeOfTheCurve) {
  constexpr std::int64_t kBegin = 2400;
  constexpr std::int64_t kEnd = 9000;
  const auto counting = std::make_unique<Estimator>(EstimatorConfig{});
  const auto telling = std::make_unique<Estimator>(EstimatorConfig{});
  const std::int64_t latency = std::lround(300.0 * counting->velocity_latency_s());
  VelocityCounts expected;
  for (std::int64_t i = 0; i < kEnd + 600; ++i) {
    const Sample& sample = laden_record()[static_cast<std::size_t>(i)];
    if (i == kBegin) counting->clear_statistics();
    if (i < kEnd) counting->update(sample);
    const UpdateResult result = telling->update(sample);
    const std::int64_t tick = result.motion.tick + latency;
    if (!result.has_motion || result.motion.still || tick < kBegin || tick >= kEnd) continue;
    const double speed = std::abs(result.motion.velocity_mps);
    const auto nearest = std::min_element(
        kDefaultCurveNodesMps.begin(), kDefaultCurveNodesMps.end(),
        [&](double a, double b) { return std::abs(a - speed) < std::abs(b - speed); });
    const auto node = static_cast<std::size_t>(nearest - kDefaultCurveNodesMps.begin());
    ++(result.motion.velocity_mps > 0.0 ? expected.positive : expected.negative)[node];
    ++expected.moving;
    expected.sticking += speed < 2e-3 ? 1 : 0;
    expected.sum_squares += speed * speed;
  }
  const auto counted = std::make_unique<Statistics>();
  counting->export_statistics(*counted);
  const VelocityCounts& velocity = counted->header.velocity;
  EXPECT_EQ(velocity.moving, 6600U);
  EXPECT_EQ(velocity.moving, expected.moving);
  EXPECT_EQ(velocity.positive, expected.positive);
  EXPECT_EQ(velocity.negative, expected.negative);
  EXPECT_EQ(velocity.sticking, expected.sticking);
  EXPECT_NEAR(velocity.sum_squares / expected.sum_squares, 1.0, 1e-12);
}

TEST(Estimator, TellsStandstillFromMotion) {
  auto config = sim::reference_run(sim::Load::kLaden, 80.0, 99);
  config.speed.standstills[0] = {60.0, 90.0};
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  int still_at_rest = 0;
  int still_under_way = 0;
  for (const Sample& sample : simulate(config, 100.0)) {
    const UpdateResult result = identifier->update(sample);
    if (!result.has_motion || !result.motion.still) continue;
    const double time_s = static_cast<double>(result.motion.tick) / 300.0;
    if (time_s > 60.0 && time_s < 90.0) ++still_at_rest;
    if (time_s > 5.0 && time_s < 15.0) ++still_under_way;
  }
  EXPECT_GT(still_at_rest, 29 * 300);
  EXPECT_EQ(still_under_way, 0);
}

// As when somebody works on a wagon that stands: no wheelset feels a rail.
TEST(Estimator, AFrameThatSwingsOnQuietWheelsetsIsStill) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  int motions = 0;
  for (std::int64_t tick = 0; tick < 20 * 300; ++tick) {
    Sample sample;
    sample.tick = tick;
    const double turn = 2.0 * std::numbers::pi * 3.0 * static_cast<double>(tick) / 300.0;
    const double noise = 1e-3 * static_cast<double>(tick * 7919 % 101);
    sample.accel_mps2 = {9.81 + 2.0 * std::sin(turn), 9.81 + noise, 9.81 - 0.5 * noise};
    const UpdateResult result = identifier->update(sample);
    if (!result.has_motion || result.motion.tick < 4 * 300) continue;
    ++motions;
    EXPECT_GT(std::abs(result.motion.velocity_mps), 0.0);
    ASSERT_TRUE(result.motion.still) << tick;
  }
  EXPECT_GT(motions, 5 * 300);
}

/// A suspension that moves by a sine of this velocity, rms, for 15 s and rests then, on wheelsets
/// whose mean changes by so much from sample to sample, rms: the times at which it is still.
std::vector<double> still_times(double velocity_mps, double change_mps2) {
  const auto estimator = std::make_unique<Estimator>(EstimatorConfig{.velocity_corner_hz = 1.0});
  std::vector<double> out;
  for (std::int64_t tick = 0; tick < 30 * 300; ++tick) {
    constexpr double kTurnPs = 2.0 * std::numbers::pi * 6.0;
    const double time_s = static_cast<double>(tick) / 300.0;
    const double relative_mps2 =
        time_s < 15.0 ? std::sqrt(2.0) * velocity_mps * kTurnPs * std::cos(kTurnPs * time_s) : 0.0;
    const double track_mps2 = 0.5 * change_mps2 * (tick % 2 == 0 ? 1.0 : -1.0);
    Sample sample{.tick = tick};
    sample.accel_mps2 = {track_mps2 + 0.5 * relative_mps2, track_mps2, track_mps2};
    const UpdateResult result = estimator->update(sample);
    if (result.has_motion && result.motion.still)
      out.push_back(static_cast<double>(result.motion.tick) / 300.0);
  }
  return out;
}

// 2 mm/s rms of the suspension, and 0.2 m/s^2 rms from sample to sample of the wheelsets.
TEST(Estimator, StandsStillBelowALeastMotionOfEither) {
  const auto moves = [](double velocity_mps, double change_mps2) {
    const auto still = still_times(velocity_mps, change_mps2);
    return std::none_of(still.begin(), still.end(), [](double t) { return t > 6.0 && t < 14.0; });
  };
  EXPECT_TRUE(moves(2.2e-3, 1.0));
  EXPECT_FALSE(moves(1.8e-3, 1.0));
  EXPECT_TRUE(moves(0.02, 0.22));
  EXPECT_FALSE(moves(0.02, 0.18));
}

// Squares are smoothed over a quarter of a second: of 20 mm/s a hundredth is left after 4.6 of
// them.
TEST(Estimator, StandsStillASecondAfterItsMotion) {
  const auto still = still_times(0.02, 1.0);
  const auto first = std::find_if(still.begin(), still.end(), [](double t) { return t > 10.0; });
  ASSERT_NE(first, still.end());
  EXPECT_NEAR(*first - 15.0, 0.25 * std::log(100.0), 0.1);
}

TEST(Estimator, KnowsARowsLatency) {
  // The row whose centre lies in the last stride of block 0 is counted when its reach is complete.
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  std::int64_t closed_at = -1;
  for (const Sample& s : laden_record()) {
    if (identifier->update(s).block_closed) {
      closed_at = s.tick;
      break;
    }
  }
  EXPECT_NEAR(static_cast<double>(closed_at - 600) / 300.0, identifier->row_latency_s(),
              2.0 / 300.0);
  EXPECT_LT(identifier->row_latency_s(), 3.5);
}

TEST(Estimator, ItsLevelIsThatOfItsSnapshotToTheLastBit) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  int compared = 0;
  std::size_t samples = 0;
  for (const Sample& sample : laden_record()) {
    static_cast<void>(identifier->update(sample));
    if (++samples % 3000 != 0) continue;
    const Snapshot snapshot = identifier->snapshot();
    const Level level = identifier->level();
    EXPECT_EQ(level.valid, snapshot.valid);
    EXPECT_EQ(level.coulomb_n.value, snapshot.coulomb_n.value);
    EXPECT_EQ(level.coulomb_n.std, snapshot.coulomb_n.std);
    EXPECT_EQ(level.stiffness_npm.value, snapshot.stiffness_npm.value);
    EXPECT_EQ(level.stiffness_npm.std, snapshot.stiffness_npm.std);
    if (level.valid) ++compared;
  }
  EXPECT_GE(compared, 7);
}

TEST(Estimator, PausesAtAStandstill) {
  auto config = sim::reference_run(sim::Load::kLaden, 80.0, 99);
  config.speed.standstills[0] = {60.0, 90.0};
  const Snapshot s = identify(simulate(config, 150.0)).snapshot;
  EXPECT_GE(s.counts.blocks_still, 10U);
  EXPECT_GT(s.counts.rows_still, 0U);
  EXPECT_EQ(s.counts.blocks_excluded, 0U);
  EXPECT_NEAR(s.coulomb_n.value / kLadenCoulombN, 1.0, 0.01);
  EXPECT_NEAR(s.stiffness_npm.value / kLadenStiffnessNpm, 1.0, 0.03);
  EXPECT_LT(s.excitation, 0.95);
}

TEST(Estimator, SaysNothingOfACarThatNeverMoved) {
  auto config = sim::reference_run(sim::Load::kLaden, 80.0, 7);
  config.speed.standstills[0] = {0.0, 1000.0};
  auto record = simulate(config, 60.0);
  const Snapshot s = identify(record).snapshot;
  EXPECT_FALSE(s.valid);
  EXPECT_EQ(s.counts.rows, 0U);
}

TEST(Estimator, SaysNothingOfTooShortARecord) {
  const std::vector<Sample> record(laden_record().begin(), laden_record().begin() + 2000);
  EXPECT_FALSE(identify(record).snapshot.valid);
}

TEST(Estimator, ChoosesTheCornerByTheNoise) {
  const auto corner_of = [](double noise_mps2) {
    auto config = sim::reference_run(sim::Load::kLaden, 80.0, 12);
    config.sensors.noise_mps2 = noise_mps2;
    const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
    for (const Sample& s : simulate(config, 10.0)) identifier->update(s);
    const auto statistics = std::make_unique<Statistics>();
    identifier->export_statistics(*statistics);
    return statistics->header.velocity_corner_hz;
  };
  EXPECT_EQ(corner_of(0.02), 0.7);
  EXPECT_EQ(corner_of(0.1), 1.0);
}

/// Of a frame at rest whose sensors are so noisy.
double corner_at_rest_hz(const EstimatorConfig& config, double noise_mps2) {
  sim::Random random{3, sim::Stream::kSensors};
  const auto estimator = std::make_unique<Estimator>(config);
  for (std::int64_t tick = 0; tick < 1500; ++tick) {
    Sample sample{.tick = tick};
    for (double& accel : sample.accel_mps2) accel = noise_mps2 * random.normal();
    estimator->update(sample);
  }
  const auto statistics = std::make_unique<Statistics>();
  estimator->export_statistics(*statistics);
  return statistics->header.velocity_corner_hz;
}

TEST(Estimator, ChoosesTheHigherCornerAboveALeastNoise) {
  EXPECT_EQ(corner_at_rest_hz({}, 0.043), 0.7) << "below 0.05";
  EXPECT_EQ(corner_at_rest_hz({}, 0.057), 1.0);
}

TEST(Estimator, KeepsTheCornerThatIsSet) {
  for (const double corner_hz : {0.7, 1.0})
    for (const double noise_mps2 : {0.02, 0.1})
      EXPECT_EQ(corner_at_rest_hz({.velocity_corner_hz = corner_hz}, noise_mps2), corner_hz)
          << noise_mps2;
}

// Of a constant no velocity comes, from the first one on: none is given that reaches back before
// the record.
TEST(Estimator, TakesNoBeginningForMotion) {
  const auto estimator = std::make_unique<Estimator>(EstimatorConfig{});
  int motions = 0;
  for (std::int64_t tick = 0; tick < 3000; ++tick) {
    Sample sample{.tick = tick};
    const double track_mps2 = tick % 2 == 0 ? 1.0 : -1.0;
    sample.accel_mps2 = {9.81 + track_mps2, track_mps2, track_mps2};
    const UpdateResult result = estimator->update(sample);
    if (!result.has_motion) continue;
    ++motions;
    ASSERT_NEAR(result.motion.velocity_mps, 0.0, 1e-9) << result.motion.tick;
    ASSERT_NEAR(result.motion.deflection_m, 0.0, 1e-9) << result.motion.tick;
  }
  EXPECT_GT(motions, 500);
}

/// Friction rises by 30 % in the middle: who forgets knows only the second half.
TEST(Estimator, AWindowForgetsWhatIsOlder) {
  auto config = sim::reference_run(sim::Load::kLaden, 80.0, 21);
  auto record = simulate(config, 80.0);
  config.truck.friction_scale = 1.3;
  for (Sample s : simulate(config, 80.0)) {
    s.tick += 80 * 300 + 600;
    record.push_back(s);
  }
  const double second_n = 1.3 * kLadenCoulombN;
  const double infinite_n = identify(record).snapshot.coulomb_n.value;
  EXPECT_GT(infinite_n, 1.08 * kLadenCoulombN);
  EXPECT_LT(infinite_n, 0.95 * second_n);
  const Snapshot window = identify(record, {.memory = Memory::kWindow, .memory_s = 60.0}).snapshot;
  EXPECT_NEAR(window.coulomb_n.value / second_n, 1.0, 0.015);
  EXPECT_EQ(window.blocks_in_estimate, 30U);
  const Snapshot forgetting =
      identify(record, {.memory = Memory::kForgetting, .memory_s = 15.0}).snapshot;
  EXPECT_NEAR(forgetting.coulomb_n.value / second_n, 1.0, 0.02);
}

TEST(Estimator, RefusesEachSettingThatIsOutOfRange) {
  const auto refused = [](const auto& change) {
    EstimatorConfig config;
    change(config);
    const auto result = Estimator::check(config);
    return !result.ok() && result.error() == Errc::kInvalidConfig;
  };
  using C = EstimatorConfig;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(refused([](C&) {})) << "the defaults are in range";
  EXPECT_TRUE(refused([](C& c) { c.sample_rate_hz = 149.8; }));
  EXPECT_TRUE(refused([](C& c) { c.sample_rate_hz = 400.1; }));
  EXPECT_TRUE(refused([&](C& c) { c.sample_rate_hz = nan; }));
  EXPECT_TRUE(refused([](C& c) { c.moving_mass_kg = 0.0; }));
  EXPECT_TRUE(refused([](C& c) { c.moving_mass_kg = -1.0; }));
  EXPECT_TRUE(refused([&](C& c) { c.moving_mass_kg = nan; }));
  EXPECT_TRUE(refused([](C& c) { c.velocity_corner_hz = 0.8; }));
  EXPECT_TRUE(refused([&](C& c) { c.velocity_corner_hz = nan; }));
  EXPECT_TRUE(refused([](C& c) { c.curve_nodes_mps[0] = 0.0; }));
  EXPECT_TRUE(refused([](C& c) { c.curve_nodes_mps[4] = c.curve_nodes_mps[3]; }));
  EXPECT_TRUE(refused([&](C& c) { c.curve_nodes_mps[2] = nan; }));
  EXPECT_TRUE(refused([](C& c) { c.curve_nodes_mps[7] = 11.0; }));
  EXPECT_TRUE(refused([](C& c) { c.screen.moved_mps2 = 0.0; }));
  EXPECT_TRUE(refused([](C& c) { c.anti_alias.corner_hz = -1.0; }));
  EXPECT_TRUE(refused([&](C& c) { c.anti_alias.corner_hz = nan; }));
  EXPECT_TRUE(refused([](C& c) { c.anti_alias.order = 0; }));
  EXPECT_TRUE(refused([](C& c) { c.anti_alias.order = 9; }));
  EXPECT_TRUE(refused([](C& c) { c.memory = Memory::kWindow; })) << "a window of no length";
  EXPECT_TRUE(refused([](C& c) {
    c.memory = Memory::kForgetting;
    c.memory_s = 1.0;
  }));
  EXPECT_TRUE(refused([&](C& c) {
    c.memory = Memory::kWindow;
    c.memory_s = nan;
  }));
}

TEST(Estimator, TakesSettingsUpToTheirLimits) {
  const auto taken = [](const EstimatorConfig& config) { return Estimator::check(config).ok(); };
  EXPECT_TRUE(taken({.sample_rate_hz = 149.85}));
  EXPECT_TRUE(taken({.sample_rate_hz = 400.0}));
  EXPECT_TRUE(taken({.moving_mass_kg = 0.1}));
  EXPECT_TRUE(taken({.screen = {.sample_rate_hz = -1.0}})) << "which is the estimator's";
  EXPECT_TRUE(taken({.velocity_corner_hz = 0.7}));
  EXPECT_TRUE(taken({.velocity_corner_hz = 1.0}));
  EXPECT_TRUE(taken({.anti_alias = {.corner_hz = 0.0, .order = 1}}));
  EXPECT_TRUE(taken({.anti_alias = {.corner_hz = 100.0, .order = 8}}));
  EXPECT_TRUE(taken({.memory = Memory::kWindow, .memory_s = 2.0}));
  EXPECT_TRUE(taken({.memory = Memory::kForgetting, .memory_s = 2.0}));
  EXPECT_TRUE(taken({.memory = Memory::kInfinite, .memory_s = 0.0}));
  EXPECT_FALSE(taken({.memory = Memory::kWindow, .memory_s = 1.999}));
  EstimatorConfig nodes;
  nodes.curve_nodes_mps.back() = 9.99;
  EXPECT_TRUE(taken(nodes));
  nodes.curve_nodes_mps.back() = 10.0;
  EXPECT_FALSE(taken(nodes));
}

TEST(Estimator, RefusesAnInfiniteMassOrMemory) {
  EstimatorConfig mass;
  mass.moving_mass_kg = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(Estimator::check(mass).ok());
  for (const Memory memory : {Memory::kWindow, Memory::kForgetting}) {
    EstimatorConfig config;
    config.memory = memory;
    config.memory_s = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(Estimator::check(config).ok());
  }
}

}  // namespace
}  // namespace dampline
