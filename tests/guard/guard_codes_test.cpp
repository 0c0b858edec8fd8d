// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/guard/code_feed.hpp"

namespace dampline {
namespace {

TEST(GuardConfig, HasItsLimits) {
  const auto ok = [](const std::function<void(GuardConfig&)>& change) {
    GuardConfig config;
    change(config);
    return Guard::check(config).ok();
  };
  const double infinite = std::numeric_limits<double>::infinity();
  for (const double rate_hz : {50.0, 300.0, 2000.0})
    EXPECT_TRUE(ok([&](GuardConfig& c) { c.sample_rate_hz = rate_hz; })) << rate_hz;
  for (const double rate_hz : {49.9, 2000.1, std::nan("")})
    EXPECT_FALSE(ok([&](GuardConfig& c) { c.sample_rate_hz = rate_hz; })) << rate_hz;
  for (const auto& [value, fine] :
       {std::pair{0.0, true}, std::pair{0.1, true}, std::pair{-0.1, false},
        std::pair{infinite, false}, std::pair{std::nan(""), false}}) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.step_mps2[c] = v; }), fine);
      EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.noise_mps2[c] = v; }), fine);
    }
    EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.wheelbase_m = v; }), fine);
    EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.speed_mps = v; }), fine);
    EXPECT_EQ(ok([&, v = value](GuardConfig& g) { g.anti_alias.corner_hz = v; }), fine);
  }
  EXPECT_TRUE(ok([](GuardConfig& g) { g.anti_alias.order = 1; }));
  EXPECT_FALSE(ok([](GuardConfig& g) { g.anti_alias.order = 0; }));
}

TEST(GuardCodes, OfNormalCodesNothingIsWrong) {
  Codes codes;
  codes.run(60 * 300);
  codes.guard().finish();
  EXPECT_TRUE(codes.faults().empty());
  EXPECT_EQ(codes.guard().inputs().impacts, (std::array<std::uint64_t, 3>{}));
  WrongSample wrong;
  EXPECT_FALSE(codes.guard().next_wrong_sample(wrong));
}

TEST(GuardCodes, ThreeSamplesAtFullScaleAreClipping) {
  Codes codes;
  codes.run(1000);
  const auto full = [](Sample& sample) {
    sample.saturated = 0b010;
    sample.accel_mps2[1] = -3.0;
  };
  codes.run(1, full);
  codes.run(700);
  codes.run(1, full);
  EXPECT_TRUE(codes.faults().empty());
  EXPECT_TRUE(codes.spoils(FaultKind::kClipping, 1000)) << "known at once";
  EXPECT_FALSE(codes.spoils(FaultKind::kClipping, 600));
  codes.run(500);
  codes.run(1, full);
  ASSERT_EQ(codes.faults().size(), 1U);
  EXPECT_EQ(codes.faults()[0].kind, FaultKind::kClipping);
  EXPECT_EQ(codes.faults()[0].channel, FaultChannel::kWheelset1);
  EXPECT_EQ(codes.faults()[0].time_s, 1000 / 300.0) << "of the first";
  EXPECT_EQ(codes.faults()[0].count, 3U);
  EXPECT_EQ(codes.faults()[0].size, 3.0);
  const double last_s = static_cast<double>(codes.tick()) / 300.0;
  codes.run(1, full);
  EXPECT_EQ(codes.faults()[0].count, 4U);
  EXPECT_EQ(codes.faults()[0].last_s, last_s);
}

TEST(GuardCodes, CountsSamplesThatTicksMiss) {
  for (const std::int64_t missing : {1, 8, 9, 5000}) {
    Codes codes;
    codes.run(1000);
    codes.skip(missing);
    codes.run(1000);
    ASSERT_EQ(codes.faults().size(), 1U) << missing;
    const Fault& fault = codes.faults()[0];
    EXPECT_EQ(fault.kind, FaultKind::kLostSamples);
    EXPECT_EQ(fault.channel, FaultChannel::kAll);
    EXPECT_EQ(fault.size, static_cast<double>(missing));
    EXPECT_EQ(fault.count, 1U);
    EXPECT_EQ(fault.time_s, 1000 / 300.0);
    EXPECT_NE(codes.guard().spoilt(1000, 1000) & FaultLog::kGapBit, 0U);
    EXPECT_EQ(codes.guard().spoilt(0, 800), 0U);
  }
}

TEST(GuardCodes, CountsSamplesThatCameIncomplete) {
  Codes codes;
  codes.run(100);
  codes.run(2, [](Sample& sample) { sample.lost = true; });
  codes.run(100);
  ASSERT_EQ(codes.faults().size(), 1U);
  EXPECT_EQ(codes.faults()[0].size, 2.0);
  EXPECT_EQ(codes.faults()[0].count, 2U);
  EXPECT_EQ(codes.faults()[0].time_s, 100 / 300.0);
}

// What is no number is the screen's: those samples came.
TEST(GuardCodes, SamplesThatAreNoNumberAreNotLost) {
  const auto none = [](Sample& sample) { sample.accel_mps2[2] = std::nan(""); };
  Codes codes;
  codes.run(1000);
  codes.run(3, none);
  codes.run(1000);
  EXPECT_TRUE(codes.faults().empty());
  codes.run(2, none);
  codes.skip(3);
  codes.run(1000);
  ASSERT_EQ(codes.faults().size(), 1U);
  EXPECT_EQ(codes.faults()[0].size, 3.0);
  codes.skip(2);
  codes.run(10);
  EXPECT_EQ(codes.faults()[0].size, 5.0) << "counted for their own gap alone";
}

TEST(GuardCodes, IgnoresSamplesWhoseTicksDoNotRise) {
  Codes codes;
  codes.run(1000);
  codes.skip(-50);
  codes.run(50, [](Sample& sample) { sample.saturated = 7; });
  codes.run(100);
  EXPECT_TRUE(codes.faults().empty());
}

/// Holds a channel at one code, the next one moves to and fro by so many, the other one a little.
Codes::Change held(std::size_t channel, std::int64_t next_moves = 1000) {
  return [=](Sample& sample) {
    std::array<std::int64_t, kChannels> codes{};
    codes[channel] = 17;
    codes[(channel + 1) % kChannels] = sample.tick % 2 * next_moves;
    codes[(channel + 2) % kChannels] = next_moves > 100 && sample.tick % 3 == 0 ? 9 : 0;
    for (std::size_t c = 0; c < kChannels; ++c) sample.accel_mps2[c] = Codes::code(codes[c]);
  };
}

TEST(GuardCodes, AChannelIsStuckFromEightySamplesOn) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    Codes codes;
    codes.run(1000);
    codes.run(79, held(c));
    codes.run(700);
    EXPECT_EQ(codes.find(FaultKind::kStuckChannel), nullptr);
    const std::int64_t first = codes.tick();
    codes.run(79, held(c));
    EXPECT_EQ(codes.find(FaultKind::kStuckChannel), nullptr);
    codes.run(1, held(c));
    const Fault* fault = codes.find(FaultKind::kStuckChannel);
    ASSERT_NE(fault, nullptr);
    EXPECT_EQ(fault->channel, channel_of(c));
    EXPECT_EQ(fault->time_s, static_cast<double>(first) / 300.0);
    EXPECT_EQ(fault->size, 80 / 300.0);
    EXPECT_TRUE(codes.spoils(FaultKind::kStuckChannel, first)) << "back to the first";
    codes.run(520, held(c));
    EXPECT_TRUE(codes.spoils(FaultKind::kStuckChannel, codes.tick() - 1));
    codes.run(1);
    EXPECT_EQ(fault->size, 2.0) << "of all it was";
    EXPECT_EQ(fault->count, 1U);
  }
}

TEST(GuardCodes, AFasterChannelIsStuckAfterAFifthOfASecond) {
  Codes codes{coded(1000.0)};
  codes.run(1000);
  codes.run(199, held(0));
  EXPECT_EQ(codes.find(FaultKind::kStuckChannel), nullptr);
  codes.run(1, held(0));
  EXPECT_NE(codes.find(FaultKind::kStuckChannel), nullptr);
}

TEST(GuardCodes, AChannelIsStuckWhereTheOthersSpanMoreThanEightCodes) {
  for (const auto& [span, stuck] : {std::pair{8, false}, std::pair{9, true}}) {
    Codes codes;
    codes.run(1000);
    codes.run(300, held(0, span));
    const Fault* const fault = codes.find(FaultKind::kStuckChannel);
    EXPECT_EQ(fault != nullptr && fault->channel == FaultChannel::kFrame, stuck) << span;
  }
}

/// A channel that leaps to a code and holds it for some samples.
void leap(Codes& codes, std::int64_t code, int samples, std::int64_t others = 100) {
  codes.run(samples, [&](Sample& sample) {
    sample.accel_mps2[1] = Codes::code(code);
    sample.accel_mps2[0] = Codes::code(sample.tick % 2 * others);
    sample.accel_mps2[2] = 0.0;
  });
}

/// What three leaps make; ends of the range lie farther out.
const Fault* contact_of(Codes& codes, const std::vector<std::int64_t>& leaps, int samples,
                        std::int64_t others = 100) {
  codes.run(3000, [](Sample& sample) {
    if (sample.tick == 500) sample.accel_mps2[1] = Codes::code(3000);
    if (sample.tick == 900) sample.accel_mps2[1] = Codes::code(-3000);
  });
  codes.run(20, [](Sample& sample) {
    if (sample.tick % 3000 == 5) sample.accel_mps2[1] = Codes::code(3000);
    if (sample.tick % 3000 == 15) sample.accel_mps2[1] = Codes::code(-3000);
  });
  for (const std::int64_t code : leaps) {
    codes.run(100);
    codes.run(1, [](Sample& sample) { sample.accel_mps2[1] = 0.0; });
    leap(codes, code, samples, others);
    codes.run(1, [](Sample& sample) { sample.accel_mps2[1] = 0.0; });
  }
  codes.run(20);
  return codes.find(FaultKind::kStuckChannel);
}

TEST(GuardCodes, ThreeLeapsToOneCodeAreALooseContact) {
  Codes codes;
  const Fault* const fault = contact_of(codes, {1500, 1500, 1500}, 5);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kWheelset1);
  EXPECT_NEAR(fault->size, 5 / 300.0, 1e-12);
  EXPECT_EQ(fault->count, 1U);
  EXPECT_TRUE(codes.spoils(FaultKind::kStuckChannel, codes.tick() - 100));
  Codes two;
  EXPECT_EQ(contact_of(two, {1500, 1500}, 5), nullptr);
  Codes different;
  EXPECT_EQ(contact_of(different, {1500, 1600, 1500, 1600, 1500}, 5), nullptr);
  Codes other;
  EXPECT_EQ(contact_of(other, {1600, 1500, 1500}, 5), nullptr) << "two of one code";
  Codes brief;
  EXPECT_EQ(contact_of(brief, {1500, 1500, 1500}, 3), nullptr) << "three samples are motion";
  Codes four;
  EXPECT_NE(contact_of(four, {1500, 1500, 1500}, 4), nullptr);
  Codes end;
  EXPECT_EQ(contact_of(end, {3000, 3000, 3000}, 5), nullptr) << "the end of its range";
  Codes still;
  EXPECT_EQ(contact_of(still, {1500, 1500, 1500}, 5, 8), nullptr) << "nothing moves";
  Codes moved;
  EXPECT_NE(contact_of(moved, {1500, 1500, 1500}, 5, 9), nullptr);
}

// Second differences of these codes deviate by sqrt(6) 40 = 98: three of that, or 0.3 of it where
// the code is held for six samples.
TEST(GuardCodes, AContactLeapsByThreeDeviations) {
  for (const auto& [code, samples, named] : {std::tuple{260, 5, false}, std::tuple{330, 5, true},
                                             std::tuple{25, 6, false}, std::tuple{35, 6, true}}) {
    Codes codes;
    EXPECT_EQ(contact_of(codes, {code, code, code}, samples) != nullptr, named) << code;
  }
}

// Of a channel that hardly moves: six codes.
TEST(GuardCodes, AContactLeapsBySixCodesAtLeast) {
  for (const auto& [code, named] : {std::pair{5, false}, std::pair{7, true}}) {
    Codes codes;
    const auto quiet = [](Sample& sample) {
      const std::int64_t end = sample.tick % 900 == 5 ? 60 : sample.tick % 900 == 450 ? -60 : 0;
      sample.accel_mps2[1] = Codes::code(end != 0 ? end : sample.tick % 2);
    };
    codes.run(3050, quiet);
    codes.run(500, quiet);
    for (int i = 0; i < 3; ++i) {
      codes.run(100, quiet);
      leap(codes, code, 6);
    }
    codes.run(20, quiet);
    EXPECT_EQ(codes.find(FaultKind::kStuckChannel) != nullptr, named) << code;
  }
}

TEST(GuardCodes, AChannelIsACopyByNineTenthsOfItsCodes) {
  for (const auto& [every, copied] : {std::pair{8, false}, std::pair{13, true}}) {
    for (std::size_t c = 0; c < kChannels; ++c) {
      Codes codes;
      codes.run(6100, [&, e = every](Sample& sample) {
        if (sample.tick % e != 0) sample.accel_mps2[(c + 1) % 3] = sample.accel_mps2[c];
      });
      const Fault* const fault = codes.find(FaultKind::kIdenticalChannels);
      ASSERT_EQ(fault != nullptr, copied) << every;
      if (!copied) continue;
      EXPECT_EQ(fault->channel, c == 1 ? FaultChannel::kWheelsets : FaultChannel::kAll);
      EXPECT_EQ(fault->count, 2U) << "a block each";
      EXPECT_EQ(fault->time_s, 0.0);
    }
  }
}

TEST(GuardCodes, CopiesThatHardlyMoveTellNothing) {
  for (const auto& [moves, copied] : {std::pair{280, false}, std::pair{320, true}}) {
    Codes codes;
    codes.run(3001, [&, m = moves](Sample& sample) {
      const auto code = std::min<std::int64_t>(sample.tick, m) % 7 + 3;
      sample.accel_mps2[1] = sample.accel_mps2[2] = Codes::code(code);
      sample.accel_mps2[0] = 0.0;
    });
    EXPECT_EQ(codes.find(FaultKind::kIdenticalChannels) != nullptr, copied) << moves;
  }
}

}  // namespace
}  // namespace dampline
