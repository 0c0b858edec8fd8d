// SPDX-License-Identifier: MIT
#include "sim_hw/sensors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "dampline/motion/butterworth.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {
namespace {

SensorConfig ideal() {
  SensorConfig config;
  config.noise_mps2 = config.bias_mps2 = config.drift_mps2 = 0.0;
  return config;
}

/// Amplitude and phase of the anti-alias filter at one frequency, by driving it.
std::complex<double> response(double hz) {
  ButterworthLowPass<1> filter{100.0, 2400.0};
  std::complex<double> sum;
  constexpr int kSteps = 24000;
  for (int i = 0; i < 2 * kSteps; ++i) {
    const double angle = 2.0 * std::numbers::pi * hz * i / 2400.0;
    const double out = filter.update({std::cos(angle)})[0];
    if (i >= kSteps) sum += out * std::polar(2.0 / kSteps, -angle);
  }
  return sum;
}

TEST(AntiAliasFilter, IsAFourthOrderButterworthLowPassAt100Hz) {
  EXPECT_NEAR(std::abs(response(100.0)), std::numbers::sqrt2 / 2.0, 1e-6);
  EXPECT_NEAR(std::abs(response(10.0)), 1.0, 1e-6);
  const double warped = std::tan(std::numbers::pi / 12.0) / std::tan(std::numbers::pi / 24.0);
  EXPECT_NEAR(std::abs(response(200.0)), 1.0 / std::sqrt(1.0 + std::pow(warped, 8)), 1e-6);
}

TEST(AntiAliasFilter, DelaysByTheStatedTime) {
  const double angle = std::arg(response(3.0));
  EXPECT_NEAR(-angle / (2.0 * std::numbers::pi * 3.0), anti_alias_delay_s(ideal()), 1e-6);
}

TEST(Sensors, QuantiseToTwelveBits) {
  Sensors sensors{ideal(), 1};
  const double lsb = 5.0 * 9.80665 / 2048.0;
  EXPECT_EQ(sensors.convert({lsb, 2.0 * lsb, 0.0}, 0.0), (std::array<std::int16_t, 3>{1, 1, 0}));
  EXPECT_EQ(sensors.convert({0.49 * lsb, -1.02 * lsb, 0.51 * lsb}, 0.0)[0], 0);
  EXPECT_EQ(sensors.convert({0.51 * lsb, 0.0, 0.0}, 0.0)[0], 1);
  EXPECT_EQ(sensors.convert({-10.4 * lsb, 0.0, 0.0}, 0.0)[0], -10);
}

TEST(Sensors, StandAtFullScaleCodesBeyondTheirRange) {
  Sensors sensors{ideal(), 1};
  EXPECT_EQ(sensors.convert({60.0, -120.0, 98.1}, 0.0),
            (std::array<std::int16_t, 3>{2047, -2048, 2047}));
  SensorConfig limited = ideal();
  limited.limit_mps2 = {0.0, 3.0, 0.0};
  Sensors soft{limited, 1};
  EXPECT_EQ(soft.convert({0.0, 50.0, 0.0}, 0.0)[1], std::lround(3.0 / (98.0665 / 2048.0)));
}

TEST(Sensors, HoldTheirValueWhileStuck) {
  SensorConfig config = ideal();
  config.stuck_start_s[1] = 1.0;
  config.stuck_end_s[1] = 2.0;
  Sensors sensors{config, 1};
  const auto at = [&](double time_s, double accel) {
    return sensors.convert({accel, accel, accel}, time_s);
  };
  const auto before = at(0.9, 1.0);
  const auto during = at(1.0, 7.0);
  EXPECT_EQ(during[1], before[1]);
  EXPECT_NE(during[2], before[2]);
  EXPECT_EQ(at(2.0, 7.0)[1], during[2]);
}

TEST(Sensors, HaveTheStatedNoiseBiasAndDrift) {
  SensorConfig noisy = ideal();
  noisy.noise_mps2 = 0.2;
  Sensors sensors{noisy, 2};
  const double lsb = count_scale_mps2(noisy.range_mps2[0]);
  double square = 0.0;
  constexpr int kSamples = 100000;
  for (int i = 0; i < kSamples; ++i) square += std::pow(lsb * sensors.convert({}, 0.0)[0], 2);
  EXPECT_NEAR(std::sqrt(square / kSamples), std::hypot(0.2, lsb / std::sqrt(12.0)), 0.002);

  double bias = 0.0;
  double drift = 0.0;
  constexpr int kSeeds = 300;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    SensorConfig biased = ideal();
    biased.bias_mps2 = 1.0;
    bias += std::pow(lsb * Sensors{biased, seed}.convert({}, 0.0)[0], 2) / kSeeds;
    SensorConfig drifting = ideal();
    drifting.drift_mps2 = 1.0;
    drifting.drift_time_s = 5.0;
    drift += std::pow(lsb * Sensors{drifting, seed}.convert({}, 0.0)[0], 2) / kSeeds;
  }
  EXPECT_NEAR(std::sqrt(bias), 1.0, 0.13);
  EXPECT_NEAR(std::sqrt(drift), 1.0, 0.13);
}

/// rms of the difference between a channel and the same channel of an undisturbed run, shifted.
double misfit(const SimulationConfig& one, const SimulationConfig& other, std::size_t channel,
              std::size_t shift, double gain) {
  Simulation a{one};
  Simulation b{other};
  std::vector<double> x;
  std::vector<double> y;
  for (int i = 0; i < 3000; ++i) {
    x.push_back(a.next().accel_mps2[channel]);
    y.push_back(b.next().accel_mps2[channel]);
  }
  double sum = 0.0;
  double power = 0.0;
  for (std::size_t i = 10; i < 2990; ++i) {
    sum += std::pow(gain * x[i - shift] - y[i], 2);
    power += y[i] * y[i];
  }
  return std::sqrt(sum / power);
}

TEST(Sensors, CanBeOutOfStepOrOfTheWrongSensitivity) {
  SimulationConfig clean = reference_run(Load::kLaden, 80.0, 6);
  clean.sensors = ideal();
  SimulationConfig late = clean;
  late.sensors.time_skew_s[1] = 1.0 / 300.0;
  EXPECT_LT(misfit(clean, late, 1, 1, 1.0), 0.03);
  EXPECT_GT(misfit(clean, late, 1, 0, 1.0), 0.3);
  EXPECT_EQ(misfit(clean, late, 2, 0, 1.0), 0.0);
  SimulationConfig early = clean;
  early.sensors.time_skew_s[0] = -2.0 / 300.0;
  EXPECT_LT(misfit(early, clean, 0, 2, 1.0), 0.2);  // the frame moves by few counts
  EXPECT_LT(misfit(early, clean, 0, 2, 1.0), 0.5 * misfit(early, clean, 0, 0, 1.0));
  SimulationConfig wrong = clean;
  wrong.sensors.gain_error[2] = 0.1;
  EXPECT_LT(misfit(clean, wrong, 2, 0, 1.1), 0.02);
}

TEST(Sensors, SeeTheLateralAccelerationWhenTilted) {
  SimulationConfig clean = reference_run(Load::kLaden, 80.0, 6);
  clean.sensors = ideal();
  clean.sensors.range_mps2[0] = 1.0;
  SimulationConfig tilted = clean;
  tilted.sensors.tilt_rad[0] = 0.3;
  tilted.sensors.lateral_mps2 = 0.6;
  Simulation a{clean};
  Simulation b{tilted};
  double square = 0.0;
  constexpr int kSamples = 60000;
  for (int i = 0; i < kSamples; ++i) {
    const double vertical = std::cos(0.3) * a.next().truth.frame_mps2;
    square += std::pow(b.next().accel_mps2[0] - vertical, 2);
  }
  EXPECT_NEAR(std::sqrt(square / kSamples), 0.6 * std::sin(0.3), 0.02);
}

}  // namespace
}  // namespace dampline::sim
