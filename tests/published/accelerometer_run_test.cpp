// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/verify/oscillator/simulated.hpp"

namespace dampline::sim {
namespace {

AccelerometerRunConfig linear_run() {
  AccelerometerRunConfig config;
  config.oscillator = {.viscous_ps = 3.77, .stiffness_ps2 = 355.3};
  config.duration_s = 20.0;
  return config;
}

double rms(const std::vector<double>& x) {
  return std::sqrt(std::inner_product(x.begin(), x.end(), x.begin(), 0.0) /
                   static_cast<double>(x.size()));
}

TEST(AccelerometerRun, WithoutSensorErrorsObeysTheEquationOfMotion) {
  AccelerometerRunConfig config = linear_run();
  config.bits = 0;
  config.anti_alias_hz = 0.0;
  config.mass_bias_mps2 = config.base_bias_mps2 = 0.0;
  const auto run = run_accelerometers(config);
  ASSERT_EQ(run.mass_mps2.size(), 6000U);
  for (std::size_t i = 0; i < run.mass_mps2.size(); ++i) {
    ASSERT_NEAR(run.mass_mps2[i], -3.77 * run.velocity_mps[i] - 355.3 * run.deflection_m[i], 1e-12);
  }
}

TEST(AccelerometerRun, ShakesTheBaseAsHardAsAsked) {
  AccelerometerRunConfig config = linear_run();
  config.duration_s = 200.0;
  config.bits = 0;
  config.anti_alias_hz = 0.0;
  config.base_bias_mps2 = 0.0;
  EXPECT_NEAR(rms(run_accelerometers(config).base_mps2), config.base_rms_mps2, 0.04);
}

TEST(AccelerometerRun, GivesWholeCodesWithinTheRange) {
  AccelerometerRunConfig config = linear_run();
  config.base_rms_mps2 = 8.0;  // clips
  const auto run = run_accelerometers(config);
  const double lsb = 4.0 * 9.80665 / 4096.0;
  for (const double x : run.base_mps2) {
    ASSERT_NEAR(x / lsb, std::round(x / lsb), 1e-9);
  }
  EXPECT_NEAR(*std::max_element(run.base_mps2.begin(), run.base_mps2.end()), 2047.0 * lsb, 1e-9);
  EXPECT_NEAR(*std::min_element(run.base_mps2.begin(), run.base_mps2.end()), -2048.0 * lsb, 1e-9);
}

TEST(AccelerometerRun, CarriesTheBiasAndTheNoiseOfTheSensors) {
  AccelerometerRunConfig config = linear_run();
  config.base_rms_mps2 = 1e-6;
  const auto run = run_accelerometers(config);
  const double lsb = 4.0 * 9.80665 / 4096.0;
  const double mean = std::accumulate(run.mass_mps2.begin(), run.mass_mps2.end(), 0.0) /
                      static_cast<double>(run.mass_mps2.size());
  EXPECT_NEAR(mean, config.mass_bias_mps2, 0.02 * lsb);
  double square = 0.0;
  for (const double x : run.mass_mps2) square += (x - mean) * (x - mean) / 6000.0;
  // half a code of noise, and rounding
  EXPECT_NEAR(std::sqrt(square) / lsb, std::sqrt(0.25 + 1.0 / 12.0), 0.02);
}

TEST(AccelerometerRun, FindsTheBaseThatGivesTheMassItsLevel) {
  AccelerometerRunConfig config = linear_run();
  config.base_rms_mps2 = base_rms_for(config, 2.0);
  EXPECT_NEAR(run_accelerometers(config).mass_rms_mps2, 2.0, 1e-6);
}

}  // namespace
}  // namespace dampline::sim
