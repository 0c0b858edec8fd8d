// SPDX-License-Identifier: MIT
// A law moved by a force, against closed forms.
#include "app/law/free_run.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/diagnosis/rig/regressor.hpp"

namespace dampline::app::law {
namespace {

constexpr double kOscillatorKg = 2.0;
constexpr double kOscillatorNpm = 800.0;  // 20 rad/s
constexpr double kStepS = 0.005;

template <class Force>
Input input_of(int samples, Force force) {
  Eigen::VectorXd out{samples};
  for (int i = 0; i < samples; ++i) out[i] = force(i * kStepS);
  return {out, kStepS};
}
Input nothing(int samples) {
  return input_of(samples, [](double) { return 0.0; });
}

Eigen::VectorXd path_of(const Law& law, const Input& input, State state) {
  const FreeRun run{law, input};
  Eigen::VectorXd out{input.size()};
  for (Eigen::Index i = 0; i < input.size(); ++i) {
    out[i] = state.deflection_m;
    if (i + 1 < input.size()) run.advance(i, state);
  }
  return out;
}

TEST(Input, IsBandLimitedBetweenItsSamples) {
  for (const double hz : {1.0, 12.0, 40.0, 60.0}) {  // 60 Hz: 0.3 of the rate
    const double w = 2.0 * std::numbers::pi * hz;
    const Input sine = input_of(400, [&](double t) { return std::sin(w * t); });
    double worst = 0.0;
    for (int i = 50; i < 348; ++i)
      for (const double share : {0.0, 0.21, 0.5, 0.9})
        worst = std::max(worst, std::abs(sine.at(i, share) - std::sin(w * kStepS * (i + share))));
    EXPECT_LT(worst, hz > 12.0 ? 1e-5 : 2e-8) << hz;
  }
}

TEST(FreeRun, RingsAsItsClosedForm) {
  constexpr double kViscous = 3.0;
  const Law law{kOscillatorKg,
                {{{Kind::kDeflection}, kOscillatorNpm}, {{Kind::kVelocity}, kViscous}}};
  const Eigen::VectorXd path = path_of(law, nothing(1000), {0.01, 0.0, {}, {}});
  const double decay = kViscous / (2.0 * kOscillatorKg);
  const double w = std::sqrt(kOscillatorNpm / kOscillatorKg - decay * decay);
  for (int i = 0; i < 1000; i += 37) {
    const double t = i * kStepS;
    EXPECT_NEAR(path[i],
                0.01 * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t)),
                1e-8);
  }
}

TEST(FreeRun, LosesTwoLevelsOverTheStiffnessEveryHalfCycleAndSticks) {
  constexpr double kLevelN = 1.1;
  const Law law{kOscillatorKg,
                {{{Kind::kDeflection}, kOscillatorNpm}, {{Kind::kSign, 1e-3}, kLevelN, true}}};
  double rest_m = 0.01;
  while (std::abs(rest_m) * kOscillatorNpm > kLevelN)
    rest_m = std::copysign(2.0 * kLevelN / kOscillatorNpm, rest_m) - rest_m;
  const Eigen::VectorXd path = path_of(law, nothing(1000), {0.01, 0.0, {}, {}});
  EXPECT_NEAR(path[999], rest_m, 2e-9);
  EXPECT_EQ(path[999], path[900]) << "it stands";
}

TEST(FreeRun, BreaksAwayAtTheInstantAtWhichTheFrictionNoLongerHolds) {
  constexpr double kLevelN = 1.0;
  constexpr double kRiseNps = 0.7;
  const Law law{kOscillatorKg, {{{Kind::kSign, 1e-3}, kLevelN, true}}};
  const Input ramp = input_of(600, [](double t) { return kRiseNps * t; });
  const Eigen::VectorXd path = path_of(law, ramp, {});
  const double from_s = kLevelN / kRiseNps;
  for (int i = 0; i < 600; i += 29) {
    const double t = std::max(0.0, i * kStepS - from_s);
    EXPECT_NEAR(path[i], kRiseNps * t * t * t / (6.0 * kOscillatorKg), 1e-9) << i;
  }
}

/// m x'' + F - f along the path, the force's columns as the equations have them.
double worst_balance(const Law& law) {
  const auto force = [](double t) { return 6.0 * std::sin(7.0 * t) + 4.0 * std::sin(11.0 * t); };
  const Input input = input_of(2000, force);
  const Eigen::VectorXd path = path_of(law, input, {});
  rig::Series series;
  series.interval_s = kStepS;
  series.deflection_m = path;
  series.force_n = series.velocity_mps = Eigen::VectorXd::Zero(path.size());
  for (Eigen::Index i = 1; i + 1 < path.size(); ++i)
    series.velocity_mps[i] = (path[i + 1] - path[i - 1]) / (2.0 * kStepS);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(path.size());
  for (const Term& t : law.terms) sum += t.coefficient * rig::evaluate(t.column, series);
  double squares = 0.0;
  for (Eigen::Index i = 1; i + 1 < path.size(); ++i) {
    const double accel = (path[i + 1] - 2.0 * path[i] + path[i - 1]) / (kStepS * kStepS);
    squares += std::pow(law.mass_kg * accel + sum[i] - force(static_cast<double>(i) * kStepS), 2);
  }
  return std::sqrt(squares / static_cast<double>(path.size()));
}

TEST(FreeRun, RelaxesAsASpringBehindADashpot) {
  constexpr double kTimeS = 0.03;
  constexpr double kBehindNpm = 500.0;
  const Law law{kOscillatorKg,
                {{{Kind::kDeflection}, 200.0}, {{Kind::kMaxwell, kTimeS}, kBehindNpm}}};
  // x = sin(w t) asks for this force; the stretch starts where its own steady state does.
  constexpr double kW = 9.0;
  const double size = 1.0 / (1.0 + std::pow(kW * kTimeS, 2));
  const auto stretch = [&](double t) {
    return size * kW * kTimeS * (std::cos(kW * t) + kW * kTimeS * std::sin(kW * t));
  };
  const Input input = input_of(1500, [&](double t) {
    return (200.0 - kOscillatorKg * kW * kW) * std::sin(kW * t) + kBehindNpm * stretch(t);
  });
  State start{0.0, kW, {}, {}};
  start.memory_m[0] = stretch(0.0);
  const Eigen::VectorXd path = path_of(law, input, start);
  for (int i = 0; i < 1500; i += 41) EXPECT_NEAR(path[i], std::sin(kW * i * kStepS), 1e-5) << i;
}

TEST(FreeRun, RemembersAsTheEquationsDo) {
  const Term spring{{Kind::kDeflection}, 200.0};
  EXPECT_LT(worst_balance({kOscillatorKg, {spring, {{Kind::kStop, 5e-3}, 3.0}}}), 0.06);
  EXPECT_LT(worst_balance({kOscillatorKg, {spring, {{Kind::kMaxwell, 0.04}, 900.0}}}), 0.06);
  EXPECT_LT(worst_balance({kOscillatorKg,
                           {spring, {{Kind::kGapUp, 5e-3}, 3.0}, {{Kind::kGapDown, 5e-3}, 3.0}}}),
            0.06);
  EXPECT_LT(
      worst_balance({kOscillatorKg, {spring, {{Kind::kCube}, 2e5}, {{Kind::kSpeedSquared}, 9.0}}}),
      0.06);
}

TEST(FreeRun, HasNoMassOnTheMassAndNothingThatChanges) {
  EXPECT_TRUE(FreeRun::can({kOscillatorKg, {{{Kind::kDeflection}, 1.0}}}));
  EXPECT_FALSE(FreeRun::can({0.0, {{{Kind::kDeflection}, 1.0}}}));
  EXPECT_FALSE(FreeRun::can({kOscillatorKg, {{{Kind::kAttached, 5.0, 0.1}, 1.0}}}));
  Term drifting{{Kind::kDeflection}, 1.0};
  drifting.column.time = Regressor::Time::kSlope;
  EXPECT_FALSE(FreeRun::can({kOscillatorKg, {drifting}}));
}

}  // namespace
}  // namespace dampline::app::law
