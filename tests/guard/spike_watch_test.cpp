// SPDX-License-Identifier: MIT
#include "dampline/guard/spike_watch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace dampline {
namespace {

constexpr std::int64_t kSegment = 600;
// To and fro by one code: all second differences are 4, their deviation 4 / 0.6745 + 0.5 = 6.43.
constexpr double kScale = 4.0 / 0.6745 + 0.5;

/// The strikes of a channel that goes to and fro by one code, with these codes added.
std::vector<Strike> strikes_of(const std::map<std::int64_t, std::int64_t>& added,
                               std::int64_t samples = 2 * kSegment) {
  SpikeWatch watch{kSegment};
  std::vector<Strike> all;
  for (std::int64_t tick = 0; tick < samples; ++tick) {
    const auto found = added.find(tick);
    watch.update(tick, (tick % 2 == 0 ? 1 : -1) + (found == added.end() ? 0 : found->second));
    for (Strike strike; watch.next(strike);) all.push_back(strike);
  }
  return all;
}

TEST(SpikeWatch, KnowsTheDeviationOfTheSecondDifference) {
  SpikeWatch watch{kSegment};
  for (std::int64_t tick = 0; tick < kSegment; ++tick) {
    EXPECT_EQ(watch.scale(), 0.0);
    watch.update(tick, tick % 2 == 0 ? 1 : -1);
  }
  EXPECT_NEAR(watch.scale(), kScale, 1e-12);
}

// A height of h makes a second difference of 4 + 2 h: seven deviations are 45.01.
TEST(SpikeWatch, AStrikeIsAboveSevenDeviations) {
  EXPECT_TRUE(strikes_of({{300, 20}}).empty());
  const auto found = strikes_of({{300, 21}});
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].tick, 300);
  EXPECT_FALSE(found[0].digital);
}

// Ten deviations are 64.3. Its neighbours say -10 / 6 where it would be 1.
TEST(SpikeWatch, AWrongSampleIsAboveTen) {
  EXPECT_FALSE(strikes_of({{300, 30}})[0].digital);
  const auto found = strikes_of({{300, 31}});
  EXPECT_TRUE(found[0].digital);
  EXPECT_EQ(found[0].height, 34);
  EXPECT_EQ(strikes_of({{301, -31}})[0].height, -34);
}

// What neighbours say of a sample is exact where the motion is a polynomial of third order.
TEST(SpikeWatch, TheHeightOfAWrongSampleIsOffACubic) {
  constexpr std::int64_t kWrong = 300;
  SpikeWatch watch{kSegment};
  std::vector<Strike> all;
  for (std::int64_t tick = 0; tick < kSegment; ++tick) {
    const std::int64_t n = std::clamp<std::int64_t>(tick - kWrong, -20, 20);
    watch.update(tick, n * n * n - 5 * n * n + 70 * n + (tick == kWrong ? 5000 : 0));
    for (Strike strike; watch.next(strike);)
      if (strike.tick == kWrong) all.push_back(strike);
  }
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].height, 5000);
}

TEST(SpikeWatch, AWrongSampleLeavesItsNeighboursAsUsual) {
  // Another one beside it leaves 24 or 28; four deviations are 25.7.
  EXPECT_TRUE(strikes_of({{300, 100}, {303, -10}})[0].digital);
  EXPECT_FALSE(strikes_of({{300, 100}, {303, -12}})[0].digital);
  // And 22 or 24; 0.35 of its own second difference is 23.1.
  EXPECT_TRUE(strikes_of({{300, 31}, {303, -9}})[0].digital);
  EXPECT_FALSE(strikes_of({{300, 31}, {303, -10}})[0].digital);
}

TEST(SpikeWatch, AWrongSampleRaisesNoFarSecondDifferences) {
  EXPECT_TRUE(strikes_of({{300, 80}, {305, 60}})[0].digital) << "four in all";
  EXPECT_FALSE(strikes_of({{300, 80}, {305, 60}, {295, 60}})[0].digital) << "five";
}

// Until the first 75 samples have told what is usual there is no gate.
TEST(SpikeWatch, LooksFromTheSeventyFifthSampleOn) {
  EXPECT_TRUE(strikes_of({{72, 60}}).empty());
  EXPECT_EQ(strikes_of({{74, 60}}).size(), 1U);
}

// The last second difference of a strike is known two samples later; twelve more end it.
TEST(SpikeWatch, StrikesWithinTwelveSamplesAreOne) {
  const auto one = strikes_of({{300, 60}, {314, 80}});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].tick, 314) << "the largest";
  EXPECT_EQ(strikes_of({{300, 60}, {315, 80}}).size(), 2U);
}

TEST(SpikeWatch, WhatGoesOnIsJudgedEveryFortySamples) {
  std::map<std::int64_t, std::int64_t> train;
  for (std::int64_t tick = 200; tick <= 300; tick += 10) train[tick] = 60;
  EXPECT_EQ(strikes_of(train).size(), 3U);
  train[310] = train[320] = train[330] = 60;
  EXPECT_EQ(strikes_of(train).size(), 4U);
}

// Forty samples after the first the event ends, but not before the largest has its neighbours.
TEST(SpikeWatch, KeepsTheLargestThoughTheEventEndsThere) {
  for (std::int64_t last = 234; last <= 242; ++last) {
    std::map<std::int64_t, std::int64_t> train;
    for (std::int64_t tick = 200; tick < last - 5; tick += 10) train[tick] = 60;
    train[last] = 200;
    bool kept = false;
    for (const Strike& strike : strikes_of(train)) kept |= strike.tick == last && strike.digital;
    EXPECT_TRUE(kept) << last;
  }
}

TEST(SpikeWatch, KeepsTheTwentyFourHighestOfASegment) {
  std::map<std::int64_t, std::int64_t> many;
  for (std::int64_t i = 0; i < 26; ++i) many[100 + 18 * i] = i == 7 ? 40 : i == 9 ? 41 : 60 + i;
  const auto found = strikes_of(many);
  EXPECT_EQ(found.size(), 24U);
  for (const Strike& strike : found) {
    EXPECT_NE(strike.tick, 100 + 18 * 7);
    EXPECT_NE(strike.tick, 100 + 18 * 9);
  }
}

TEST(SpikeWatch, TellsAStrikeWhenItsSegmentEnds) {
  EXPECT_TRUE(strikes_of({{300, 60}}, kSegment - 1).empty());
  EXPECT_EQ(strikes_of({{300, 60}}, kSegment).size(), 1U);
  EXPECT_EQ(strikes_of({{300, 60}, {900, 60}}, 1199).size(), 1U);
  EXPECT_EQ(strikes_of({{300, 60}, {900, 60}, {1500, 60}}, 1200).size(), 2U);
}

TEST(SpikeWatch, TheEndKeepsWhatNobodyAskedForYet) {
  SpikeWatch watch{kSegment};
  for (std::int64_t tick = 0; tick < kSegment + 100; ++tick)
    watch.update(tick, (tick % 2 == 0 ? 1 : -1) + (tick == 300 ? 60 : 0));
  watch.finish();
  Strike strike;
  ASSERT_TRUE(watch.next(strike));
  EXPECT_EQ(strike.tick, 300);
}

TEST(SpikeWatch, ForgetsAnOpenStrikeWhereSamplesAreMissing) {
  SpikeWatch watch{kSegment};
  std::int64_t tick = 0;
  const auto go = [&](int count, std::int64_t level) {
    for (int i = 0; i < count; ++i, ++tick) watch.update(tick, level + (tick % 2 == 0 ? 1 : -1));
  };
  go(300, 0);
  watch.restart();
  go(300, 500);  // another level, which is no second difference
  Strike strike;
  EXPECT_FALSE(watch.next(strike));
  go(300, 500);
  watch.update(tick++, 700);
  go(1, 500);
  watch.restart();
  go(300, 500);
  EXPECT_FALSE(watch.next(strike));
}

// Five samples on either side are looked at: of what a gap cut off there are too few.
TEST(SpikeWatch, JudgesAStrikeFromTheSixthSampleAfterAGapOn) {
  for (const auto& [before, judged] : {std::pair{4, false}, std::pair{5, true}}) {
    SpikeWatch watch{kSegment};
    std::int64_t tick = 0;
    const auto go = [&](std::int64_t count, std::int64_t added) {
      for (std::int64_t i = 0; i < count; ++i, ++tick)
        watch.update(tick, 500 + added + (tick % 2 == 0 ? 1 : -1));
    };
    go(kSegment, 0);
    watch.restart();
    go(before, 0);
    go(1, 60);
    go(kSegment, 0);
    Strike strike;
    EXPECT_EQ(watch.next(strike), judged) << before;
  }
}

Regularity regularity_of(const std::vector<std::int64_t>& intervals) {
  Regularity rhythm;
  std::int64_t tick = 1000;
  rhythm.add(tick);
  for (const std::int64_t interval : intervals) rhythm.add(tick += interval);
  return rhythm;
}

TEST(Regularity, IsEightIntervalsThatAreMultiplesOfOne) {
  EXPECT_FALSE(regularity_of({50, 50, 100, 50, 150, 50, 50}).regular()) << "seven";
  EXPECT_TRUE(regularity_of({50, 50, 100, 50, 150, 50, 50, 50}).regular());
  EXPECT_TRUE(regularity_of({50, 50, 75, 50, 150, 50, 50, 50}).regular()) << "one may differ";
  EXPECT_FALSE(regularity_of({50, 50, 75, 50, 125, 50, 50, 50}).regular());
  EXPECT_TRUE(regularity_of({75, 75, 75, 50, 50, 50, 50, 50, 50, 50, 50}).regular())
      << "the newest eight";
}

TEST(Regularity, ToleratesAnEighthOfTheInterval) {
  EXPECT_TRUE(regularity_of({100, 111, 189, 111, 111, 111, 111, 111}).regular());
  EXPECT_FALSE(regularity_of({100, 113, 113, 100, 100, 100, 100, 100}).regular());
  EXPECT_FALSE(regularity_of({100, 187, 187, 100, 100, 100, 100, 100}).regular());
}

TEST(Regularity, NeedsTwelveSamplesBetween) {
  EXPECT_TRUE(regularity_of({12, 12, 12, 12, 12, 12, 12, 12}).regular());
  EXPECT_FALSE(regularity_of({11, 11, 11, 11, 11, 11, 11, 11}).regular());
  EXPECT_TRUE(regularity_of({-20, 20, -20, 20, 20, 20, 20, 20}).regular()) << "in any order";
}

// Of nothing but impulses it is their mean square: the sixth difference passes 924 of each.
TEST(ImpulsePower, OfImpulsesAloneIsTheirMeanSquare) {
  ImpulsePower power;
  constexpr int kSamples = 2006;
  for (int i = 0; i < kSamples; ++i) power.update(i % 20 == 10 && i < 1990 ? 0.7 : 0.0);
  EXPECT_NEAR(power.take(), 99.0 * 0.49 / 2000.0, 1e-12);
  EXPECT_EQ(power.take(), 0.0) << "of what came since";
  for (int i = 0; i < 500; ++i) power.update(0.0);
  EXPECT_EQ(power.take(), 0.0);
}

TEST(ImpulsePower, OfOneSizeThroughoutIsNothing) {
  ImpulsePower power;
  for (int i = 0; i < 500; ++i) power.update(i % 2 == 0 ? 1.0 : -1.0);
  EXPECT_EQ(power.take(), 0.0);
}

// Half of the sixth differences are 64 a, the others 0 or less: what the median tells goes off.
TEST(ImpulsePower, TakesOffWhatNormalMotionWouldHave) {
  ImpulsePower power;
  double squares = 0.0;
  int count = 0;
  for (int i = 0; i < 1006; ++i) {  // sizes of 64 from motion to and fro, and two impulses
    const double x = (i % 2 == 0 ? 0.01 : -0.01) + (i == 300 || i == 700 ? 5.0 : 0.0);
    power.update(x);
    if (i >= 6) ++count;
  }
  // Around an impulse at an even sample: 0.64 + 5 b with b = 1, -6, 15, -20, ...
  for (const double b : {1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0})
    squares += 2.0 * std::pow(0.64 * (b > 0.0 ? 1.0 : -1.0) + 5.0 * b, 2);
  squares += (count - 14) * 0.64 * 0.64;
  const double usual = 0.64 / 0.6745;
  EXPECT_NEAR(power.take(), (squares / count - usual * usual) / 924.0, 0.03 * 25.0 / 500.0 * 0.5);
}

TEST(ImpulsePower, SixSamplesAfterARestartMakeNone) {
  ImpulsePower power;
  for (int i = 0; i < 100; ++i) power.update(0.0);
  power.restart();
  for (int i = 0; i < 106; ++i) power.update(5.0);  // a step that is none
  EXPECT_EQ(power.take(), 0.0);
  for (int i = 0; i < 100; ++i) power.update(7.0);
  EXPECT_GT(power.take(), 0.0);
}

}  // namespace
}  // namespace dampline
