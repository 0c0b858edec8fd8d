// SPDX-License-Identifier: MIT
// Parameters from two 12-bit accelerometers at 300 Hz, 50 s, 3 Hz, about 0.25 g rms, a few seeds.
// The benchmark program `oscillators` runs many, at 2 and 6 Hz, too.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "tests/published/run.hpp"

namespace dampline {
namespace {

constexpr std::array<std::uint64_t, 3> kSeeds{11, 12, 13};

struct Expected {
  double truth;
  double rms_error;  ///< relative
};

template <class Terms, std::size_t N>
void expect_accurate(const sim::OscillatorConfig& oscillator, double base_rms_mps2,
                     const std::array<Expected, N>& expected) {
  std::array<double, N> square{};
  for (const std::uint64_t seed : kSeeds) {
    const auto run = simulate(oscillator, base_rms_mps2, seed);
    ASSERT_GT(run.mass_rms_mps2, 2.0);
    ASSERT_LT(run.mass_rms_mps2, 3.2);
    const auto estimate = identify<Terms>(run)->estimate();
    ASSERT_TRUE(estimate.ok());
    EXPECT_EQ(estimate.value().blocks, 11);
    for (std::size_t i = 0; i < N; ++i) {
      const double error = estimate.value().value[i] - expected[i].truth;
      square[i] += error * error / static_cast<double>(kSeeds.size());
      EXPECT_LT(std::abs(error), 5.0 * estimate.value().std[i]) << seed << ' ' << i;
      // A deviation that covers everything says nothing.
      EXPECT_LT(estimate.value().std[i], expected[i].rms_error * std::abs(expected[i].truth));
    }
  }
  for (std::size_t i = 0; i < N; ++i) {
    EXPECT_LT(std::sqrt(square[i]), expected[i].rms_error * std::abs(expected[i].truth)) << i;
  }
}

TEST(AccelerationOnly, FindsALinearOscillator) {
  expect_accurate<LinearTerms>(kLinearOscillator, 2.85,
                               std::array<Expected, 2>{{{3.770, 0.002}, {355.3, 0.001}}});
}

TEST(AccelerationOnly, FindsADuffingOscillator) {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.cubic_stiffness_pm2s2 = kCubic;
  expect_accurate<DuffingTerms>(
      oscillator, 2.65, std::array<Expected, 3>{{{3.770, 0.002}, {355.3, 0.001}, {kCubic, 0.003}}});
}

TEST(AccelerationOnly, FindsAVanDerPolOscillator) {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.viscous_ps = -1.885;
  oscillator.quadratic_viscous_pm2s = kQuadraticViscous;
  expect_accurate<VanDerPolTerms>(
      oscillator, 2.0,
      std::array<Expected, 3>{{{-1.885, 0.01}, {355.3, 0.001}, {kQuadraticViscous, 0.003}}});
}

TEST(AccelerationOnly, FindsCoulombFriction) {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.coulomb_mps2 = 0.5;
  expect_accurate<CoulombTerms>(
      oscillator, 3.7, std::array<Expected, 3>{{{3.770, 0.01}, {355.3, 0.001}, {0.5, 0.003}}});
}

TEST(AccelerationOnly, FindsFrictionThatGrowsWithDeflection) {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.coulomb_mps2 = 0.3;
  oscillator.coulomb_slope_ps2 = 53.3;
  expect_accurate<LinearCoulombTerms>(
      oscillator, 3.8,
      std::array<Expected, 4>{{{3.770, 0.01}, {355.3, 0.001}, {0.3, 0.01}, {53.3, 0.005}}});
}

/// Six terms fitted to a system that has three of them.
TEST(AccelerationOnly, TellsTermsThatAreThereFromThoseThatAreNot) {
  sim::OscillatorConfig oscillator = kLinearOscillator;
  oscillator.coulomb_mps2 = 0.5;
  for (const std::uint64_t seed : kSeeds) {
    const auto estimate = identify<AllTerms>(simulate(oscillator, 3.7, seed))->estimate();
    ASSERT_TRUE(estimate.ok());
    for (const std::size_t there : {0U, 1U, 4U}) {
      EXPECT_GT(std::abs(estimate.value().t_ratio(there)), 10.0) << there;
    }
    for (const std::size_t spurious : {2U, 3U, 5U}) {
      EXPECT_LT(std::abs(estimate.value().t_ratio(spurious)), 4.0) << spurious;
    }
  }
}

}  // namespace
}  // namespace dampline
