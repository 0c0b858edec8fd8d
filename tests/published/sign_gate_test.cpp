// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "published/wavelet/motion_rows.hpp"

namespace dampline {
namespace {

using Coulomb = SingleModel<TermList<Viscous, Spring, Friction<>>>;
using LinearCoulomb = SingleModel<TermList<Viscous, Spring, Friction<>, ProgressiveFriction<>>>;

constexpr double kGateStepS = 0.01;
constexpr double kOmega = 2.0;

double wrapped(double angle, double period) { return std::remainder(angle, period); }

/// Distance in time of instant t from the nearest reversal of sin(omega t).
double from_reversal(double t) { return std::abs(wrapped(kOmega * t - M_PI_2, M_PI)) / kOmega; }
double from_centre(double t) { return std::abs(wrapped(kOmega * t, M_PI)) / kOmega; }

TEST(SignGate, LeavesOutEveryStencilThatReachesAcrossAReversal) {
  auto rows =
      MotionRows<D8, Coulomb>::make({.step_s = kGateStepS, .mass_kg = {1.0}}, Coulomb{}).value();
  MotionRow<Coulomb> row;
  int used = 0;
  int possible = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = std::sin(kOmega * i * kGateStepS);
    if (!rows.push({.deflection_m = {x}, .force_n = {0.0}}, row) || row.sample < 300) continue;
    const double clear_s = from_reversal(static_cast<double>(row.sample) * kGateStepS);
    if (row.usable) {
      EXPECT_GT(clear_s, 6 * kGateStepS);
    }
    used += row.usable ? 1 : 0;
    possible += clear_s > 6 * kGateStepS ? 1 : 0;
  }
  EXPECT_GT(used, 0.95 * possible);  // lost: one step and what is slower than 2 % of the rms
}

TEST(SignGate, MindsTheSignOfTheDeflectionWhereATermDoes) {
  auto rows =
      MotionRows<D8, LinearCoulomb>::make({.step_s = kGateStepS, .mass_kg = {1.0}}, LinearCoulomb{})
          .value();
  MotionRow<LinearCoulomb> row;
  int used = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = std::sin(kOmega * i * kGateStepS);
    if (!rows.push({.deflection_m = {x}, .force_n = {0.0}}, row) || row.sample < 300) continue;
    if (!row.usable) continue;
    const double t = static_cast<double>(row.sample) * kGateStepS;
    EXPECT_GT(from_reversal(t), 6 * kGateStepS);
    EXPECT_GT(from_centre(t), 6 * kGateStepS);
    ++used;
  }
  EXPECT_GT(used, 1500);
}

TEST(SignGate, IsClosedInAStickAndOneStepAround) {
  SignGate<1, false> gate{{}, 1.0};
  double x = 0.0;
  for (int i = 0; i < 10; ++i) gate.push({x += 1.0});
  EXPECT_EQ(gate.clear_steps(), 9U);
  gate.push({x += 0.001});  // slower than 2 % of the rms
  EXPECT_EQ(gate.clear_steps(), 0U);
  gate.push({x += 1.0});
  EXPECT_EQ(gate.clear_steps(), 1U);
  gate.push({x -= 1.0});
  EXPECT_EQ(gate.clear_steps(), 1U);
  gate.push({x -= 1.0});
  EXPECT_EQ(gate.clear_steps(), 2U);
}

TEST(SignGate, HasAnAbsoluteLimitToo) {
  SignGate<1, false> gate{{.least_speed_mps = 0.5, .least_of_rms = 0.0}, 2.0};
  gate.push({0.0});
  gate.push({0.8});  // 0.4 m/s
  EXPECT_EQ(gate.clear_steps(), 0U);
  gate.push({2.0});  // 0.6 m/s
  EXPECT_EQ(gate.clear_steps(), 1U);
}

TEST(SignGate, TakesNothingThatIsNotANumber) {
  SignGate<1, false> gate{{}, 1.0};
  gate.push({0.0});
  gate.push({1.0});
  gate.push({2.0});
  gate.push({NAN});
  EXPECT_EQ(gate.clear_steps(), 0U);
}

TEST(SignGate, OfAChainWatchesBothElements) {
  SignGate<2, false> gate{{}, 1.0};
  gate.push({0.0, 0.0});
  gate.push({1.0, 1.0});
  gate.push({2.0, 2.0});
  gate.push({3.0, 1.0});
  EXPECT_EQ(gate.clear_steps(), 1U);
}

}  // namespace
}  // namespace dampline
