// SPDX-License-Identifier: MIT
#include "published/wavelet/coarse_rows.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/published/prescribed_motion.hpp"

namespace dampline {
namespace {

constexpr double kCoarseStepS = 0.05;
using Duffing = SingleModel<TermList<Viscous, Spring, CubicSpring>>;

double force(const PrescribedMotion& motion, double t) {
  const double x = motion.x(t);
  return motion.a(t) + 0.04 * motion.v(t) + x + 0.3 * x * x * x;
}

/// A value rounded to the codes of a 12-bit converter of +-4 (deflection) or +-10 (force).
double rounded(double value, double full_scale) {
  const double code = full_scale / 2048.0;
  return code * std::round(value / code);
}

template <class Rows>
Information<4>::Vector estimate(Rows rows, bool twelve_bit) {
  const PrescribedMotion motion = two_tones();
  Information<4> information;
  MotionRow<Duffing> row;
  for (int i = 0; i < 6000; ++i) {
    const double t = i * kCoarseStepS;
    double x = motion.x(t);
    double f = force(motion, t);
    if (twelve_bit) {
      x = rounded(x, 4.0);
      f = rounded(f, 10.0);
    }
    if (rows.push({.deflection_m = {x}, .force_n = {f}}, row)) {
      information.absorb(row.equation(0));
    }
  }
  Information<4>::Vector theta = Information<4>::Vector::Zero();
  EXPECT_TRUE(information.solve(theta));
  return theta;
}

template <class Rows>
Rows make() {
  return Rows::make({.step_s = kCoarseStepS, .mass_kg = {1.0}}, Duffing{}).value();
}

TEST(CoarseRows, OfExactSignalsGiveExactParameters) {
  const auto one = estimate(make<CoarseRows<D16, Duffing, 1>>(), false);
  EXPECT_NEAR(one[0], 0.04, 1e-12);
  EXPECT_NEAR(one[1], 1.0, 1e-12);
  EXPECT_NEAR(one[2], 0.3, 1e-12);
  const auto three = estimate(make<CoarseRows<D16, Duffing, 3>>(), false);
  EXPECT_NEAR(three[0], 0.04, 2e-7);  // a step of 0.4 s, at 1.7 rad/s
  EXPECT_NEAR(three[1], 1.0, 2e-7);
  EXPECT_NEAR(three[2], 0.3, 2e-7);
}

TEST(CoarseRows, SeeTwelveBitDataThroughTheirRounding) {
  const auto fine = estimate(make<MotionRows<D12, Duffing>>(), true);
  const auto coarse = estimate(make<CoarseRows<D12, Duffing, 2>>(), true);
  const Information<4>::Vector truth{0.04, 1.0, 0.3};
  const auto error = [&](const Information<4>::Vector& theta) {
    return (theta - truth).cwiseQuotient(truth).norm();
  };
  EXPECT_LT(error(coarse), 2e-3);
  EXPECT_GT(error(fine), 5.0 * error(coarse));
}

TEST(CoarseRows, ComeEveryStrideAndNameTheirFirstSample) {
  using Rows = CoarseRows<D8, Duffing, 2>;
  Rows rows = make<Rows>();
  MotionRow<Duffing> row;
  std::int64_t last = -1;
  int count = 0;
  for (int i = 0; i < 400; ++i) {
    // A ramp: the filtered deflection shows where the row's centre of gravity lies.
    if (!rows.push({.deflection_m = {static_cast<double>(i)}, .force_n = {0.0}}, row)) continue;
    if (last >= 0) {
      EXPECT_EQ(row.sample, last + 4);
    }
    last = row.sample;
    ++count;
    EXPECT_NEAR(row.deflection_m[0] - static_cast<double>(row.sample), 3 * 1.005393, 1e-5);
    EXPECT_NEAR(row.velocity_mps[0], 1.0 / kCoarseStepS, 1e-11);
  }
  EXPECT_GT(count, 70);
}

TEST(CoarseRows, CloseTheGateForEverythingThatARowSaw) {
  using Coulomb = SingleModel<TermList<Viscous, Spring, Friction<>>>;
  using Rows = CoarseRows<D6, Coulomb, 1>;
  Rows rows = Rows::make({.step_s = kCoarseStepS, .mass_kg = {1.0}}, Coulomb{}).value();
  MotionRow<Coulomb> row;
  const double omega = 0.9;
  int used = 0;
  for (int i = 0; i < 4000; ++i) {
    const double x = std::sin(omega * i * kCoarseStepS);
    if (!rows.push({.deflection_m = {x}, .force_n = {0.0}}, row) || !row.usable) continue;
    // From the first fine sample of the leftmost coarse one to the last of the rightmost.
    const double first =
        (static_cast<double>(row.sample) - 2 * D6::kReach - D6::kReach) * kCoarseStepS;
    const double last =
        (static_cast<double>(row.sample) + 2 * D6::kReach + 5 + D6::kReach) * kCoarseStepS;
    EXPECT_EQ(std::floor(omega * first / M_PI + 0.5), std::floor(omega * last / M_PI + 0.5));
    ++used;
  }
  EXPECT_GT(used, 500);
}

}  // namespace
}  // namespace dampline
