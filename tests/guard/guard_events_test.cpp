// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/guard/code_feed.hpp"

namespace dampline {
namespace {

Codes::Change raised(std::array<double, 3> by_mps2) {
  return [=](Sample& sample) {
    for (std::size_t c = 0; c < kChannels; ++c) sample.accel_mps2[c] += by_mps2[c];
  };
}

TEST(GuardCodes, NamesTheChannelWhoseZeroJumped) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    Codes codes;
    codes.run(9000);
    std::array<double, 3> jump{};
    jump[c] = -0.8;
    codes.run(9000, raised(jump));
    ASSERT_EQ(codes.faults().size(), 1U);
    const Fault& fault = codes.faults()[0];
    EXPECT_EQ(fault.kind, FaultKind::kDcJump);
    EXPECT_EQ(fault.channel, channel_of(c));
    EXPECT_NEAR(fault.size, -0.8, 0.03);
    EXPECT_NEAR(fault.time_s, 30.0, 0.7);
    EXPECT_TRUE(codes.spoils(FaultKind::kDcJump, 9000));
    EXPECT_FALSE(codes.spoils(FaultKind::kDcJump, 9000 - 900));
    EXPECT_FALSE(codes.spoils(FaultKind::kDcJump, 9000 + 900));
  }
}

// A quarter of the largest, or 0.1 m/s^2: so much the jumps of all channels differ in a curve.
TEST(GuardCodes, TakesAJumpOfAllChannelsAlikeForTheTrack) {
  const auto faults_after = [](std::array<double, 3> jump) {
    Codes codes;
    codes.run(9000);
    codes.run(9000, raised(jump));
    return codes.faults().size();
  };
  EXPECT_EQ(faults_after({2.0, 1.6, 2.0}), 0U);
  EXPECT_EQ(faults_after({2.0, 1.4, 2.0}), 3U);
  EXPECT_EQ(faults_after({-2.0, -1.6, -2.0}), 0U);
  EXPECT_EQ(faults_after({0.35, 0.35, 0.28}), 0U);
  EXPECT_EQ(faults_after({0.45, 0.45, 0.29}), 3U);
  EXPECT_EQ(faults_after({2.0, 2.0, 0.0}), 2U);
  EXPECT_EQ(faults_after({2.0, 2.0, -2.0}), 3U);
}

// The channels of a curve are some three seconds apart at most.
TEST(GuardCodes, JumpsTogetherAreWithinSomeThreeSeconds) {
  for (const auto& [later_s, faults] : {std::pair{2.5, 0U}, std::pair{4.0, 3U}}) {
    Codes codes;
    codes.run(24'000, [later = 9000 + std::llround(later_s * 300.0)](Sample& sample) {
      if (sample.tick >= 9000) sample.accel_mps2[0] += 0.6;
      if (sample.tick >= later) {
        sample.accel_mps2[1] += 0.6;
        sample.accel_mps2[2] += 0.6;
      }
    });
    EXPECT_EQ(codes.faults().size(), faults) << later_s;
  }
}

TEST(GuardCodes, TakesTheEndOfACurveForTheTrackToo) {
  Codes codes;
  for (const double cant_mps2 : {0.0, 0.6, 0.0, -0.6})
    codes.run(9000, raised({cant_mps2, cant_mps2, cant_mps2}));
  EXPECT_TRUE(codes.faults().empty());
}

TEST(GuardCodes, TellsAJumpAtTheEndOfTheRecordToo) {
  Codes codes;
  codes.run(9000);
  codes.run(12 * 300, raised({0.8, 0.0, 0.0}));
  EXPECT_TRUE(codes.faults().empty()) << "the others may have it too";
  codes.guard().finish();
  EXPECT_EQ(codes.faults().size(), 1U);
}

// Eight samples are bridged; after more, what was is forgotten.
TEST(GuardCodes, AJumpAcrossAPauseIsNone) {
  for (const auto& [missing, named] : {std::pair{8, true}, std::pair{9, false}}) {
    Codes codes;
    codes.run(9000);
    codes.skip(missing);
    codes.run(9000, raised({0.8, 0.0, 0.0}));
    EXPECT_EQ(codes.find(FaultKind::kDcJump) != nullptr, named) << missing;
  }
}

// Stamps that run by another rate than the declared one, for three blocks of ten seconds.
TEST(GuardCodes, NamesARateThatTheStampsContradict) {
  for (const auto& [rate_hz, seconds, told_s] :
       {std::tuple{300.85, 90, 0.0}, std::tuple{300.95, 59, 0.0}, std::tuple{300.95, 61, 50.0},
        std::tuple{299.05, 61, 50.0}, std::tuple{303.0, 29, 0.0}, std::tuple{303.0, 31, 20.0},
        std::tuple{30'000.0, 31, 20.0}}) {
    Codes codes;
    codes.run(seconds * 300, [r = rate_hz](Sample& sample) {
      sample.time_ns = std::llround(1e9 * static_cast<double>(sample.tick) / r);
    });
    const Fault* const fault = codes.find(FaultKind::kWrongSampleRate);
    ASSERT_EQ(fault != nullptr, told_s > 0.0) << rate_hz;
    if (fault == nullptr) continue;
    EXPECT_NEAR(fault->size, rate_hz, 0.01);
    EXPECT_EQ(fault->channel, FaultChannel::kAll);
    EXPECT_EQ(fault->time_s, told_s);
  }
  for (const std::int64_t burst : {20, 30, 31, 37, 43, 48}) {  // stamps of a gateway's bursts
    Codes codes;
    codes.run(90'000, [burst](Sample& sample) {
      sample.time_ns =
          std::llround(1e9 / 300.0 * static_cast<double>((sample.tick / burst + 1) * burst));
    });
    EXPECT_EQ(codes.find(FaultKind::kWrongSampleRate), nullptr) << burst;
  }
  Codes none;
  none.run(12'100, [](Sample& sample) { sample.time_ns = 0; });
  EXPECT_TRUE(none.faults().empty()) << "no stamps";
}

Codes::Change spikes(std::size_t channel, const std::vector<std::int64_t>& ticks) {
  return [=](Sample& sample) {
    for (const std::int64_t tick : ticks)
      if (sample.tick == tick) sample.accel_mps2[channel] += Codes::code(2000);
  };
}

TEST(GuardCodes, AWrongSampleIsKnownTwoSecondsLater) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    Codes codes;
    codes.run(590, spikes(c, {300}));
    WrongSample wrong;
    EXPECT_FALSE(codes.guard().next_wrong_sample(wrong));
    codes.run(20);
    ASSERT_TRUE(codes.guard().next_wrong_sample(wrong)) << c;
    EXPECT_EQ(wrong.tick, 300);
    EXPECT_EQ(wrong.channel, c);
    EXPECT_FALSE(codes.guard().next_wrong_sample(wrong)) << "once";
  }
}

TEST(GuardCodes, ThreeWrongSamplesAreSpikes) {
  Codes two;
  two.run(12'000, spikes(2, {1000, 2310}));
  EXPECT_TRUE(two.faults().empty());
  EXPECT_TRUE(two.spoils(FaultKind::kSpikes, 1000)) << "all the same";
  Codes three;
  three.run(12'000, spikes(2, {1000, 2310, 7020}));
  ASSERT_EQ(three.faults().size(), 1U);
  const Fault& fault = three.faults()[0];
  EXPECT_EQ(fault.kind, FaultKind::kSpikes);
  EXPECT_EQ(fault.channel, FaultChannel::kWheelset2);
  EXPECT_EQ(fault.count, 3U);
  EXPECT_NEAR(fault.size, 2000 * kStepMps2, 1.0);
  EXPECT_NEAR(fault.time_s, 1000 / 300.0, 1e-9);
  EXPECT_NEAR(fault.last_s, 7020 / 300.0, 1e-9);
  WrongSample wrong;
  for (const std::int64_t tick : {1000, 2310, 7020}) {
    ASSERT_TRUE(three.guard().next_wrong_sample(wrong));
    EXPECT_EQ(wrong.tick, tick);
    EXPECT_EQ(wrong.channel, 2U);
  }
  EXPECT_FALSE(three.guard().next_wrong_sample(wrong));
}

TEST(GuardCodes, KeepsTheNewestSixteenWrongSamples) {
  std::vector<std::int64_t> ticks;
  std::int64_t at = 900;
  for (std::int64_t i = 0; i < 20; ++i) ticks.push_back(at += 650 + 250 * (i * 7 % 5));
  Codes codes;
  codes.run(ticks.back() + 1500, spikes(0, ticks));
  std::vector<std::int64_t> found;
  for (WrongSample wrong; codes.guard().next_wrong_sample(wrong);) found.push_back(wrong.tick);
  ASSERT_EQ(found.size(), 16U);
  EXPECT_EQ(found.front(), ticks[4]);
  EXPECT_EQ(found.back(), ticks[19]);
}

TEST(GuardCodes, SpikesInARhythmAreImpacts) {
  std::vector<std::int64_t> ticks;
  for (std::int64_t i = 0; i < 40; ++i) ticks.push_back(900 + 150 * i);
  Codes codes;
  codes.run(12'000, spikes(1, ticks));
  EXPECT_EQ(codes.find(FaultKind::kSpikes), nullptr);
  EXPECT_EQ(codes.guard().inputs().impacts[1], 40U);
}

/// Blows that ring for some samples.
Codes::Change blows(std::size_t channel, std::int64_t every) {
  return [=](Sample& sample) {
    const double since = static_cast<double>(sample.tick % every - 90);
    if (since >= 0.0 && since < 15.0)
      sample.accel_mps2[channel] +=
          Codes::code(2000) * std::exp(-0.2 * since) * std::cos(1.5 * since);
  };
}

TEST(GuardCodes, CountsImpactsOfEachChannel) {
  Codes codes;
  codes.run(12'300, blows(0, 601));
  EXPECT_TRUE(codes.faults().empty());
  EXPECT_EQ(codes.guard().inputs().impacts[1], 0U);
  EXPECT_NEAR(static_cast<double>(codes.guard().inputs().impacts[0]), 20.0, 1.0);
}

TEST(GuardCodes, ABitThatDoesNotMoveIsALossWhereTheStepIsDeclared) {
  const auto coarse = [](Sample& sample) {
    for (double& accel : sample.accel_mps2)
      accel = 4.0 * kStepMps2 * std::round(accel / (4.0 * kStepMps2));
  };
  Codes codes;
  codes.run(3001, coarse);
  ASSERT_EQ(codes.faults().size(), 3U);
  for (std::size_t c = 0; c < kChannels; ++c) {
    EXPECT_EQ(codes.faults()[c].kind, FaultKind::kResolutionLoss);
    EXPECT_EQ(codes.faults()[c].channel, channel_of(c));
    EXPECT_NEAR(codes.faults()[c].size, 4.0 * kStepMps2, 1e-12);
    EXPECT_EQ(codes.faults()[c].time_s, 0.0);
  }
  EXPECT_TRUE(codes.spoils(FaultKind::kResolutionLoss, 10));
  EXPECT_TRUE(codes.spoils(FaultKind::kResolutionLoss, 3000));
  EXPECT_FALSE(codes.spoils(FaultKind::kResolutionLoss, 3300));
  Codes undeclared{GuardConfig{}};
  undeclared.run(9000, coarse);
  EXPECT_TRUE(undeclared.faults().empty()) << "its step is what it shows";
}

TEST(GuardCodes, NamesTheLevelAtWhichAChannelClips) {
  Codes codes;
  codes.run(6001, [](Sample& sample) {
    sample.accel_mps2[0] = std::max(sample.accel_mps2[0], Codes::code(-70));
  });
  const Fault* const fault = codes.find(FaultKind::kClipping);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kFrame);
  EXPECT_NEAR(fault->size, 70 * kStepMps2, 1e-12);
  EXPECT_NEAR(static_cast<double>(fault->count), 6000 * 0.0408, 40.0) << "samples there";
  EXPECT_LT(fault->time_s, 1.0);
  EXPECT_TRUE(codes.spoils(FaultKind::kClipping, 5900));
}

// What nobody declared is learnt in ten seconds, and what was counted before is forgotten.
TEST(GuardCodes, LearnsItsStepAndCountsByIt) {
  Codes codes{GuardConfig{}};
  const auto clip = [](Sample& sample) {
    sample.accel_mps2[1] = std::min(sample.accel_mps2[1], Codes::code(70));
  };
  codes.run(3001, clip);
  EXPECT_TRUE(codes.faults().empty());
  codes.run(6000, clip);
  const Fault* const fault = codes.find(FaultKind::kClipping);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kWheelset1);
  EXPECT_NEAR(fault->size, 70 * kStepMps2, 1e-9);
  EXPECT_GT(fault->time_s, 10.0);
  EXPECT_EQ(codes.faults().size(), 1U);
  codes.run(6000, spikes(0, {9300, 10'100, 11'800, 12'999}));
  const Fault* const spiked = codes.find(FaultKind::kSpikes);
  ASSERT_NE(spiked, nullptr);
  EXPECT_NEAR(spiked->size, 2000 * kStepMps2, 1.0);
}

TEST(GuardCodes, RepeatedSamplesAreTheirExcess) {
  std::array<double, 3> last{};
  Codes codes;
  codes.run(3001, [&](Sample& sample) {
    if (sample.tick > 500 && sample.tick % 100 == 0 && sample.tick < 1700) sample.accel_mps2 = last;
    last = sample.accel_mps2;
  });
  const Fault* const fault = codes.find(FaultKind::kRepeatedSamples);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->channel, FaultChannel::kAll);
  EXPECT_EQ(fault->size, 10.0) << "of eleven; in one a channel had not moved";
  EXPECT_EQ(fault->time_s, 600 / 300.0) << "the first of them";
}

TEST(GuardCodes, RepeatedSamplesAreToldAgainWhereTheyCameAgain) {
  std::array<double, 3> last{};
  Codes codes;
  codes.run(9001, [&](Sample& sample) {
    const std::int64_t since = sample.tick % 6000 - 600;
    if (since >= 0 && since < 900 && since % 100 == 0) sample.accel_mps2 = last;
    last = sample.accel_mps2;
  });
  const Fault* const fault = codes.find(FaultKind::kRepeatedSamples);
  ASSERT_NE(fault, nullptr);
  EXPECT_EQ(fault->count, 14U) << "three together, and each of six more";
  EXPECT_EQ(fault->size, 18.0);
  EXPECT_EQ(fault->time_s, 600 / 300.0);
  EXPECT_EQ(fault->last_s, 7400 / 300.0);
}

// Five seconds on either side: a level that was clipped or held is none.
TEST(GuardCodes, TakesAJumpBesideAChannelThatClipsForNone) {
  for (const auto& [off_s, named] : {std::pair{-6.5, true}, std::pair{-4.5, false},
                                     std::pair{4.5, false}, std::pair{6.5, true}}) {
    Codes codes;
    codes.run(20'000, [at = 9000 + std::llround(off_s * 300.0)](Sample& sample) {
      if (sample.tick >= 9000) sample.accel_mps2[0] += 0.8;
      if (sample.tick == at) sample.saturated = 1;
    });
    EXPECT_EQ(codes.find(FaultKind::kDcJump) != nullptr, named) << off_s;
  }
}

TEST(GuardCodes, JudgesTheRestOfTheRecord) {
  Codes codes;
  const auto coarse = [](Sample& sample) {
    sample.accel_mps2[1] = 2.0 * kStepMps2 * std::round(sample.accel_mps2[1] / (2.0 * kStepMps2));
  };
  codes.run(2000, coarse);
  EXPECT_TRUE(codes.faults().empty());
  codes.guard().finish();
  EXPECT_EQ(codes.faults().size(), 1U);
}

}  // namespace
}  // namespace dampline
