// SPDX-License-Identifier: MIT
// Rigs whose force is late or early, or whose law changes: delays between the grid's, changes of
// other shapes than the library's.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "tests/explain/explained_rig.hpp"

namespace dampline::app {
namespace {

constexpr double kTimedRateHz = 400.0;
constexpr double kTimedLengthS = 60.0;

double deflection_at(double t) {
  return 0.007 * std::sin(3.1 * t) + 0.004 * std::sin(8.3 * t + 1.0) +
         0.001 * std::sin(19.0 * t + 2.0);
}
double velocity_at(double t) {
  return 0.0217 * std::cos(3.1 * t) + 0.0332 * std::cos(8.3 * t + 1.0) +
         0.019 * std::cos(19.0 * t + 2.0);
}
double friction_at(double t) { return velocity_at(t) < 0.0 ? -400.0 : 400.0; }

rig::Explanation explained(const std::function<double(double)>& force_at, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise;
  std::string text = "time_s,deflection_m,force_n\n";
  for (int i = 0; i < static_cast<int>(kTimedRateHz * kTimedLengthS); ++i) {
    const double t = i / kTimedRateHz;
    text += fmt::format("{:.6f},{:.9f},{:.4f}\n", t, deflection_at(t) + 2e-7 * noise(random),
                        force_at(t) + 6.0 * noise(random));
  }
  return dampline::test::explained(text);
}

TEST(ForceOutOfStepNightly, IsNamedWithItsDelay) {
  for (const double late_s : {0.0011, -0.0034, 0.0128}) {  // 0.44, 1.36 and 5.1 samples
    const rig::Explanation found = explained(
        [late_s](double t) { return friction_at(t - late_s) + 3000.0 * velocity_at(t - late_s); },
        61);
    ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
    EXPECT_EQ(found.steps[0].effect, "time_skew") << summarize(found);
    ASSERT_EQ(found.steps[0].parameters.size(), 1U);
    const Parameter& skew = found.steps[0].parameters[0];
    EXPECT_NEAR(skew.value, 1e3 * late_s, 0.25) << summarize(found);
    EXPECT_GT(skew.std, 0.0);
    EXPECT_LT(skew.std, 0.25);
  }
}

TEST(ForceOutOfStep, LeavesTheNextEffectToBeFound) {
  const rig::Explanation found = explained(
      [](double t) {
        const double then = t - 0.0071;
        return friction_at(then) + 3000.0 * velocity_at(then) - 130.0;
      },
      62);
  ASSERT_EQ(found.steps.size(), 2U) << summarize(found);
  EXPECT_NE(found.steps[0].effect, found.steps[1].effect);
  for (const app::Step& step : found.steps)
    EXPECT_TRUE(step.effect == "time_skew" || step.effect == "offset_force") << summarize(found);
}

TEST(LawThatChanges, IsNamedWithWhatChangesAndHowMuch) {
  // Friction that warms up: by 30 % in the end, most of it early.
  const rig::Explanation slow = explained(
      [](double t) {
        return friction_at(t) * (1.0 + 0.3 * (1.0 - std::exp(-t / 25.0))) + 3000.0 * velocity_at(t);
      },
      63);
  ASSERT_FALSE(slow.steps.empty()) << summarize(slow);
  EXPECT_EQ(slow.steps[0].effect, "time_drift") << summarize(slow);
  EXPECT_EQ(slow.steps[0].parameters[0].name, "time_drift_coulomb");
  EXPECT_NEAR(slow.steps[0].parameters[0].value, 22.0, 8.0) << summarize(slow);
  // Damping that is lost at once.
  const rig::Explanation step = explained(
      [](double t) { return friction_at(t) + (t < 22.7 ? 9000.0 : 6000.0) * velocity_at(t); }, 64);
  ASSERT_FALSE(step.steps.empty()) << summarize(step);
  EXPECT_EQ(step.steps[0].effect, "time_drift") << summarize(step);
  ASSERT_EQ(step.steps[0].parameters.size(), 2U) << summarize(step);
  EXPECT_EQ(step.steps[0].parameters[0].name, "time_drift_viscous");
  EXPECT_NEAR(step.steps[0].parameters[0].value, -33.0, 5.0) << summarize(step);
  EXPECT_NEAR(step.steps[0].parameters[1].value, 22.7, 3.5) << summarize(step);
}

TEST(Impacts, AreCountedAndLeaveTheRestToBeFound) {
  // Twenty bursts that ring down within 15 ms, at moments of no regularity; and a constant.
  const auto burst = [](double t) {
    double sum = 0.0;
    for (int i = 0; i < 20; ++i) {
      const double since = t - (1.37 + 2.9 * i + 0.8 * std::sin(7.0 * i));
      if (since > 0.0)
        sum += (i % 2 == 0 ? 3500.0 : -2600.0) * std::exp(-since / 0.004) * std::cos(500.0 * since);
    }
    return sum;
  };
  const rig::Explanation found = explained(
      [&](double t) { return friction_at(t) + 3000.0 * velocity_at(t) + burst(t) - 150.0; }, 65);
  ASSERT_EQ(found.steps.size(), 2U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "impulsive_input");
  EXPECT_EQ(found.steps[1].effect, "offset_force") << summarize(found);
  EXPECT_NEAR(found.steps[0].parameters[0].value, 20.0, 4.0);
  EXPECT_NEAR(found.steps[1].parameters[0].value, -150.0, 5.0);
}

}  // namespace
}  // namespace dampline::app
