// SPDX-License-Identifier: MIT
#include "dampline/guard/channel_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace dampline {
namespace {

double step_of(std::initializer_list<double> values) {
  StepMeter meter;
  for (const double value : values) meter.update(value);
  return meter.step();
}

TEST(StepMeter, IsTheLeastChangeThatIsNoRounding) {
  EXPECT_EQ(step_of({5.0}), 0.0);
  EXPECT_EQ(step_of({5.0, 5.0}), 0.0);
  EXPECT_NEAR(step_of({5.0, 5.3, 5.3, 5.1, 5.6}), 0.2, 1e-12);
  EXPECT_EQ(step_of({0.0, 0.9e-9}), 0.0);
  EXPECT_EQ(step_of({0.0, 1.2e-9}), 1.2e-9);
}

TEST(RangeEnd, CountsCodesByTheirDistanceFromTheExtreme) {
  RangeEnd end;
  EXPECT_FALSE(end.any());
  for (const int code : {5, 5, 4, 7, 7, 7, 6, -8, -9}) end.add(code);
  EXPECT_TRUE(end.any());
  EXPECT_EQ(end.extreme(), 7);
  EXPECT_EQ(end.outer(1), 3U);
  EXPECT_EQ(end.inner(1), 1U);
  EXPECT_EQ(end.outer(2), 4U);
  EXPECT_EQ(end.inner(2), 3U);
  EXPECT_EQ(end.outer(15), 7U);
  EXPECT_EQ(end.outer(16), 8U) << "the sixteenth code is 15 below";
  EXPECT_EQ(end.inner(8), 1U);
  EXPECT_EQ(end.outer(40), 8U);
}

TEST(RangeEnd, MovesWithTheExtreme) {
  RangeEnd end;
  for (const int code : {0, 0, 1}) end.add(code);
  end.add(15);
  EXPECT_EQ(end.outer(1), 1U);
  EXPECT_EQ(end.outer(15), 2U);
  EXPECT_EQ(end.outer(16), 4U);
  end.add(31);
  EXPECT_EQ(end.outer(16), 1U) << "15 lies 16 below";
  end.add(1000);
  EXPECT_EQ(end.outer(16), 1U);
  end.clear();
  EXPECT_FALSE(end.any());
  end.add(-3);
  EXPECT_EQ(end.extreme(), -3);
  EXPECT_EQ(end.outer(16), 1U);
}

/// A block: so many samples of each code, and zeros up to `samples`.
using CodeCounts = std::vector<std::pair<std::int64_t, int>>;
CodeVerdict close_block(CodeWatch& watch, const CodeCounts& counts, int samples = 1200) {
  std::int64_t tick = 0;
  for (const auto& [code, count] : counts)
    for (int i = 0; i < count; ++i) watch.update(tick++, code);
  while (tick < samples) watch.update(tick++, 0);
  return watch.close();
}

CodeVerdict verdict_of(const CodeCounts& counts, int samples = 1200) {
  CodeWatch watch;
  return close_block(watch, counts, samples);
}

TEST(CodeWatch, JudgesFromSixHundredSamplesThatSpanTwentyFourCodes) {
  EXPECT_EQ(verdict_of({{-12, 1}, {12, 1}}, 600).dead_bits, 2);
  EXPECT_EQ(verdict_of({{-12, 1}, {12, 1}}, 599).dead_bits, 0);
  EXPECT_EQ(verdict_of({{-10, 1}, {12, 1}}, 600).dead_bits, 0);
  EXPECT_EQ(verdict_of({{-10, 1}, {14, 1}}, 600).dead_bits, 1);
  EXPECT_EQ(verdict_of({}, 0).dead_bits, 0);
}

TEST(CodeWatch, SeesBitsThatMovedInThisBlockAlone) {
  CodeWatch watch;
  watch.update(0, 8);
  EXPECT_EQ(watch.dead_bits(), 16) << "as many as are looked at, before any did";
  watch.update(1, 12);
  EXPECT_EQ(watch.dead_bits(), 2);
  watch.update(2, 13);
  EXPECT_EQ(watch.dead_bits(), 0);
  static_cast<void>(watch.close());
  watch.update(3, 1);  // odd, but it stays odd
  watch.update(4, 17);
  EXPECT_EQ(watch.dead_bits(), 4);
}

TEST(CodeWatch, KnowsTheEndsOfItsBlock) {
  CodeWatch watch;
  for (const int code : {3, -5, 9}) watch.update(0, code);
  EXPECT_TRUE(watch.is_extreme(9));
  EXPECT_TRUE(watch.is_extreme(10));
  EXPECT_TRUE(watch.is_extreme(-5));
  EXPECT_FALSE(watch.is_extreme(8));
  EXPECT_FALSE(watch.is_extreme(-4));
}

// n at the extreme, one of which it has by definition, and none beside it: n - 1 of them deviate
// from none by sqrt(n - 1), five deviations with 25.
TEST(CodeWatch, APileIsFiveDeviationsAboveChance) {
  EXPECT_TRUE(verdict_of({{-29, 1}, {30, 26}}).clips);
  EXPECT_FALSE(verdict_of({{-29, 1}, {30, 25}}).clips);
  EXPECT_TRUE(verdict_of({{-30, 26}, {29, 1}}).clips);
  EXPECT_FALSE(verdict_of({{-30, 25}, {29, 1}}).clips);
  EXPECT_FALSE(verdict_of({{-29, 1}, {30, 60}, {29, 25}}).clips) << "59 - 25 < 5 sqrt(84)";
  EXPECT_TRUE(verdict_of({{-29, 1}, {30, 76}, {29, 25}}).clips) << "75 - 25 = 5 sqrt(100)";
  EXPECT_FALSE(verdict_of({{-29, 1}, {30, 75}, {29, 25}}).clips);
}

TEST(CodeWatch, APileIsOneAndAHalfTimesWhatIsBesideIt) {
  EXPECT_TRUE(verdict_of({{-29, 1}, {30, 606}, {29, 400}}).clips);
  EXPECT_FALSE(verdict_of({{-29, 1}, {30, 605}, {29, 400}}).clips);
}

// A pile of two codes is looked for where the channel spans 80 codes, of four where it spans 160.
TEST(CodeWatch, APileIsNarrowBesideTheSpan) {
  const CodeCounts two{{50, 13}, {49, 13}};
  const CodeCounts four{{100, 7}, {99, 7}, {98, 6}, {97, 6}};
  const auto with = [](CodeCounts counts, std::int64_t bottom) {
    counts.emplace_back(bottom, 1);
    return verdict_of(counts).clips;
  };
  EXPECT_TRUE(with(two, -30));
  EXPECT_FALSE(with(two, -29));
  EXPECT_TRUE(with(four, -60));
  EXPECT_FALSE(with(four, -59));
}

TEST(CodeWatch, SaysWhereAndHowOftenItClips) {
  const CodeVerdict top = verdict_of({{0, 7}, {-29, 1}, {30, 40}});
  EXPECT_EQ(top.clip_code, 30);
  EXPECT_EQ(top.clip_count, 40);
  EXPECT_EQ(top.clip_first, 8);
  const CodeVerdict bottom = verdict_of({{0, 7}, {29, 1}, {28, 3}, {-30, 41}});
  EXPECT_EQ(bottom.clip_code, -30);
  EXPECT_EQ(bottom.clip_count, 41);
  EXPECT_EQ(bottom.clip_first, 11);
}

TEST(CodeWatch, APileGrowsOverBlocksAndKeepsItsLevel) {
  CodeWatch watch;
  EXPECT_FALSE(close_block(watch, {{-29, 1}, {30, 14}}).clips);  // 13 more than one
  EXPECT_TRUE(close_block(watch, {{-29, 1}, {30, 13}}).clips);   // 25
  EXPECT_TRUE(close_block(watch, {{-29, 1}, {30, 2}}).clips) << "at a known level at once";
  EXPECT_FALSE(close_block(watch, {{-29, 1}, {30, 1}}).clips) << "one is no pile";
  EXPECT_TRUE(close_block(watch, {{-29, 1}, {28, 2}}).clips);
  EXPECT_FALSE(close_block(watch, {{-29, 1}, {27, 2}}).clips) << "two codes off are the same level";
}

TEST(CodeWatch, DeadBitsExplainAPile) {
  const CodeVerdict verdict = verdict_of({{-28, 1}, {32, 60}});
  EXPECT_EQ(verdict.dead_bits, 2);
  EXPECT_FALSE(verdict.clips);
}

/// A walk that moves by so many codes a sample, now and then held.
class Walk {
 public:
  explicit Walk(const RepeatWatch::Codes& moves) : moves_{moves} {}
  bool go(RepeatWatch& watch) {
    for (std::size_t c = 0; c < kChannels; ++c) at_[c] += moves_[c];
    return watch.update(0, at_);
  }
  bool hold(RepeatWatch& watch) const { return watch.update(0, at_); }

 private:
  RepeatWatch::Codes at_{};
  RepeatWatch::Codes moves_;
};

TEST(RepeatWatch, AllowsEightAndFindsTheNinth) {
  RepeatWatch watch{20};
  Walk walk{{2, -2, 2}};
  for (int i = 0; i < 9; ++i) {
    EXPECT_FALSE(watch.found()) << i;
    for (int k = 0; k < 30; ++k) EXPECT_FALSE(walk.go(watch));
    EXPECT_TRUE(walk.hold(watch));
  }
  EXPECT_TRUE(watch.found());
  EXPECT_EQ(watch.excess(), 9.0);
  watch.forget();
  EXPECT_NEAR(watch.excess(), 9.0 * 0.975, 1e-12);
  EXPECT_FALSE(watch.found());
  watch.clear();
  EXPECT_EQ(watch.excess(), 0.0);
}

TEST(RepeatWatch, SaysNothingWhereTheCarHardlyMoves) {
  RepeatWatch watch{20};
  Walk slow{{2, -2, 1}};
  for (int i = 0; i < 90; ++i) {
    static_cast<void>(slow.go(watch));
    EXPECT_FALSE(slow.hold(watch));
  }
  EXPECT_EQ(watch.excess(), 0.0);
}

TEST(RepeatWatch, NeedsTwoSamplesBefore) {
  RepeatWatch watch{20};
  EXPECT_FALSE(watch.update(0, {9, 9, 9}));
  EXPECT_FALSE(watch.update(0, {1, 1, 1}));
  EXPECT_TRUE(watch.update(0, {1, 1, 1}));
  watch.restart();
  EXPECT_FALSE(watch.update(0, {1, 1, 1}));
  EXPECT_FALSE(watch.update(0, {9, 9, 9}));
  EXPECT_FALSE(watch.update(0, {1, 1, 1})) << "that of the sample before the last";
  EXPECT_EQ(watch.excess(), 0.0);
  watch.restart();
  EXPECT_FALSE(watch.update(0, {9, 9, 9}));
  EXPECT_FALSE(watch.update(0, {9, 9, 9})) << "whether it moved is not known";
}

// To and fro: each sample is that before the last one, which is chance.
TEST(RepeatWatch, TakesOffWhatChanceExplains) {
  RepeatWatch watch{20};
  for (int i = 0; i < 12; ++i) static_cast<void>(watch.update(0, {i % 2 * 7, i % 2 * 7, 0}));
  EXPECT_EQ(watch.excess(), -10.0);
  RepeatWatch some{20};
  Walk walk{{2, -2, 2}};
  const auto repeat = [&](int count) {
    for (int i = 0; i < count; ++i) {
      for (int k = 0; k < 30; ++k) static_cast<void>(walk.go(some));
      static_cast<void>(walk.hold(some));
    }
  };
  static_cast<void>(some.update(0, {100, 100, 100}));
  static_cast<void>(some.update(0, {200, 200, 200}));
  static_cast<void>(
      some.update(0, {100, 100, 100}));  // one by chance: 5 + 4 sqrt(2) + 5 are allowed
  repeat(15);
  EXPECT_FALSE(some.found());
  repeat(1);
  EXPECT_TRUE(some.found());
  EXPECT_EQ(some.excess(), 15.0);
}

// Each channel holds its code for half of the time by itself: an eighth of the samples repeats.
TEST(RepeatWatch, ExpectsRepetitionsOfChannelsThatAreSlowByThemselves) {
  RepeatWatch watch{20};
  RepeatWatch::Codes codes{};
  int repeats = 0;
  for (int i = 0; i < 800; ++i) {
    for (std::size_t c = 0; c < kChannels; ++c)
      if ((i >> c & 1) == 0) codes[c] += 7;
    repeats += watch.update(i, codes) ? 1 : 0;
  }
  EXPECT_GE(repeats, 99);
  EXPECT_FALSE(watch.found()) << "9 + 2 (100 - 2) are allowed";
}

// After a move of 30 codes; the fourth is told at once, one alone and much later is not.
TEST(RepeatWatch, FindsThreeCloseTogetherAfterFastMoves) {
  RepeatWatch watch{20};
  std::int64_t tick = 0;
  std::int64_t code = 0;
  const auto go = [&](int samples) {
    for (int i = 0; i < samples; ++i)
      static_cast<void>(watch.update(tick++, {code += 10, 10 - code, code / 2}));
  };
  const auto hold = [&] { static_cast<void>(watch.update(tick++, {code, 10 - code, code / 2})); };
  go(10);
  hold();
  go(25);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(watch.found()) << i << ": the first was too long before";
    hold();
    go(19);
  }
  EXPECT_TRUE(watch.found());
  EXPECT_EQ(watch.excess(), 3.0);
  EXPECT_EQ(watch.first_tick(), 36);
  watch.clear();
  EXPECT_FALSE(watch.found());
  hold();
  EXPECT_TRUE(watch.found());
  EXPECT_EQ(watch.first_tick(), 96);
  watch.clear();
  go(30);
  hold();
  EXPECT_FALSE(watch.found());
}

// A car that brakes: what moved fast before says nothing of how often slow codes repeat.
TEST(RepeatWatch, CountsChanceBlockByBlock) {
  RepeatWatch watch{20};
  RepeatWatch::Codes codes{};
  int i = 0;
  for (int block = 0; block < 20; ++block) {
    for (int k = 0; k < 400; ++k) {
      for (std::int64_t& code : codes) code += 9;
      static_cast<void>(watch.update(i++, codes));
    }
    watch.forget();
  }
  for (int k = 0; k < 400; ++k, ++i) {
    for (std::size_t c = 0; c < kChannels; ++c)
      if ((i >> c & 1) == 0) codes[c] += 7;
    static_cast<void>(watch.update(i, codes));
  }
  EXPECT_GT(watch.excess(), 45.0);
  EXPECT_FALSE(watch.found()) << "50 of 400 by chance: 9 + 2 (50 - 2) are allowed";
}

constexpr std::int64_t kSecondSamples = 10;

/// Seconds at these levels; the first jump, and the second that had just ended when it was told.
struct Told {
  LevelJump jump;
  std::size_t second;
};
std::optional<Told> jump_of(const std::vector<double>& levels) {
  LevelWatch watch{kSecondSamples};
  std::int64_t tick = 0;
  LevelJump jump;
  for (std::size_t s = 0; s < levels.size(); ++s)
    for (std::int64_t i = 0; i < kSecondSamples; ++i)
      if (watch.update(tick++, levels[s] + (i % 2 == 0 ? 0.1 : -0.1), jump)) return Told{jump, s};
  return std::nullopt;
}

std::vector<double> step_at(std::size_t second, double size) {
  std::vector<double> levels(60, 2.0);
  for (std::size_t s = second; s < levels.size(); ++s) levels[s] += size;
  return levels;
}

TEST(LevelWatch, SeesAJumpOfAQuarter) {
  EXPECT_FALSE(jump_of(step_at(40, 0.24)));
  for (const double size : {0.26, -0.26, 3.0, 2e4}) {
    const auto told = jump_of(step_at(40, size));
    ASSERT_TRUE(told) << size;
    EXPECT_NEAR(told->jump.size_mps2, size, 1e-9);
    EXPECT_NEAR(static_cast<double>(told->jump.tick), 400.0, 7.0);
    EXPECT_EQ(told->second, 49U) << "five seconds after it was largest";
  }
}

// Eleven seconds make a difference; twelve differences are needed.
TEST(LevelWatch, NeedsTwelveDifferences) {
  EXPECT_TRUE(jump_of(step_at(16, 0.3)));
  EXPECT_FALSE(jump_of(step_at(15, 0.3))) << "the twelfth has four fifths of it";
}

/// Six seconds up, six down: half of the differences are above 1.2 of the height.
std::vector<double> uneven(double height, double jump) {
  std::vector<double> levels = step_at(48, jump);
  for (std::size_t s = 0; s < levels.size(); ++s) levels[s] += s % 12 < 6 ? height : -height;
  return levels;
}

TEST(LevelWatch, AJumpIsTenDeviationsOfTheDifferencesBefore) {
  EXPECT_FALSE(jump_of(uneven(0.1, 0.0)));
  EXPECT_FALSE(jump_of(uneven(0.1, 1.4))) << "14.8 times 0.12 is 1.78";
  EXPECT_TRUE(jump_of(uneven(0.1, 2.2)));
}

TEST(LevelWatch, ARestartBeginsASecond) {
  LevelWatch watch{kSecondSamples};
  LevelJump jump;
  for (std::int64_t tick = 0; tick < 600; ++tick) {
    EXPECT_FALSE(watch.update(tick, 20.0, jump)) << tick;
    if (tick == 304) watch.restart();
  }
}

}  // namespace
}  // namespace dampline
