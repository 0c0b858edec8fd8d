// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/density/white_run.hpp"

namespace dampline {
namespace {

constexpr int kMinuteTicks = 60 * 300;

/// A white run, each instant changed on its way.
FokkerPlanckEstimates changed_run(const std::function<void(Motion&)>& change,
                                  int samples = kMinuteTicks, FokkerPlanckConfig config = {}) {
  const auto run = std::make_unique<FokkerPlanck>(config);
  sim::WhiteInput source{{.seed = 21}};
  for (int i = 0; i < samples; ++i) {
    Motion motion = source.next();
    change(motion);
    run->update(motion);
  }
  return run->estimates(kMassKg, kStiffnessNpm);
}

void expect_no_number(const FokkerPlanckEstimates& found, Reason reason) {
  for (const MethodResult* method : {&found.paper, &found.weak, &found.known_input}) {
    EXPECT_FALSE(method->verdict.has_number);
    EXPECT_FALSE(method->verdict.trusted);
    EXPECT_TRUE(method->verdict.violates(reason)) << text(reason);
    EXPECT_EQ(method->level_n.value, 0.0);
    for (const CurvePoint& point : method->curve) EXPECT_EQ(point.force_n, 0.0);
  }
}

TEST(Verdict, TrustsAWhiteMinute) {
  const auto found = changed_run([](Motion&) {});
  for (const MethodResult* method : {&found.paper, &found.weak, &found.known_input}) {
    EXPECT_TRUE(method->verdict.has_number);
    EXPECT_TRUE(method->verdict.trusted);
    Reason reason{};
    EXPECT_FALSE(method->verdict.first_violation(reason)) << text(reason);
  }
}

TEST(Verdict, OfNothingAtAll) {
  const FokkerPlanck nothing{{}};
  expect_no_number(nothing.estimates(kMassKg, kStiffnessNpm), Reason::kNoMotion);
}

TEST(Verdict, OfAStandstill) {
  expect_no_number(changed_run([](Motion& m) { m.still = true; }), Reason::kNoMotion);
}

TEST(Verdict, OfARecordWithoutMotion) {
  const auto found = changed_run([](Motion& m) {
    m.deflection_m = 0.0;
    m.velocity_mps = 0.0;
  });
  expect_no_number(found, Reason::kNoMotion);
  EXPECT_EQ(found.weak.verdict[Reason::kNoMotion].size, 0.0);
}

TEST(Verdict, OfAConstantChannel) {
  expect_no_number(changed_run([](Motion& m) {
                     m.relative_mps2 -= 2.0 * m.frame_mps2;
                     m.frame_mps2 = 0.1;
                     m.relative_mps2 += 2.0 * m.frame_mps2;
                   }),
                   Reason::kConstantChannel);
  expect_no_number(changed_run([](Motion& m) { m.relative_mps2 = 2.0 * m.frame_mps2; }),
                   Reason::kConstantChannel);
}

TEST(Verdict, OfAShortRecord) {
  expect_no_number(changed_run([](Motion&) {}, 20 * 300), Reason::kShortRecord);
}

TEST(Verdict, LeavesOutWhatIsNotFinite) {
  int i = 0;
  const auto run = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{});
  sim::WhiteInput source{{.seed = 21}};
  for (; i < kMinuteTicks; ++i) {
    Motion motion = source.next();
    if (i % 1000 == 0) motion.frame_mps2 = std::numeric_limits<double>::quiet_NaN();
    run->update(motion);
  }
  EXPECT_EQ(run->not_finite(), 18U);
  const auto found = run->estimates(kMassKg, kStiffnessNpm);
  EXPECT_TRUE(found.known_input.verdict.trusted);
  EXPECT_NEAR(found.known_input.level_n.value, kLevelN, 10.0);
}

// The range holds four fifths of the mass. The sums of the other two forms have no range.
TEST(Verdict, OfARangeThatClips) {
  const double limit_mps = 8.9e-3;
  const auto found = changed_run([](Motion&) {}, kMinuteTicks,
                                 {.velocity_mps = {.low = -limit_mps, .high = limit_mps}});
  const Finding& clipped = found.paper.verdict[Reason::kRangeClips];
  EXPECT_TRUE(clipped.violated);
  EXPECT_NEAR(clipped.size, 0.2, 0.04);
  EXPECT_FALSE(found.paper.verdict.has_number);
  EXPECT_EQ(found.paper.level_n.value, 0.0);
  EXPECT_TRUE(found.weak.verdict.trusted);
  EXPECT_TRUE(found.known_input.verdict.trusted);
}

TEST(Verdict, ColourHasNoUnit) {
  const auto colour_db = [](double times) {
    const auto found = changed_run([=](Motion& m) {
      m.frame_mps2 *= times;
      m.relative_mps2 *= times;
    });
    return found.weak.verdict[Reason::kColouredInput].size;
  };
  EXPECT_GT(colour_db(1.0), 0.1);
  EXPECT_NEAR(colour_db(30.0), colour_db(1.0), 1e-6);
}

// Two wheelsets of one truck at 60 km/h: nulls at 4.6, 13.9, 23.1 Hz.
TEST(Verdict, OfTheWheelbaseComb) {
  std::array<double, 32> past{};
  std::size_t place = 0;
  const auto found = changed_run([&](Motion& m) {
    const double now = m.input_mps2();
    m.relative_mps2 += past[place];
    past[place] = now;
    place = (place + 1) % past.size();
  });
  for (const MethodResult* method : {&found.paper, &found.weak}) {
    EXPECT_TRUE(method->verdict.has_number);
    EXPECT_FALSE(method->verdict.trusted);
    EXPECT_TRUE(method->verdict.violates(Reason::kColouredInput));
    EXPECT_GT(method->verdict[Reason::kColouredInput].size, 3.5);
  }
  EXPECT_TRUE(found.known_input.verdict.trusted);
}

TEST(Verdict, OfDeflectionThatFollowsVelocity) {
  const auto found = changed_run([](Motion& m) { m.deflection_m += 0.05 * m.velocity_mps; });
  EXPECT_TRUE(found.paper.verdict.violates(Reason::kDependence));
  EXPECT_FALSE(found.paper.verdict.trusted);
}

TEST(Verdict, OfInputThatGrows) {
  const auto run = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{});
  std::int64_t tick = 0;
  for (const double level : {3.0e-3, 12.0e-3}) {
    sim::WhiteInput source{{.seed = 22, .input_level = level}};
    for (int i = 0; i < 100 * 300; ++i) {
      Motion motion = source.next();
      motion.tick = tick++;
      run->update(motion);
    }
  }
  const auto found = run->estimates(kMassKg, kStiffnessNpm);
  EXPECT_TRUE(found.weak.verdict.violates(Reason::kNonStationary));
  EXPECT_NEAR(found.weak.verdict[Reason::kNonStationary].size, std::log(8.5),
              0.4);  // the power of v goes with the square
  EXPECT_TRUE(found.known_input.verdict.trusted);
}

// What each method depends on, and how much of it is borne.
TEST(Verdict, ChecksWhatAMethodDependsOn) {
  const auto found = changed_run([](Motion&) {});
  const auto limit_of = [](const MethodResult& method, Reason reason) {
    const Finding& finding = method.verdict[reason];
    return finding.checked ? finding.limit : -1.0;
  };
  for (const MethodResult* method : {&found.paper, &found.weak, &found.known_input}) {
    EXPECT_EQ(limit_of(*method, Reason::kNoMotion), 0.5e-3);
    EXPECT_EQ(limit_of(*method, Reason::kConstantChannel), 1e-3);
    EXPECT_EQ(limit_of(*method, Reason::kShortRecord), 30.0);
    EXPECT_EQ(limit_of(*method, Reason::kNotSolvable), 0.5);
    const bool is_paper = method == &found.paper;
    const bool is_known = method == &found.known_input;
    EXPECT_EQ(limit_of(*method, Reason::kNarrowMotion), is_paper ? -1.0 : 2.0);
    EXPECT_EQ(limit_of(*method, Reason::kRangeClips), is_paper ? 0.02 : -1.0);
    EXPECT_EQ(limit_of(*method, Reason::kColouredInput), is_known ? -1.0 : 2.5);
    EXPECT_EQ(limit_of(*method, Reason::kDependence), is_paper ? 0.2 : -1.0);
    EXPECT_EQ(limit_of(*method, Reason::kBentCurve), is_known ? 0.13 : -1.0);
    EXPECT_EQ(method->verdict[Reason::kNonStationary].checked, !is_known);
  }
  const Finding& stationary = found.weak.verdict[Reason::kNonStationary];
  EXPECT_GT(stationary.limit, 0.3);
  EXPECT_LT(stationary.limit, 1.2);
  EXPECT_EQ(stationary.limit, found.paper.verdict[Reason::kNonStationary].limit);
}

// Of sines: the root of half their squared amplitude; a constant beside them does not count.
TEST(Verdict, MeasuresMotionAndChange) {
  FokkerPlanck run{{}};
  for (std::int64_t tick = 0; tick < 30'000; ++tick) {
    const double phase = 0.1 * 3.14159265358979 * static_cast<double>(tick);
    run.update({.tick = tick,
                .deflection_m = 1e-3 * std::cos(phase),
                .velocity_mps = 8e-3 * std::sin(phase),
                .frame_mps2 = 9.81 + 0.4 * std::sin(phase),
                .relative_mps2 = 3.0 + 0.2 * std::sin(phase)});
  }
  EXPECT_NEAR(run.velocity_rms_mps(), 8e-3 * std::sqrt(0.5), 1e-9);
  const auto& verdict = run.estimates(kMassKg, kStiffnessNpm).weak.verdict;
  EXPECT_NEAR(verdict[Reason::kNoMotion].size, 8e-3 * std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(verdict[Reason::kConstantChannel].size, 0.4 * std::sqrt(0.5), 1e-6)
      << "the input's is 0.6";
  EXPECT_NEAR(verdict[Reason::kShortRecord].size, 100.0, 1e-9);
}

/// Friction of this level from 5.5 to 8 mm/s and of `fast` beyond 14.5 mm/s, so many samples there.
Finding bent_curve(double slow_mps2, double fast_mps2, int fast_samples = 2000,
                   double deflection_m = 0.0) {
  FokkerPlanck run{{}};
  std::int64_t tick = 0;
  const auto give_side = [&](double speed_mps, double level_mps2, int samples) {
    for (int i = 0; i < 2 * samples; ++i, ++tick) {
      const double sign = i % 2 == 0 ? 1.0 : -1.0;
      run.update({.tick = tick,
                  .deflection_m = sign * deflection_m,
                  .velocity_mps = sign * speed_mps,
                  .frame_mps2 = -0.5 * sign * level_mps2 + 0.1,
                  .relative_mps2 = 0.3});
    }
  };
  for (const double speed_mps : {1e-3, 2e-3, 4e-3}) give_side(speed_mps, 0.1, 2000);
  give_side(7e-3, slow_mps2, 2000);
  give_side(9e-3, 0.9, 2000);
  give_side(13e-3, 0.9, 2000);
  for (const double speed_mps : {15e-3, 20e-3, 30e-3})
    give_side(speed_mps, fast_mps2, fast_samples / 3);
  return run.estimates(kMassKg, kStiffnessNpm).known_input.verdict[Reason::kBentCurve];
}

// 1 - slow / fast, with what the spring takes in both.
TEST(Verdict, OfACurveThatFallsTowardsSlowMotion) {
  EXPECT_NEAR(bent_curve(0.40, 0.45).size, 1.0 - 0.40 / 0.45, 1e-9);
  EXPECT_FALSE(bent_curve(0.40, 0.45).violated);
  EXPECT_NEAR(bent_curve(0.38, 0.45).size, 1.0 - 0.38 / 0.45, 1e-9);
  EXPECT_TRUE(bent_curve(0.38, 0.45).violated);
  EXPECT_NEAR(bent_curve(0.5, 0.4).size, -0.25, 1e-9);
  const double spring_mps2 = 2.0 * kStiffnessNpm / kMassKg * 1e-4;
  EXPECT_NEAR(bent_curve(0.4, 0.5, 2000, 1e-4).size,
              1.0 - (0.4 - spring_mps2) / (0.5 - spring_mps2), 1e-9);
  EXPECT_TRUE(bent_curve(0.3, 0.45, 303).checked);
  EXPECT_FALSE(bent_curve(0.3, 0.45, 297).checked) << "three hundred a side tell a force";
}

TEST(Verdict, HasWordsForEveryReason) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < kReasons; ++i) {
    words.emplace_back(text(static_cast<Reason>(i)));
    EXPECT_GT(words.back().size(), 10U);
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(words[i], words[j]);
  }
}

}  // namespace
}  // namespace dampline
