// SPDX-License-Identifier: MIT
#include "app/identify/truck_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "app/error.hpp"
#include "app/identify/collected.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

constexpr double kLadenLevel_n = 8356.0;

/// Seconds of a laden truck whose samples `change` may alter; false drops the sample.
template <class Change>
RunResult identify(double seconds, const Config& config, double rate_hz, Change change) {
  sim::Simulation simulation{sim::SimulationConfig{}};
  TruckRun<kIdentifyParts> run{config};
  RateMeter meter{config.input.sample_rate_hz};
  for (int i = 0; i < static_cast<int>(300.0 * seconds); ++i) {
    Sample sample = sim::to_sample(simulation.next());
    sample.time_ns =
        static_cast<std::int64_t>(std::llround(1e9 * static_cast<double>(i) / rate_hz));
    if (!change(sample)) continue;
    meter.update(sample.tick, sample.time_ns);
    run.take(sample);
  }
  return run.finish(meter.measured(), "test");
}

RunResult identify(double seconds) {
  return identify(seconds, {}, 300.0, [](Sample&) { return true; });
}

double value(const RunResult& result, const std::string& name) {
  for (const Parameter& p : result.parameters)
    if (p.name == name) return p.value;
  return std::nan("");
}

TEST(TruckRun, FindsTheLevelOfASimulatedTruck) {
  const RunResult result = identify(60.0);
  EXPECT_NEAR(value(result, "coulomb"), kLadenLevel_n, 0.03 * kLadenLevel_n);
  EXPECT_NEAR(value(result, "stiffness"), 5.26e6, 0.05 * 5.26e6);
  EXPECT_EQ(result.curve.size(), 18U);
  EXPECT_LT(result.curve.front().velocity_mps, 0.0);
  EXPECT_LT(result.curve.front().force_n, 0.0);
  EXPECT_EQ(result.motion.size(), 6000U);
  EXPECT_GE(result.convergence.rows.size(), 8U);
  EXPECT_TRUE(result.excluded.empty());
}

// Scatter alone said 0.1 % of a level 0.3 % low, and 0.3 to 1 % of nodes 3 to 17 % off.
TEST(TruckRun, TheKnownInputsDeviationsHoldWhatErrorsOfTheVelocityMake) {
  Config config;
  config.estimate.methods = "all";
  const RunResult result = identify(300.0, config, 300.0, [](Sample&) { return true; });
  ASSERT_FALSE(result.methods.empty());
  const MethodSummary& known = result.methods.back();
  EXPECT_EQ(known.name, "known_input");
  EXPECT_TRUE(known.trusted);
  EXPECT_NEAR(known.level_n.value, kLadenLevel_n, 2.0 * known.level_n.std);
  EXPECT_LT(known.level_n.std, 0.01 * kLadenLevel_n);
  for (const Estimate& node : known.curve_n)
    EXPECT_NEAR(std::abs(node.value), kLadenLevel_n, 2.5 * node.std);
}

TEST(TruckRun, ListsWhatAGapCosts) {
  const RunResult result =
      identify(60.0, {}, 300.0, [](Sample& s) { return s.tick < 9000 || s.tick > 9030; });
  ASSERT_FALSE(result.excluded.empty());
  EXPECT_EQ(result.excluded[0].reason, "samples missing");
  EXPECT_LE(result.excluded[0].start_s, 30.0);
  EXPECT_GE(result.excluded[0].end_s, 30.1);
  EXPECT_NEAR(value(result, "coulomb"), kLadenLevel_n, 0.05 * kLadenLevel_n);
}

TEST(TruckRun, GivesNoResultWhereEverythingIsClipped) {
  try {
    static_cast<void>(identify(30.0, {}, 300.0, [](Sample& s) {
      s.saturated = 1;
      return true;
    }));
    ADD_FAILURE() << "a clipped record gave a result";
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("nothing could be identified"));
    EXPECT_THAT(error.what(), HasSubstr("full scale"));
  }
}

TEST(TruckRun, GivesNoResultFromNotANumber) {
  EXPECT_THROW(static_cast<void>(identify(30.0, {}, 300.0,
                                          [](Sample& s) {
                                            s.accel_mps2[1] =
                                                std::numeric_limits<double>::quiet_NaN();
                                            return true;
                                          })),
               RunError);
}

TEST(TruckRun, GivesNoResultFromASecond) {
  EXPECT_THROW(static_cast<void>(identify(1.0)), RunError);
}

/// The same samples on a clock that is 0.5 % fast: v and y scale with h and h^2, so the stiffness
/// that explains them scales with 1/h^2 and the friction level does not change.
TEST(TruckRun, CorrectsForTheMeasuredRate) {
  const RunResult nominal = identify(60.0);
  const RunResult fast = identify(60.0, {}, 301.5, [](Sample&) { return true; });
  const double ratio = 301.5 / 300.0;
  EXPECT_NEAR(fast.sample_rate_hz->value, 301.5, 1e-6);
  EXPECT_DOUBLE_EQ(value(fast, "coulomb"), value(nominal, "coulomb"));
  EXPECT_NEAR(value(fast, "stiffness") / value(nominal, "stiffness"), ratio * ratio, 1e-9);
  EXPECT_NEAR(value(fast, "law_width") / value(nominal, "law_width"), 1.0 / ratio, 1e-9);
  EXPECT_NEAR(fast.curve.back().velocity_mps / nominal.curve.back().velocity_mps, 1.0 / ratio,
              1e-9);
  EXPECT_NEAR(fast.duration_s, 60.0 / ratio, 1e-6);
}

/// Independent of the scaling rule: the core told the true rate gives nearly what the rule gives.
TEST(TruckRun, CorrectedAgreesWithTheCoreAtTheTrueRate) {
  Config told;
  told.input.sample_rate_hz = 301.5;
  const auto all = [](Sample&) { return true; };
  const RunResult corrected = identify(60.0, {}, 301.5, all);
  const RunResult direct = identify(60.0, told, 301.5, all);
  EXPECT_NEAR(value(corrected, "stiffness") / value(direct, "stiffness"), 1.0, 2e-3);
  EXPECT_NEAR(value(corrected, "coulomb") / value(direct, "coulomb"), 1.0, 2e-3);
}

TEST(TruckRun, RefusesARateThatIsNotTheNominalOne) {
  try {
    static_cast<void>(identify(30.0, {}, 310.0, [](Sample&) { return true; }));
    ADD_FAILURE();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr("310.000"));
    EXPECT_THAT(error.what(), HasSubstr("300.000"));
  }
}

TEST(TruckRun, RefusesEffectsThatItCannotIdentify) {
  Config config;
  config.model.base = {"coulomb", "backlash"};
  EXPECT_THROW(TruckRun<kIdentifyParts>{config}, UsageError);
}

TEST(ConvergenceHistory, StaysBoundedAndCoversTheWholeRecord) {
  ConvergenceHistory history{100, 0};
  Level level;
  level.valid = true;
  std::int64_t levels = 0;
  for (std::int64_t tick = 1; tick <= 10'000'000; ++tick) {
    if (!history.due(tick)) continue;
    history.add(tick, level);
    ++levels;
  }
  EXPECT_LE(history.rows().size(), ConvergenceHistory::kMost);
  EXPECT_GE(history.rows().size(), ConvergenceHistory::kMost / 2 - 1);
  EXPECT_LT(history.rows().front().tick, 300'000);
  EXPECT_GT(history.rows().back().tick, 9'800'000);
  EXPECT_LT(levels, 1500) << "levels cost a fraction of a millisecond each";
}

// Steps of 0.4 m/s^2 under a motion of 0.3 m/s^2: the largest code comes often, the next more
// often.
TEST(ClippingWatch, TakesCoarseCodesForNoClipping) {
  std::mt19937_64 random{3};
  std::normal_distribution<double> motion_mps2{0.0, 0.3};
  ClippingWatch coarse;
  ClippingWatch clips;
  for (int i = 0; i < 90'000; ++i) {
    Sample sample{.tick = i};
    sample.accel_mps2[0] = 0.4 * std::clamp(std::round(motion_mps2(random) / 0.4), -2.0, 2.0);
    coarse.take(sample);
    sample.accel_mps2[0] = std::min(std::round(motion_mps2(random) / 0.01), 70.0);
    clips.take(sample);
  }
  EXPECT_THAT(coarse.warnings(), testing::IsEmpty());
  ASSERT_EQ(clips.warnings().size(), 1U);
  EXPECT_THAT(clips.warnings().front(), HasSubstr("frame seems to clip"));
}

TEST(ExcludedList, JoinsNeighboursAndStaysBounded) {
  ExcludedList list;
  list.add(0.0, 2.0, "gap");
  list.add(2.0, 4.0, "gap");
  list.add(4.0, 6.0, "stuck");
  ASSERT_EQ(list.list().size(), 2U);
  EXPECT_EQ(list.list()[0].end_s, 4.0);
  for (int i = 0; i < 10000; ++i) list.add(10.0 * i + 10.0, 10.0 * i + 12.0, "gap");
  EXPECT_EQ(list.list().size(), ExcludedList::kMost);
  EXPECT_EQ(list.more(), 10002U - ExcludedList::kMost);
}

}  // namespace
}  // namespace dampline::app
