// SPDX-License-Identifier: MIT
#include "dampline/sample/ticks.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace dampline {
namespace {

constexpr double kTickNs = 1e6;
constexpr std::int64_t kStartNs = 1'600'000'000'000'000'000;

std::int64_t at(double ticks) { return kStartNs + std::llround(ticks * kTickNs); }

TickLine line_at(std::int64_t frames, double period_range = 0.1) {
  TickLine line{1000.0, period_range};
  line.start(100, at(100.0));
  for (std::int64_t i = 1; i <= frames; ++i)
    line.update(100 + i, at(100.0 + static_cast<double>(i)));
  return line;
}

TEST(TickLine, IsTheNominalLineAtFirst) {
  const TickLine line = line_at(0);
  EXPECT_EQ(line.tick(), 100);
  EXPECT_NEAR(line.tick_at(at(107.25)), 107.25, 1e-6);
  EXPECT_NEAR(line.tick_at(at(99.5)), 99.5, 1e-6);
}

/// Gains of a least-squares line of n frames on place and period.
double place_gain(double n) { return 2.0 * (2.0 * n - 1.0) / (n * (n + 1.0)); }
double period_gain(double n) { return 6.0 / (n * (n + 1.0)); }

// The nominal period counts as sixteen frames; a memory of 128 is where gains stay.
TEST(TickLine, FollowsAsALeastSquaresLineOfItsFrames) {
  for (const auto& [frames, n] :
       {std::pair{0, 17.0}, std::pair{20, 37.0}, std::pair{112, 128.0}, std::pair{900, 128.0}}) {
    TickLine line = line_at(frames);
    const double next = 101.0 + frames;
    line.update(101 + frames, at(next + 0.3));
    EXPECT_NEAR(line.tick_at(at(next)), next - 0.3 * place_gain(n), 1e-3) << frames;
    const double period = 1.0 + 0.3 * period_gain(n);
    const double later = next + 0.3 * place_gain(n) + 50.0 * period;
    EXPECT_NEAR(line.tick_at(at(later)), next + 50.0, 1e-3) << frames;
  }
}

TEST(TickLine, AFrameMovesItByHalfATickAtMost) {
  for (const double late : {0.5, 5.0, 1e4}) {
    TickLine line = line_at(0);
    line.update(101, at(101.0 + late));
    EXPECT_NEAR(line.tick_at(at(101.0)), 101.0 - 0.5 * place_gain(17.0), 2e-3) << late;
  }
}

TEST(TickLine, AcrossAGapAnErrorIsThatOfSoManyPeriods) {
  TickLine line = line_at(0);
  line.update(110, at(110.4));
  const double place = 110.0 + 0.4 * place_gain(17.0);
  const double period = 1.0 + 0.04 * period_gain(17.0);
  EXPECT_NEAR(line.tick_at(at(place + 100.0 * period)), 210.0, 2e-3);
}

TEST(TickLine, KeepsItsPeriodNearTheNominalOne) {
  for (const auto& [step, period] : {std::pair{1.3, 1.0 / 0.9}, std::pair{0.7, 0.9}}) {
    TickLine line{1000.0, 0.1};
    line.start(0, kStartNs);
    for (std::int64_t i = 1; i < 400; ++i) line.update(i, at(step * static_cast<double>(i)));
    const double now = line.tick_at(line.time_ns());
    const double later = line.tick_at(line.time_ns() + std::llround(100.0 * period * kTickNs));
    EXPECT_NEAR(later - now, 100.0, 1e-3);
  }
}

TEST(TickLine, TellsWhetherATimeIsNearATick) {
  for (const double ahead : {1.0, 30.0}) {
    const TickLine line = line_at(40);
    const auto tick = static_cast<std::int64_t>(140.0 + ahead);
    for (const double off : {-0.59, 0.0, 0.59})
      EXPECT_TRUE(line.is_near(tick, at(140.0 + ahead + off), 0.6)) << ahead << ' ' << off;
    for (const double off : {-0.61, 0.61, 5.0})
      EXPECT_FALSE(line.is_near(tick, at(140.0 + ahead + off), 0.6)) << ahead << ' ' << off;
  }
}

TEST(TickLine, StartsAnywhereAnew) {
  TickLine line = line_at(5);
  line.update(106, at(106.3));
  line.start(7, at(50.0));
  EXPECT_EQ(line.tick(), 7);
  EXPECT_EQ(line.time_ns(), at(50.0));
  EXPECT_NEAR(line.tick_at(at(50.0)), 7.0, 1e-9);
}

/// A sequence that has counted in time up to tick 100.
CounterSequence counted(unsigned bits, std::uint64_t first = 0) {
  CounterSequence sequence{bits, 1000.0};
  sequence.start(0, first, at(0.0));
  for (std::uint64_t i = 1; i <= 100; ++i) {
    const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    const Placement placed = sequence.place((first + i) & mask, at(static_cast<double>(i)));
    EXPECT_EQ(placed.place, Place::kNext);
    EXPECT_EQ(placed.tick, static_cast<std::int64_t>(i));
  }
  return sequence;
}

TEST(CounterSequence, CountsWithAnyNumberOfBits) {
  for (const unsigned bits : {1U, 2U, 4U, 8U, 16U, 63U, 64U}) {
    EXPECT_EQ(counted(bits).newest(), 100);
    EXPECT_EQ(counted(bits, ~std::uint64_t{0} - 40).newest(), 100) << "across its wrap";
  }
}

// Two ticks for counters of 7 bits and more, half a tick for those of 5 and less.
TEST(CounterSequence, ACounterThatJumpsFitsItsTime) {
  for (const auto& [bits, tolerance] :
       {std::pair{4U, 0.5}, std::pair{6U, 1.0}, std::pair{7U, 2.0}, std::pair{8U, 2.0}}) {
    for (const double off : {-1.0, 1.0}) {
      CounterSequence near = counted(bits);
      EXPECT_EQ(near.place(105U % (1U << bits), at(105.0 + off * (tolerance - 0.05))).place,
                Place::kNext);
      EXPECT_EQ(near.newest(), 105);
      CounterSequence far = counted(bits);
      EXPECT_EQ(far.place(105U % (1U << bits), at(105.0 + off * (tolerance + 0.05))).place,
                Place::kOutOfStep)
          << bits;
      EXPECT_EQ(far.newest(), 100);
    }
  }
}

TEST(CounterSequence, TheNextOneMayBeFortyEightTicksLate) {
  CounterSequence late = counted(16);
  EXPECT_EQ(late.place(101, at(148.9)).place, Place::kNext);
  CounterSequence later = counted(16);
  EXPECT_EQ(later.place(101, at(149.1)).place, Place::kOutOfStep);
}

TEST(CounterSequence, WhatIsNotAfterTheNewestIsBehind) {
  for (const std::uint64_t counter : {100U, 99U, 53U}) {
    CounterSequence sequence = counted(8);
    const Placement placed = sequence.place(counter, at(100.3));
    EXPECT_EQ(placed.place, Place::kBehind) << counter;
    EXPECT_EQ(placed.tick, static_cast<std::int64_t>(counter));
    EXPECT_EQ(sequence.newest(), 100);
  }
  CounterSequence sequence = counted(8);
  EXPECT_EQ(sequence.place(52, at(100.3)).place, Place::kOutOfStep) << "48 ticks ago";
}

TEST(CounterSequence, FourFramesThatContinueEachOtherAreARestartedNode) {
  CounterSequence sequence = counted(16);
  for (std::uint64_t i = 0; i < 3; ++i) {
    const Placement placed = sequence.place(5000 + i, at(110.0 + static_cast<double>(i)));
    EXPECT_EQ(placed.place, Place::kOutOfStep);
    EXPECT_EQ(placed.streak, static_cast<int>(i) + 1);
  }
  const Placement placed = sequence.place(5003, at(113.0));
  EXPECT_EQ(placed.place, Place::kRealigned);
  EXPECT_EQ(placed.tick, 113) << "by its time";
  EXPECT_EQ(placed.streak, 4);
  EXPECT_EQ(sequence.place(5004, at(114.0)).place, Place::kNext);
  EXPECT_EQ(sequence.newest(), 114);
}

TEST(CounterSequence, ARestartedNodeComesAfterTheNewestWhateverItsTimes) {
  CounterSequence sequence = counted(16);
  for (std::uint64_t i = 0; i < 3; ++i)
    static_cast<void>(sequence.place(5000 + i, at(97.0 + static_cast<double>(i))));
  const Placement placed = sequence.place(5003, at(100.0));
  EXPECT_EQ(placed.place, Place::kRealigned);
  EXPECT_EQ(placed.tick, 101);
}

TEST(CounterSequence, FramesThatDoNotContinueEachOtherAreNone) {
  CounterSequence sequence = counted(16);
  for (int i = 0; i < 20; ++i) {
    const auto counter = static_cast<std::uint64_t>(5000 + 2 * i);
    EXPECT_EQ(sequence.place(counter, at(101.0 + i)).streak, 1);
  }
  EXPECT_EQ(sequence.newest(), 100);
  EXPECT_EQ(sequence.place(121, at(121.0)).place, Place::kNext);
}

TEST(CounterSequence, TheUsualCaseIsTheSame) {
  CounterSequence sequence = counted(8);
  EXPECT_FALSE(sequence.place_next(102, at(102.0)));
  EXPECT_FALSE(sequence.place_next(101, at(102.1))) << "more than a tick off";
  EXPECT_TRUE(sequence.place_next(101, at(101.9)));
  EXPECT_EQ(sequence.newest(), 101);
  static_cast<void>(sequence.place(200, at(102.0)));
  EXPECT_FALSE(sequence.place_next(102, at(102.0))) << "a streak has to end first";
  CounterSequence brief = counted(1);
  EXPECT_TRUE(brief.place_next(1, at(101.9)));
}

TEST(CounterSequence, IsBurstyWhileFourFramesOfLateCameFarOff) {
  CounterSequence sequence = counted(16);
  std::uint64_t counter = 100;
  const auto late = [&](double ticks) {
    ++counter;
    static_cast<void>(sequence.place(counter, at(static_cast<double>(counter) + ticks)));
  };
  for (int i = 0; i < 3; ++i) late(3.0);
  EXPECT_FALSE(sequence.is_bursty());
  late(3.0);
  EXPECT_TRUE(sequence.is_bursty());
  for (int i = 0; i < 95; ++i) late(0.3);
  EXPECT_TRUE(sequence.is_bursty());
  for (int i = 0; i < 5; ++i) late(0.3);
  EXPECT_FALSE(sequence.is_bursty());
}

// Of a burst the last frame is in time, and the line goes through it, from the first burst on, of
// which a part may be all that is seen.
TEST(CounterSequence, NumbersEachFrameOfBurstsOfAnyLength) {
  for (int burst = 2; burst <= 48; ++burst) {
    for (int seen = 1; seen <= burst; ++seen) {
      CounterSequence sequence{8, 1000.0};
      sequence.start(0, 0, at(burst));
      int wrong = 0;
      for (int i = 1; i < 1000; ++i) {
        const int whole = (i + burst - seen) / burst;
        const Placement placed =
            sequence.place(static_cast<std::uint64_t>(i) & 255U, at((whole + 1) * burst));
        wrong += placed.place == Place::kNext && placed.tick == i ? 0 : 1;
      }
      ASSERT_EQ(wrong, 0) << seen << " of the first " << burst;
      ASSERT_NEAR(sequence.line().tick_at(at(4000)) - sequence.line().tick_at(at(3000)), 1000.0,
                  1.0);
    }
  }
}

/// Ticks of readings at these times, in the order in which they are known.
std::vector<std::int64_t> numbered(const std::vector<double>& times, bool flush = true) {
  TimeSequence sequence{1000.0};
  sequence.start(0, at(0.0));
  std::vector<std::int64_t> ticks;
  const auto take = [&] {
    while (const auto reading = sequence.pop()) ticks.push_back(reading->tick);
  };
  for (const double time : times) {
    if (!sequence.push({.time_ns = at(time)})) ticks.push_back(-1);
    take();
  }
  if (flush) sequence.flush();
  take();
  return ticks;
}

using Ticks = std::vector<std::int64_t>;

TEST(TimeSequence, NumbersWhatComesInTime) {
  EXPECT_EQ(numbered({1.0, 2.05, 2.95, 4.0}, false), (Ticks{1, 2, 3, 4}));
}

TEST(TimeSequence, AReadingWithinAQuarterTickIsTheSame) {
  EXPECT_EQ(numbered({1.0, 1.2, 2.0}, false), (Ticks{1, -1, 2}));
  EXPECT_EQ(numbered({0.24, 0.26}, false), (Ticks{-1, 1}));
}

TEST(TimeSequence, ALateReadingWithWhichOthersCatchUpIsNext) {
  EXPECT_EQ(numbered({1.0, 3.7, 3.8, 4.0}, false), (Ticks{1, 2, 3, 4}));
}

TEST(TimeSequence, AGapIsOneAfterFourReadings) {
  EXPECT_EQ(numbered({1.0, 4.0, 5.0, 6.0}, false), (Ticks{1}));
  EXPECT_EQ(numbered({1.0, 4.0, 5.0, 6.0, 7.0}, false), (Ticks{1, 4, 5, 6, 7}));
  EXPECT_EQ(numbered({1.0, 4.0, 5.0}), (Ticks{1, 4, 5})) << "or at the end";
}

TEST(TimeSequence, APauseOfSixteenTicksIsAGapAtOnce) {
  EXPECT_EQ(numbered({1.0, 17.0}, false), (Ticks{1}));
  EXPECT_EQ(numbered({1.0, 18.0}, false), (Ticks{1, 18}));
}

}  // namespace
}  // namespace dampline
