// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "app/verify/reference/chain.hpp"

namespace dampline::sim::reference {
namespace {

constexpr Real kPi = std::numbers::pi_v<Real>;

Chain one_mass(const Element& element, const Input& input = {}) {
  Chain chain{.mass_kg = {1}, .links = {{Link::kGround, 0, element}}};
  if (!input.empty()) chain.inputs = {input};
  return chain;
}

TEST(CoulombFriction, TakesTwiceItsForceOverTheStiffnessEachHalfCycle) {
  // x = 1 - 0.04 n after n half cycles, each pi / w long; at rest where k |x| <= e.
  const auto half_s = static_cast<double>(kPi / std::sqrt(10.0L));
  const Trajectory found = simulate(one_mass({.k = 10, .e = 0.2L}), {{1}, {0}},
                                    {.step_s = half_s, .samples = 40, .substeps = 128});
  for (std::size_t n = 0; n <= 25; ++n) {
    const double size = 1.0 - 0.04 * static_cast<double>(n);
    ASSERT_NEAR(found.deflection_m[0][n], n % 2 == 0 ? size : -size, 1e-15) << n;
  }
  for (std::size_t n = 26; n < 40; ++n) {
    EXPECT_EQ(found.deflection_m[0][n], found.deflection_m[0][26]) << n;
    EXPECT_EQ(found.velocity_mps[0][n], 0.0) << n;
    EXPECT_LE(10.0 * std::abs(found.deflection_m[0][n]), 0.2) << n;
  }
}

TEST(CoulombFriction, HoldsUntilTheForceExceedsItAndThenLetsGo) {
  // x'' + 0.5 x' + 25 x + 0.2 sign x' = sin(0.5 t): at rest until sin(0.5 t) = 0.2.
  const Chain chain = one_mass({.k = 25, .c = 0.5L, .e = 0.2L}, {{1, 0.5L, 0}});
  const Trajectory found = simulate(chain, {}, {.step_s = 0.001, .samples = 3000, .substeps = 2});
  const Real release_s = 2 * std::asin(0.2L);
  const Real own = std::sqrt(25 - 0.0625L);
  const Real scale = 1 / (24.75L * 24.75L + 0.0625L);
  const Real in_phase = 24.75L * scale;
  const Real across = -0.25L * scale;
  const auto steady = [&](Real t) {
    return in_phase * std::sin(0.5L * t) + across * std::cos(0.5L * t) - 0.2L / 25;
  };
  const auto steady_rate = [&](Real t) {
    return 0.5L * (in_phase * std::cos(0.5L * t) - across * std::sin(0.5L * t));
  };
  const Real a = -steady(release_s);
  const Real b = (0.25L * a - steady_rate(release_s)) / own;
  bool slipped = false;
  for (std::size_t n = 0; n < 3000; ++n) {
    const Real t = static_cast<Real>(n) * static_cast<Real>(0.001);
    const Real after = t - release_s;
    if (after < 0) {
      ASSERT_EQ(found.deflection_m[0][n], 0.0);
      continue;
    }
    const Real x = steady(t) + std::exp(-0.25L * after) *
                                   (a * std::cos(own * after) + b * std::sin(own * after));
    if (found.velocity_mps[0][n] <= 0.0) break;  // the first stop
    slipped = true;
    ASSERT_NEAR(found.deflection_m[0][n], static_cast<double>(x), 1e-16) << t;
  }
  EXPECT_TRUE(slipped);
}

TEST(CoulombFriction, NeverExceedsItsForceWhereItHolds) {
  const Chain chain = one_mass({.k = 25, .c = 0.5L, .e = 0.2L}, {{1, 0.5L, 0}});
  const Trajectory found = simulate(chain, {}, {.step_s = 0.01, .samples = 6000, .substeps = 4});
  std::size_t at_rest = 0;
  std::size_t stops = 0;
  for (std::size_t n = 0; n < 6000; ++n) {
    const double v = found.velocity_mps[0][n];
    const double held = found.force_n[0][n] - 25 * found.deflection_m[0][n];
    if (v == 0.0) {
      ++at_rest;
      if (n > 0 && found.velocity_mps[0][n - 1] != 0.0) ++stops;
      ASSERT_LE(std::abs(held), 0.2 * (1 + 1e-12)) << n;
      ASSERT_EQ(found.accel_mps2[0][n], 0.0);
    } else {
      const double friction = held - 0.5 * v - found.accel_mps2[0][n];
      ASSERT_NEAR(friction, v > 0 ? 0.2 : -0.2, 1e-14) << n;
    }
  }
  EXPECT_GT(at_rest, 1000U);
  EXPECT_NEAR(static_cast<double>(stops), 2 * 60 / (4 * std::numbers::pi), 2.0);  // two a cycle
}

TEST(CoulombFriction, TakesTheSameFromEachModeOfTwoMasses) {
  // Against each other from +-1: stiffness k + 2 kc.
  const Element outer{.k = 4, .e = 0.3L};
  const Chain chain{
      .mass_kg = {1, 1},
      .links = {{Link::kGround, 0, outer}, {0, 1, {.k = 6}}, {Link::kGround, 1, outer}}};
  const auto half_s = static_cast<double>(kPi / 4);
  const Trajectory found =
      simulate(chain, {{1, -1}, {}}, {.step_s = half_s, .samples = 12, .substeps = 64});
  for (std::size_t n = 0; n < 12; ++n) {
    const double size = (1.0 - 2 * 0.3 / 16 * static_cast<double>(n)) * (n % 2 == 0 ? 1 : -1);
    ASSERT_NEAR(found.deflection_m[0][n], size, 1e-15) << n;
    ASSERT_NEAR(found.deflection_m[1][n], -size, 1e-15) << n;
  }
}

TEST(ProgressiveFriction, StiffensOnTheWayOutAndSoftensOnTheWayBack) {
  // |x| sign v is x on the way out and -x on the way back: k + fk, k - fk.
  constexpr Real kStiffness = 25;
  constexpr Real kSlope = 10;
  const Real in = std::sqrt(kStiffness - kSlope);
  const Real out = std::sqrt(kStiffness + kSlope);
  const auto half_s = static_cast<double>(kPi / 2 / in + kPi / 2 / out);
  const Trajectory found = simulate(one_mass({.k = kStiffness, .fk = kSlope}), {{1}, {0}},
                                    {.step_s = half_s, .samples = 8, .substeps = 64});
  for (std::size_t n = 0; n < 8; ++n) {
    const auto size = static_cast<double>(std::pow(-in / out, static_cast<Real>(n)));
    ASSERT_NEAR(found.deflection_m[0][n], size, 1e-15) << n;
  }
}

/// Largest difference of the deflections of two runs that differ in their substeps only.
double change_by_refining(const Chain& chain, const Start& start, Resolution resolution) {
  const Trajectory coarse = simulate(chain, start, resolution);
  resolution.substeps *= 2;
  resolution.slow_substeps *= 2;
  const Trajectory fine = simulate(chain, start, resolution);
  double worst = 0.0;
  for (std::size_t n = 0; n < coarse.deflection_m[0].size(); ++n) {
    worst = std::max(worst, std::abs(coarse.deflection_m[0][n] - fine.deflection_m[0][n]));
  }
  return worst;
}

TEST(SmoothFriction, IsResolvedInEveryRepresentationOfTheSign) {
  for (const Signum signum :
       {Signum::kTanh, Signum::kErf, Signum::kArctangent, Signum::kRational}) {
    const Chain chain = one_mass(
        {.k = 25, .c = 0.5L, .e = 0.2L, .signum = signum, .sharpness_spm = 100}, {{1, 0.5L, 0}});
    EXPECT_LT(change_by_refining(chain, {},
                                 {.step_s = 0.01,
                                  .samples = 700,
                                  .substeps = 16,
                                  .slow_substeps = 32,
                                  .slow_mps = 0.3L}),
              1e-17)
        << static_cast<int>(signum);
  }
}

TEST(SmoothFriction, TurnsIntoTheExactOne) {
  const auto run = [](Signum signum) {
    return simulate(one_mass({.k = 10, .e = 0.2L, .signum = signum, .sharpness_spm = 1e6L}),
                    {{1}, {0}}, {.step_s = 0.01, .samples = 90, .substeps = 16});
  };
  const double exact = run(Signum::kExact).deflection_m[0][80];
  EXPECT_NEAR(run(Signum::kTanh).deflection_m[0][80], exact, 1e-5);
  EXPECT_NEAR(run(Signum::kRational).deflection_m[0][80], exact, 1e-5);
}

TEST(ExponentialFriction, IsTheSumOfItsParts) {
  const Element element{.e = 1.17L, .t = -0.909L, .a_spm = 23.6L};
  EXPECT_NEAR(double(friction_force(element, {-1, 1}, 0, -0.05L)),
              -(1.17 - 0.909 * std::exp(-23.6 * 0.05)), 1e-15);
}

TEST(Reference, RefusesWhatItCannotCompute) {
  const Resolution resolution{.step_s = 0.01, .samples = 2};
  EXPECT_THROW(static_cast<void>(simulate({.mass_kg = {1, 1}, .links = {{0, 1, {.k = 1, .e = 1}}}},
                                          {}, resolution)),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(simulate({.mass_kg = {}}, {}, resolution)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(simulate({.mass_kg = {1}, .links = {{0, 1, {}}}}, {}, resolution)),
               std::invalid_argument);
  EXPECT_THROW(static_cast<void>(simulate(one_mass({.k = 1}), {}, {.step_s = 0, .samples = 2})),
               std::invalid_argument);
}

}  // namespace
}  // namespace dampline::sim::reference
