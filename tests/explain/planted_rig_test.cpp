// SPDX-License-Identifier: MIT
// Rigs whose force is known: laws written anew here, in other shapes than the candidates', at
// lengths and speeds between the grids.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "app/run/tables.hpp"
#include "tests/explain/explained_rig.hpp"

namespace dampline::app {
namespace {

constexpr double kRateHz = 500.0;
constexpr double kLengthS = 60.0;
constexpr int kFine = 20;  // steps per sample of laws with memory

struct Motion {
  double deflection_m;
  double velocity_mps;
};

Motion motion_at(double t) {
  Motion out{0.0, 0.0};
  const double tones[][3] = {{0.006, 0.43, 0.0}, {0.004, 1.17, 1.0}, {0.0015, 2.9, 2.0}};
  for (const auto& [amplitude, hz, phase] : tones) {
    const double w = 2.0 * M_PI * hz;
    out.deflection_m += amplitude * std::sin(w * t + phase);
    out.velocity_mps += amplitude * w * std::cos(w * t + phase);
  }
  return out;
}

double sign(double v) { return v < 0.0 ? -1.0 : 1.0; }

/// Takes the motion in fine steps, with its own memory.
using Law = std::function<double(const Motion&, double step_m)>;

std::string record_of(Law law, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise;
  std::string text = "time_s,deflection_m,force_n\n";
  double last_m = motion_at(0.0).deflection_m;
  for (int i = 0; i < static_cast<int>(kRateHz * kLengthS); ++i) {
    double force_n = 0.0;
    Motion motion{};
    for (int k = 1; k <= kFine; ++k) {
      motion = motion_at((i + static_cast<double>(k) / kFine) / kRateHz);
      force_n = law(motion, motion.deflection_m - last_m);
      last_m = motion.deflection_m;
    }
    text += fmt::format("{:.6f},{:.9f},{:.4f}\n", i / kRateHz,
                        motion.deflection_m + 2e-7 * noise(random), force_n + 3.0 * noise(random));
  }
  return text;
}

Law simple() {
  return
      [](const Motion& m, double) { return 300.0 * sign(m.velocity_mps) + 900.0 * m.velocity_mps; };
}

/// d z / d x = (1 - z sign x')^2 / r: softer than Dahl's plain law and than a stop.
Law presliding(double r) {
  return [r, z = 0.0](const Motion& m, double step_m) mutable {
    const double left = 1.0 - z * sign(m.velocity_mps);
    z += step_m * left * left / r;
    return 300.0 * z + 900.0 * m.velocity_mps;
  };
}

/// A friction element that is driven over a pin in a slot.
Law backlash(double gap_m) {
  return [gap_m, pin_m = 0.0, stretch_m = 0.0](const Motion& m, double step_m) mutable {
    pin_m += step_m;
    const double before_m = pin_m;
    pin_m = std::clamp(pin_m, -0.5 * gap_m, 0.5 * gap_m);
    const double carried_m = before_m - pin_m;
    stretch_m = std::clamp(stretch_m + carried_m, -1e-4, 1e-4);
    const bool free = std::abs(pin_m) < 0.5 * gap_m;
    if (free) stretch_m = 0.0;
    return 300.0 * stretch_m / 1e-4 + 900.0 * m.velocity_mps;
  };
}

/// A spring behind a dashpot.
Law viscoelastic(double stiffness_npm, double time_s) {
  return [=, stretch_m = 0.0](const Motion& m, double step_m) mutable {
    stretch_m += step_m - stretch_m / time_s / (kRateHz * kFine);
    return simple()(m, step_m) + stiffness_npm * stretch_m;
  };
}

struct Planted {
  const char* effect;
  Law law;
  bool spring;
};

rig::Explanation explained(const Law& law, bool spring, std::uint64_t seed,
                           const std::vector<std::string>& base = {"coulomb", "viscous"}) {
  Config config;
  config.model.base = base;
  config.model.base_is_set = true;
  config.model.stiffness = spring ? "identify" : "auto";
  return dampline::test::explained(record_of(law, seed), config);
}

class NamesOnARig : public ::testing::TestWithParam<Planted> {};

TEST_P(NamesOnARig, WhatWasPlanted) {
  const rig::Explanation found = explained(GetParam().law, GetParam().spring, 17);
  ASSERT_FALSE(found.steps.empty());
  EXPECT_EQ(found.steps[0].effect, GetParam().effect) << summarize(found);
  EXPECT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_LT(found.final.fit.held_out_nmse, 0.5 * found.base.fit.held_out_nmse);
}

double spring(const Motion& m) { return 9000.0 * m.deflection_m; }

std::string effect_of(const ::testing::TestParamInfo<Planted>& info) { return info.param.effect; }

INSTANTIATE_TEST_SUITE_P(
    Laws, NamesOnARig,
    ::testing::Values(
        Planted{"offset_force", [](const Motion& m, double s) { return simple()(m, s) - 70.0; },
                false},
        Planted{"asymmetric_viscous",
                [](const Motion& m, double s) {
                  return simple()(m, s) + (m.velocity_mps > 0.0 ? 2500.0 * m.velocity_mps : 0.0);
                },
                false},
        Planted{"quadratic_damping",
                [](const Motion& m, double s) {
                  return simple()(m, s) + 6.0e4 * m.velocity_mps * std::abs(m.velocity_mps);
                },
                false},
        Planted{"stribeck",
                [](const Motion& m, double) {
                  const double u = m.velocity_mps / 0.0083;
                  return sign(m.velocity_mps) * (300.0 + 180.0 * std::exp(-u * u)) +
                         900.0 * m.velocity_mps;
                },
                false},
        Planted{"progressive_friction",
                [](const Motion& m, double) {
                  const double grown = 1.0 + std::abs(m.deflection_m) / 0.013;
                  return 300.0 * grown * sign(m.velocity_mps) + 900.0 * m.velocity_mps;
                },
                false},
        Planted{"cubic_stiffness",
                [](const Motion& m, double s) {
                  const double x = m.deflection_m;
                  return simple()(m, s) + spring(m) + 1.7e8 * x * x * x;
                },
                true},
        Planted{"bump_stop",
                [](const Motion& m, double s) {
                  const double over = std::max(std::abs(m.deflection_m) - 0.0067, 0.0);
                  return simple()(m, s) + spring(m) + 9.0e4 * over * sign(m.deflection_m);
                },
                true}),
    effect_of);
INSTANTIATE_TEST_SUITE_P(NightlyLaws, NamesOnARig,
                         ::testing::Values(Planted{"presliding_hysteresis", presliding(0.0011),
                                                   false},
                                           Planted{"backlash", backlash(0.0037), false},
                                           Planted{"quadratic_stiffness",
                                                   [](const Motion& m, double s) {
                                                     return simple()(m, s) + spring(m) +
                                                            7.0e5 * m.deflection_m * m.deflection_m;
                                                   },
                                                   true},
                                           Planted{"asymmetric_stiffness",
                                                   [](const Motion& m, double s) {
                                                     return simple()(m, s) +
                                                            (m.deflection_m > 0.0 ? 1.6 : 1.0) *
                                                                spring(m);
                                                   },
                                                   true}),
                         effect_of);

TEST(ARigNightly, IsToldOfFrictionAndDampingThatNobodyDeclared) {
  const rig::Explanation friction = explained(simple(), false, 24, {"viscous"});
  ASSERT_FALSE(friction.steps.empty());
  EXPECT_EQ(friction.steps[0].effect, "coulomb") << summarize(friction);
  ASSERT_FALSE(friction.steps[0].parameters.empty());
  EXPECT_NEAR(friction.steps[0].parameters[0].value, 300.0, 6.0);
  const rig::Explanation damping = explained(simple(), false, 25, {"coulomb"});
  ASSERT_FALSE(damping.steps.empty());
  EXPECT_EQ(damping.steps[0].effect, "viscous") << summarize(damping);
  EXPECT_NEAR(damping.steps[0].parameters[0].value, 900.0, 45.0);
}

/// Friction with a memory leads, and is not named in its place.
TEST(ARigNightly, RelaxesWithTheSizesOfItsSpringAndDashpot) {
  const double planted[][2] = {{4.0e4, 0.13}, {1.0e5, 0.06}, {2.0e4, 0.5}};
  for (const auto& [stiffness_npm, time_s] : planted) {
    const rig::Explanation found =
        dampline::test::explained(record_of(viscoelastic(stiffness_npm, time_s), 61));
    ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
    ASSERT_EQ(found.steps[0].effect, "viscoelastic") << summarize(found);
    dampline::test::expect_size(found, "viscoelastic_stiffness", stiffness_npm, 2.5);
    dampline::test::expect_size(found, "viscoelastic_time", time_s, 2.5);
    EXPECT_STREQ(found.verdict(), "explained");
  }
}

/// Another law from a moment on.
Law changing_at(double change_s, Law before, Law after) {
  return [=, steps = 0](const Motion& m, double step_m) mutable {
    const bool is_after = ++steps > change_s * kRateHz * kFine;
    const double early_n = before(m, step_m);
    const double late_n = after(m, step_m);
    return is_after ? late_n : early_n;
  };
}

/// What changes at 25 s is said beside the memory, which keeps its name.
void expect_change(const rig::Explanation& found, const std::string& effect, double change_m) {
  ASSERT_EQ(found.steps.size(), 2U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, effect) << summarize(found);
  EXPECT_EQ(found.steps[1].effect, "time_drift") << summarize(found);
  ASSERT_EQ(found.steps[1].parameters.size(), 2U) << summarize(found);
  EXPECT_EQ(found.steps[1].parameters[0].name, "time_drift_" + effect + "_travel");
  // Of the plainest forms.
  EXPECT_GT(found.steps[1].parameters[0].value, 0.5 * change_m) << summarize(found);
  EXPECT_LT(found.steps[1].parameters[0].value, 1.5 * change_m) << summarize(found);
  EXPECT_NEAR(found.steps[1].parameters[1].value, 25.0, 3.5) << summarize(found);
  EXPECT_STREQ(found.verdict(), "partly_explained");
}

TEST(ARigNightly, WhoseGapGrowsOrBeginsChanges) {
  expect_change(explained(changing_at(25.0, backlash(0.002), backlash(0.005)), false, 71),
                "backlash", 0.003);
  expect_change(explained(changing_at(25.0, simple(), backlash(0.003)), false, 72), "backlash",
                0.003);
}

TEST(ARigNightly, WhoseFrictionBuildsUpOverAnotherTravelChanges) {
  expect_change(explained(changing_at(25.0, presliding(0.0006), presliding(0.003)), false, 73),
                "presliding_hysteresis", 0.0024);
}

/// The errors before and after the steps follow one another, and what a runner-up leaves is beside
/// the same columns.
void expect_chain(const rig::Explanation& found) {
  double before = found.base.fit.held_out_nmse;
  for (const app::Step& step : found.steps) {
    EXPECT_DOUBLE_EQ(step.held_out_before, before) << summarize(found);
    EXPECT_LE(step.held_out_after, before) << summarize(found);
    EXPECT_DOUBLE_EQ(step.gain, 1.0 - step.held_out_after / step.held_out_before);
    for (const JudgedCandidate& c : step.runners_up) {
      EXPECT_DOUBLE_EQ(c.gain, 1.0 - c.held_out_nmse / step.held_out_before);
      EXPECT_GT(c.held_out_nmse, 0.9 * step.held_out_after) << c.effect << summarize(found);
      EXPECT_LT(c.held_out_nmse, 1.02 * step.held_out_before) << c.effect << summarize(found);
    }
    before = step.held_out_after;
  }
  EXPECT_DOUBLE_EQ(found.final.fit.held_out_nmse, before) << summarize(found);
}

/// The spring is nobody's, and comes with the first step.
TEST(ARigNightly, HasErrorsThatFollowOneAnother) {
  const auto bent = [](const Motion& m, double s) {
    const double x = m.deflection_m;
    return simple()(m, s) + 9000.0 * x + 1.7e8 * x * x * x;
  };
  const rig::Explanation found = explained(bent, false, 74);
  ASSERT_FALSE(found.steps.empty());
  EXPECT_FALSE(found.steps[0].runners_up.empty());
  expect_chain(found);
  expect_chain(explained(presliding(0.0011), false, 75));
}

TEST(ARigNightly, LacksNothingWhereNothingIsMissing) {
  for (const std::uint64_t seed : {21U, 22U, 23U}) {
    const rig::Explanation found = explained(simple(), false, seed);
    EXPECT_TRUE(found.steps.empty()) << summarize(found);
    EXPECT_STREQ(found.verdict(), "complete");
    EXPECT_LT(found.base.fit.held_out_nmse, 0.01);
  }
}

TEST(ARig, KnowsWhatItsNoiseLeaves) {
  // 3 N of white noise on the force: what is left of a complete law.
  const rig::Explanation found = explained(simple(), false, 51);
  double squares = 0.0;
  double sum = 0.0;
  double count = 0.0;
  for (double t = 0.0; t < kLengthS; t += 1.0 / kRateHz) {
    const double force_n = simple()(motion_at(t), 0.0);
    squares += force_n * force_n;
    sum += force_n;
    ++count;
  }
  const double noise_nmse = 9.0 / (squares / count - (sum / count) * (sum / count));
  // The deflection's noise adds what the reversals' instants cost.
  EXPECT_GT(found.final.floor_nmse, 0.9 * noise_nmse);
  EXPECT_NEAR(found.final.left_over_floor(), 1.0, 0.3);
}

TEST(ARig, IsToldWhereAFoundLawIsNotTheWholeTruth) {
  // A friction element with a dead slot: no form of the library has its edges.
  const rig::Explanation found = explained(backlash(0.0037), false, 52);
  ASSERT_FALSE(found.steps.empty());
  EXPECT_GT(found.final.left_over_floor(), 1.5);
  EXPECT_STREQ(found.verdict(), "partly_explained");
  EXPECT_NE(to_json(found).find("like backlash, law incomplete"), std::string::npos);
}

TEST(ARig, NamesTwoEffectsRatherThanOneThatStandsForBoth) {
  const rig::Explanation found = explained(
      [](const Motion& m, double) {
        const double u = std::abs(m.velocity_mps) / 0.011;
        return sign(m.velocity_mps) * (300.0 + 220.0 / (1.0 + u * u)) + 2500.0 * m.velocity_mps;
      },
      false, 53, {"coulomb"});
  ASSERT_EQ(found.steps.size(), 2U) << summarize(found);
  std::vector<std::string> names{found.steps[0].effect, found.steps[1].effect};
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"stribeck", "viscous"})) << summarize(found);
}

TEST(ARigNightly, HasNoFunctionOfSpeedWhereThereIsOneSpeed) {
  // Up and down at 20 mm/s: what a viscous force is cannot be told from Coulomb friction.
  std::mt19937_64 random{54};
  std::normal_distribution<double> noise;
  std::string text = "time_s,deflection_m,force_n\n";
  for (int i = 0; i < 10000; ++i) {
    const double cycle = std::fmod(i / kRateHz * 0.5, 1.0);
    const double x = 0.01 * (cycle < 0.5 ? 4.0 * cycle - 1.0 : 3.0 - 4.0 * cycle);
    const double v = cycle < 0.5 ? 0.02 : -0.02;
    text += fmt::format("{:.6f},{:.9f},{:.4f}\n", i / kRateHz, x + 2e-7 * noise(random),
                        12000.0 * x + 9000.0 * v + 3.0 * noise(random));
  }
  const rig::Explanation found = dampline::test::explained(text);
  EXPECT_TRUE(found.steps.empty()) << summarize(found);
}

TEST(ARig, SaysThatSomethingIsLeftThatNoEffectExplains) {
  // A force that has nothing to do with the motion.
  const rig::Explanation found = explained(
      [law = simple(), i = 0](const Motion& m, double s) mutable {
        ++i;
        return law(m, s) + 150.0 * std::sin(0.01131 * i) * std::sin(0.000377 * i * std::sqrt(i));
      },
      false, 31);
  EXPECT_STREQ(found.verdict(), "unexplained") << summarize(found);
}

TEST(ARigNightly, IsPredictedFromItsMotionAlone) {
  const dampline::test::TemporaryFile fitted{record_of(backlash(0.0037), 41), ".csv"};
  const dampline::test::TemporaryFile other{record_of(backlash(0.0037), 42), ".csv"};
  // The same motion with the force wiped out after the first second gives the same prediction.
  std::string wiped = record_of(backlash(0.0037), 42);
  std::string kept;
  std::size_t line = 0;
  for (std::size_t at = 0; at < wiped.size(); ++line) {
    const std::size_t end = wiped.find('\n', at);
    const std::string row = wiped.substr(at, end - at);
    kept += line > 600 ? row.substr(0, row.rfind(',')) + ",1.0\n" : row + "\n";
    at = end + 1;
  }
  const dampline::test::TemporaryFile without{kept, ".csv"};
  const rig::Explanation found = rig::explain(
      dampline::test::two_terms(), {{fitted.path()}, {other.path(), without.path()}, "", false});
  ASSERT_EQ(found.validation.size(), 2U);
  EXPECT_LT(found.validation[0].rrse_after, 0.5 * found.validation[0].rrse_before);
  const auto predicted = [](const PredictedRow& row) { return row.predicted_n; };
  EXPECT_TRUE(std::ranges::equal(found.validation[0].rows, found.validation[1].rows, {}, predicted,
                                 predicted));
  EXPECT_NE(
      to_csv(found.evidence.prediction).find("record,time_s,measured_n,predicted_n,residual_n,"),
      std::string::npos);
}

}  // namespace
}  // namespace dampline::app
