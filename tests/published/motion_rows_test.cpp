// SPDX-License-Identifier: MIT
#include "published/wavelet/motion_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/published/prescribed_motion.hpp"

namespace dampline {
namespace {

constexpr double kStepS = 0.05;

using Duffing = SingleModel<TermList<Viscous, Spring, CubicSpring>>;
using Element = TermList<Viscous, Spring, CubicSpring>;
using Chain = ChainModel<Element, Element>;

TEST(MotionRows, GiveDampingStiffnessAndCubicStiffness) {
  auto rows =
      MotionRows<D16, Duffing>::make({.step_s = kStepS, .mass_kg = {2.0}}, Duffing{}).value();
  const PrescribedMotion motion = two_tones();
  Information<4> information;
  MotionRow<Duffing> row;
  int rows_seen = 0;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * kStepS;
    const double x = motion.x(t);
    const double f = 2.0 * motion.a(t) + 0.04 * motion.v(t) + 1.0 * x + 0.3 * x * x * x;
    if (!rows.push({.deflection_m = {x}, .force_n = {f}}, row)) continue;
    EXPECT_TRUE(row.usable);
    EXPECT_EQ(row.sample, i - 14);
    ++rows_seen;
    information.absorb(row.equation(0));
  }
  EXPECT_EQ(rows_seen, 2000 - 2 * 14);
  Information<4>::Vector theta;
  ASSERT_TRUE(information.solve(theta));
  EXPECT_NEAR(theta[0], 0.04, 1e-12);
  EXPECT_NEAR(theta[1], 1.0, 1e-12);
  EXPECT_NEAR(theta[2], 0.3, 1e-12);
}

TEST(MotionRows, KnowMotionAtTheRowsInstant) {
  auto rows =
      MotionRows<D16, Duffing>::make({.step_s = kStepS, .mass_kg = {2.0}}, Duffing{}).value();
  const PrescribedMotion motion = two_tones();
  MotionRow<Duffing> row;
  for (int i = 0; i < 100; ++i) {
    const double t = i * kStepS;
    if (!rows.push({.deflection_m = {motion.x(t)}, .force_n = {t}}, row)) continue;
    const double then = static_cast<double>(row.sample) * kStepS;
    EXPECT_EQ(row.deflection_m[0], motion.x(then));
    EXPECT_NEAR(row.velocity_mps[0], motion.v(then), 1e-13);
    EXPECT_NEAR(row.accel_mps2[0], motion.a(then), 2e-12);
    EXPECT_NEAR(row.target_n[0], then - 2.0 * motion.a(then), 4e-12);
  }
}

TEST(MotionRows, OfAChainShareTheUnknownsOfItsElements) {
  const double c1 = 21.0, c2 = 60.0, k1 = 7241.0, k2 = 14900.0, d1 = 72.14, d2 = -223.0;
  auto rows =
      MotionRows<D16, Chain>::make({.step_s = kStepS, .mass_kg = {12.0, 9.0}}, Chain{}).value();
  const PrescribedMotion one = two_tones();
  const PrescribedMotion two = other_tones();
  Information<7> information;
  MotionRow<Chain> row;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * kStepS;
    const double x = one.x(t), v = one.v(t), y = two.x(t) - x, w = two.v(t) - v;
    const double g1 = c1 * v + k1 * x + d1 * x * x * x;
    const double g2 = c2 * w + k2 * y + d2 * y * y * y;
    const MotionSample<2> sample{.deflection_m = {x, two.x(t)},
                                 .force_n = {12.0 * one.a(t) + g1 - g2, 9.0 * two.a(t) + g2}};
    if (!rows.push(sample, row)) continue;
    information.absorb(row.equation(0));
    information.absorb(row.equation(1));
  }
  Information<7>::Vector theta;
  ASSERT_TRUE(information.solve(theta));
  const std::array truth{c1, k1, d1, c2, k2, d2};
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(theta[i] / truth[static_cast<std::size_t>(i)], 1.0, 1e-10) << i;
  }
}

TEST(MotionRows, OfTwoMassesOnTheGroundHaveSevenUnknowns) {
  // Smooth signs, so that one closed form is enough.
  using Grounded = GroundedFrictionModel<TanhSign>;
  const Grounded model{TanhSign{.sharpness_spm = 3.0}};
  const double c11 = 10.0, k11 = 20.0, k12 = -10.0, c22 = 11.0, k22 = 21.0, e1 = 1.0, e2 = 1.5;
  auto rows =
      MotionRows<D16, Grounded>::make({.step_s = kStepS, .mass_kg = {1.0, 1.0}}, model).value();
  const PrescribedMotion one = two_tones();
  const PrescribedMotion two = other_tones();
  Information<8> information;
  MotionRow<Grounded> row;
  for (int i = 0; i < 2000; ++i) {
    const double t = i * kStepS;
    const double f1 = one.a(t) + c11 * one.v(t) + k11 * one.x(t) + k12 * two.x(t) +
                      e1 * std::tanh(3.0 * one.v(t));
    const double f2 = two.a(t) + c22 * two.v(t) + k12 * one.x(t) + k22 * two.x(t) +
                      e2 * std::tanh(3.0 * two.v(t));
    if (!rows.push({.deflection_m = {one.x(t), two.x(t)}, .force_n = {f1, f2}}, row)) continue;
    information.absorb(row.equation(0));
    information.absorb(row.equation(1));
  }
  Information<8>::Vector theta;
  ASSERT_TRUE(information.solve(theta));
  const std::array truth{c11, k11, k12, c22, k22, e1, e2};
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(theta[i] / truth[static_cast<std::size_t>(i)], 1.0, 1e-10) << i;
  }
}

TEST(MotionRows, BeginAnewAfterARestart) {
  auto rows =
      MotionRows<D8, Duffing>::make({.step_s = kStepS, .mass_kg = {1.0}}, Duffing{}).value();
  MotionRow<Duffing> row;
  const MotionSample<1> sample{};
  for (int i = 0; i < 12; ++i) EXPECT_FALSE(rows.push(sample, row)) << i;
  EXPECT_TRUE(rows.push(sample, row));
  rows.restart();
  for (int i = 0; i < 12; ++i) EXPECT_FALSE(rows.push(sample, row)) << i;
  EXPECT_TRUE(rows.push(sample, row));
}

TEST(MotionRows, RefuseWhatIsNoStepAndNoMass) {
  using Rows = MotionRows<D8, Duffing>;
  EXPECT_EQ(Rows::make({.step_s = 0.0, .mass_kg = {1.0}}, Duffing{}).error(), Errc::kInvalidConfig);
  EXPECT_FALSE(Rows::make({.step_s = NAN, .mass_kg = {1.0}}, Duffing{}).ok());
  EXPECT_FALSE(Rows::make({.step_s = 0.1, .mass_kg = {-1.0}}, Duffing{}).ok());
  EXPECT_FALSE(
      Rows::make({.step_s = 0.1, .mass_kg = {1.0}, .gate = {.least_of_rms = NAN}}, Duffing{}).ok());
}

}  // namespace
}  // namespace dampline
