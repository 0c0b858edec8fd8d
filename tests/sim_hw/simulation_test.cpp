// SPDX-License-Identifier: MIT
#include "sim_hw/simulation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace dampline::sim {
namespace {

struct Levels {
  double deflection_m, mean_deflection_m, velocity_mps, frame_mps2, wheelset_mps2;
};

Levels levels(const SimulationConfig& config, int seconds) {
  Simulation simulation{config};
  Levels sum{};
  const int samples = seconds * kSampleRateHz;
  for (int i = 0; i < samples; ++i) {
    const SimulatedSample s = simulation.next();
    sum.mean_deflection_m += s.truth.deflection_m / samples;
    sum.deflection_m += std::pow(s.truth.deflection_m, 2) / samples;
    sum.velocity_mps += std::pow(s.truth.velocity_mps, 2) / samples;
    sum.frame_mps2 += std::pow(s.truth.frame_mps2, 2) / samples;
    sum.wheelset_mps2 += std::pow(s.accel_mps2[1], 2) / samples;
  }
  return {std::sqrt(sum.deflection_m - std::pow(sum.mean_deflection_m, 2)), sum.mean_deflection_m,
          std::sqrt(sum.velocity_mps), std::sqrt(sum.frame_mps2), std::sqrt(sum.wheelset_mps2)};
}

TEST(Simulation, MovesAsMuchAsTheMethodStudySays) {
  // METHODS: y 0.43 to 0.83 mm, v 12 to 18 mm/s, z_b'' 0.21 to 0.3 m/s^2 over loads and speeds
  const Levels laden80 = levels(reference_run(Load::kLaden, 80.0, 1), 300);
  EXPECT_NEAR(laden80.deflection_m, 0.80e-3, 0.12e-3);
  EXPECT_NEAR(laden80.velocity_mps, 17.5e-3, 1.5e-3);
  EXPECT_NEAR(laden80.frame_mps2, 0.23, 0.02);
  const Levels laden60 = levels(reference_run(Load::kLaden, 60.0, 1), 300);
  EXPECT_NEAR(laden60.deflection_m, 0.42e-3, 0.08e-3);
  EXPECT_NEAR(laden60.velocity_mps, 12e-3, 1.5e-3);
  const Levels empty80 = levels(reference_run(Load::kEmpty, 80.0, 1), 300);
  EXPECT_NEAR(empty80.velocity_mps, 15e-3, 1.5e-3);
  EXPECT_NEAR(empty80.frame_mps2, 0.29, 0.02);
}

TEST(Simulation, ShowsTheSameAccelerationForUnequalFrictionOfTheSameMean) {
  SimulationConfig unequal = reference_run(Load::kLaden, 80.0, 2);
  SimulationConfig equal = unequal;
  equal.truck.friction_positive_n = equal.truck.friction_negative_n = 8356.0;
  Simulation a{unequal};
  Simulation b{equal};
  double difference = 0.0;
  double power = 0.0;
  double shift = 0.0;
  constexpr int kSamples = 30000;
  for (int i = 0; i < kSamples; ++i) {
    const SimulatedSample x = a.next();
    const SimulatedSample y = b.next();
    difference += std::pow(x.truth.frame_mps2 - y.truth.frame_mps2, 2);
    power += std::pow(y.truth.frame_mps2, 2);
    shift += (x.truth.deflection_m - y.truth.deflection_m) / kSamples;
  }
  EXPECT_LT(std::sqrt(difference / power), 0.006);
  EXPECT_NEAR(shift, (9150.0 - 7562.0) / 2.0 / 5.26e6, 5e-6);
}

TEST(Simulation, RepeatsItselfFromTheSeedAndOnlyFromIt) {
  Simulation a{reference_run(Load::kLaden, 80.0, 7)};
  Simulation b{reference_run(Load::kLaden, 80.0, 7)};
  Simulation c{reference_run(Load::kLaden, 80.0, 8)};
  int different = 0;
  for (int i = 0; i < 3000; ++i) {
    const SimulatedSample x = a.next();
    const SimulatedSample y = b.next();
    ASSERT_EQ(x.counts, y.counts);
    ASSERT_EQ(x.truth.velocity_mps, y.truth.velocity_mps);
    different += x.counts != c.next().counts ? 1 : 0;
  }
  EXPECT_GT(different, 2900);
}

TEST(Simulation, KeepsTheTrackWhenTheNoiseChanges) {
  SimulationConfig noisy = reference_run(Load::kLaden, 80.0, 7);
  noisy.sensors.noise_mps2 = 0.1;
  Simulation a{reference_run(Load::kLaden, 80.0, 7)};
  Simulation b{noisy};
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(a.next().truth.velocity_mps, b.next().truth.velocity_mps);
  }
}

TEST(Simulation, LetsTheSecondWheelsetFollowTheFirst) {
  // sum of both wheelsets: a comb with its first null at V / (2 L), 6.17 Hz at 80 km/h
  SimulationConfig config = reference_run(Load::kLaden, 80.0, 3);
  config.sensors.noise_mps2 = 0.0;
  Simulation simulation{config};
  const double null_hz = 80.0 / 3.6 / 3.6;
  constexpr int kBlock = 3000;
  double sum_power = 0.0;
  double one_power = 0.0;
  for (int block = 0; block < 20; ++block) {
    std::complex<double> one;
    std::complex<double> sum;
    for (int i = 0; i < kBlock; ++i) {
      const SimulatedSample s = simulation.next();
      const double window = 1.0 - std::cos(2.0 * std::numbers::pi * i / kBlock);
      const auto turn = std::polar(window, -2.0 * std::numbers::pi * null_hz * i / kSampleRateHz);
      one += turn * s.accel_mps2[1];
      sum += turn * (s.accel_mps2[1] + s.accel_mps2[2]);
    }
    one_power += std::norm(one);
    sum_power += std::norm(sum);
  }
  EXPECT_LT(sum_power, 0.02 * one_power);
}

TEST(Simulation, StandsStillAndChangesItsSpeed) {
  SimulationConfig config = reference_run(Load::kLaden, 80.0, 3);
  config.speed.standstills[0] = {40.0, 60.0};
  config.speed.change_time_s = 100.0;
  Simulation simulation{config};
  double still = 0.0;
  double moving_after = 0.0;
  double last_position = 0.0;
  double last_speed = 80.0 / 3.6;
  for (int i = 0; i < 120 * kSampleRateHz; ++i) {
    const SimulatedSample s = simulation.next();
    if (i > 0) {
      const double mean = 0.5 * (s.speed_mps + last_speed);
      ASSERT_NEAR(s.position_m - last_position, mean / kSampleRateHz, 1e-5);
    }
    last_position = s.position_m;
    last_speed = s.speed_mps;
    if (s.time_s > 45.0 && s.time_s < 60.0) {
      still = std::max(still, std::abs(s.truth.velocity_mps));
      ASSERT_EQ(s.speed_mps, 0.0);
    }
    if (s.time_s > 90.0 && s.time_s < 100.0) {
      ASSERT_NEAR(s.speed_mps, 80.0 / 3.6, 1e-9);
      moving_after = std::max(moving_after, std::abs(s.truth.velocity_mps));
    }
  }
  EXPECT_LT(still, 1e-3);
  EXPECT_GT(moving_after, 10e-3);
  EXPECT_NEAR(last_speed, 60.0 / 3.6, 1e-9);
}

TEST(Simulation, StandsStillTwice) {
  SpeedConfig config;
  config.standstills = {{{100.0, 200.0}, {300.0, 400.0}}};
  for (const double moving_s : {0.0, 50.0, 250.0, 450.0})
    EXPECT_DOUBLE_EQ(speed_at(config, moving_s).speed_mps, config.speed_mps) << moving_s;
  for (const double still_s : {101.0, 199.0, 301.0, 399.0})
    EXPECT_EQ(speed_at(config, still_s).speed_mps, 0.0) << still_s;
}

TEST(Simulation, DecodesItsCountsAndMarksFullScale) {
  SimulationConfig config = reference_run(Load::kLaden, 80.0, 3);
  config.sensors.range_mps2[1] = 3.0;
  Simulation simulation{config};
  int saturated = 0;
  for (int i = 0; i < 9000; ++i) {
    const SimulatedSample s = simulation.next();
    const bool full = s.counts[1] == 2047 || s.counts[1] == -2048;
    ASSERT_EQ(s.saturated, full ? 2 : 0);
    ASSERT_EQ(s.accel_mps2[1], s.counts[1] * 3.0 / 2048.0);
    const Sample sample = to_sample(s);
    ASSERT_EQ(sample.tick, i);
    ASSERT_NEAR(static_cast<double>(sample.time_ns), i * 1e9 / 300.0, 1.0);
    ASSERT_EQ(sample.accel_mps2, s.accel_mps2);
    saturated += full ? 1 : 0;
  }
  EXPECT_GT(saturated, 100);
}

TEST(Simulation, ShowsFilteredTruthAtTheStatedDelay) {
  Simulation simulation{reference_run(Load::kLaden, 80.0, 3)};
  const double delay = anti_alias_delay_s({}) * kSampleRateHz;  // 1.24 samples
  std::vector<double> instant;
  double error = 0.0;
  double power = 0.0;
  for (int i = 0; i < 9000; ++i) {
    const SimulatedSample s = simulation.next();
    instant.push_back(s.instant.deflection_m);
    if (i < 2) continue;
    const double late =
        instant[instant.size() - 2] * (2.0 - delay) + instant[instant.size() - 3] * (delay - 1.0);
    error += std::pow(late - s.truth.deflection_m, 2);
    power += std::pow(s.truth.deflection_m, 2);
  }
  EXPECT_LT(std::sqrt(error / power), 0.02);
}

}  // namespace
}  // namespace dampline::sim
