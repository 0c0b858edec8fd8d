// SPDX-License-Identifier: MIT
#include "sim_hw/white_input.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace dampline {
namespace {

struct Moments {
  double speed{0.0}, v2{0.0}, y2{0.0}, y{0.0}, beyond{0.0};
};

Moments moments(const sim::WhiteInputConfig& config, double length_s, double limit_mps) {
  sim::WhiteInput source{config};
  Moments out;
  const auto samples = static_cast<int>(length_s * sim::WhiteInput::sample_rate_hz());
  for (int i = 0; i < samples; ++i) {
    const Motion m = source.next();
    out.speed += std::abs(m.velocity_mps) / samples;
    out.v2 += m.velocity_mps * m.velocity_mps / samples;
    out.y2 += m.deflection_m * m.deflection_m / samples;
    out.y += m.deflection_m / samples;
    if (std::abs(m.velocity_mps) > limit_mps) out.beyond += 1.0 / samples;
  }
  return out;
}

// Without a spring, v of Coulomb friction has the density exp(-2 alpha |v| / D) alpha / D.
TEST(WhiteInput, WithoutASpringGivesTheLaplaceDensity) {
  sim::WhiteInputConfig config{
      .stiffness_npm = 0.0, .friction_positive_n = 8356.0, .friction_negative_n = 8356.0};
  const double length_mps =
      config.input_level / (2.0 * 2.0 * config.friction_positive_n / config.moving_mass_kg);
  const Moments m = moments(config, 3'000.0, length_mps);
  EXPECT_NEAR(m.speed / length_mps, 1.0, 0.01);
  EXPECT_NEAR(m.v2 / (2.0 * length_mps * length_mps), 1.0, 0.02);
  EXPECT_NEAR(m.beyond, std::exp(-1.0), 0.005);
}

// Friction of finite steps stops at v = 0, which continuous time does not: a sample there would
// count as v >= 0. None is given so, and those that a step cannot resolve are as many on either
// side.
TEST(WhiteInput, DoesNotLeanAtZero) {
  const sim::WhiteInputConfig config;
  sim::WhiteInput source{config};
  const double reach_mps = 0.5 * (config.friction_positive_n + config.friction_negative_n) /
                           config.moving_mass_kg / sim::WhiteInput::kStepRateHz;
  int near = 0;
  int above = 0;
  for (int i = 0; i < 900'000; ++i) {
    const double v = source.next().velocity_mps;
    ASSERT_NE(v, 0.0);
    near += std::abs(v) < reach_mps ? 1 : 0;
    above += v > 0.0 && v < reach_mps ? 1 : 0;
  }
  EXPECT_GT(near, 3000);
  EXPECT_NEAR(static_cast<double>(above) / near, 0.5, 0.03);
}

// Without friction but with a viscous damper: E v^2 = D / (2 c), beta E y^2 = E v^2.
TEST(WhiteInput, OfALinearOscillatorHasItsVariances) {
  const sim::WhiteInputConfig config{
      .friction_positive_n = 0.0, .friction_negative_n = 0.0, .viscous_nspm = 2.0e5};
  const double damping_ps = 2.0 * config.viscous_nspm / config.moving_mass_kg;
  const double v2 = config.input_level / (2.0 * damping_ps);
  const Moments m = moments(config, 3'000.0, 1.0);
  EXPECT_NEAR(m.v2 / v2, 1.0, 0.03);
  EXPECT_NEAR(m.y2 * 2.0 * config.stiffness_npm / config.moving_mass_kg / v2, 1.0, 0.03);
}

// The power that the input brings is the power that friction takes: E[alpha |v|] = D / 2. And what
// the branches differ in, the spring carries on average.
TEST(WhiteInput, BalancesPowerAndForce) {
  const sim::WhiteInputConfig config{.friction_positive_n = 9150.0, .friction_negative_n = 7562.0};
  const Moments m = moments(config, 3'000.0, 1.0);
  const double alpha_mps2 = (9150.0 + 7562.0) / config.moving_mass_kg;
  EXPECT_NEAR(alpha_mps2 * m.speed / (0.5 * config.input_level), 1.0, 0.012);
  EXPECT_NEAR(m.y * config.stiffness_npm, -0.5 * (9150.0 - 7562.0), 40.0);
}

TEST(WhiteInput, IsTheSameForTheSameSeed) {
  sim::WhiteInput a{{.seed = 3}};
  sim::WhiteInput b{{.seed = 3}};
  sim::WhiteInput c{{.seed = 4}};
  double difference = 0.0;
  for (int i = 0; i < 100; ++i) {
    const Motion m = a.next();
    EXPECT_EQ(m.velocity_mps, b.next().velocity_mps);
    difference += std::abs(m.velocity_mps - c.next().velocity_mps);
  }
  EXPECT_GT(difference, 0.0);
}

TEST(WhiteInput, LevelGivesTheWantedVelocity) {
  sim::WhiteInputConfig config{.stiffness_npm = 0.0,
                               .friction_positive_n = 5000.0,
                               .friction_negative_n = 5000.0,
                               .input_level = sim::input_level_for(6.0e-3, 5000.0, 37200.0)};
  EXPECT_NEAR(std::sqrt(moments(config, 1'000.0, 1.0).v2), 6.0e-3, 0.15e-3);
}

}  // namespace
}  // namespace dampline
