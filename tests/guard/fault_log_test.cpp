// SPDX-License-Identifier: MIT
#include "dampline/guard/fault_log.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace dampline {
namespace {

constexpr double kTenHz = 10.0;
constexpr std::uint32_t bit(FaultKind kind) { return 1U << static_cast<unsigned>(kind); }

class FaultLogTest : public ::testing::Test {
 protected:
  std::unique_ptr<FaultLog> owner_{std::make_unique<FaultLog>(kTenHz)};
  FaultLog& log_{*owner_};
};

TEST_F(FaultLogTest, HasOneEntryForEachKindAndChannelInTheirOrder) {
  log_.report(FaultKind::kSpikes, FaultChannel::kFrame, 3.0, 2.0);
  log_.report(FaultKind::kSpikes, FaultChannel::kWheelset1, 4.0, 1.0, 5);
  log_.report(FaultKind::kSpikes, FaultChannel::kFrame, 6.0, -3.0, 2);
  ASSERT_EQ(log_.faults().size(), 2U);
  const Fault& first = log_.faults()[0];
  EXPECT_EQ(first.channel, FaultChannel::kFrame);
  EXPECT_EQ(first.time_s, 3.0) << "where it was first seen";
  EXPECT_EQ(first.last_s, 6.0);
  EXPECT_EQ(first.size, -3.0) << "the largest, whatever its sign";
  EXPECT_EQ(first.count, 3U);
  EXPECT_STREQ(first.unit, "m/s^2");
  EXPECT_EQ(log_.faults()[1].count, 5U);
  EXPECT_EQ(log_.faults()[1].last_s, 4.0);
}

TEST_F(FaultLogTest, KeepsTheLargestAndTheLatest) {
  log_.report(FaultKind::kDcJump, FaultChannel::kFrame, 9.0, -2.0);
  log_.report(FaultKind::kDcJump, FaultChannel::kFrame, 5.0, 1.0);
  EXPECT_EQ(log_.faults()[0].size, -2.0);
  EXPECT_EQ(log_.faults()[0].last_s, 9.0);
  log_.report(FaultKind::kDcJump, FaultChannel::kFrame, 6.0, 2.0);
  EXPECT_EQ(log_.faults()[0].size, -2.0) << "as large is not larger";
}

TEST_F(FaultLogTest, AddsUpSamplesThatWereLostOrRepeated) {
  for (const FaultKind kind : {FaultKind::kLostSamples, FaultKind::kRepeatedSamples}) {
    log_.report(kind, FaultChannel::kAll, 1.0, 2.0);
    log_.report(kind, FaultChannel::kAll, 2.0, 3.0);
    EXPECT_EQ(log_.find(kind, FaultChannel::kAll)->size, 5.0);
  }
}

TEST_F(FaultLogTest, FindsByKindAndChannel) {
  log_.report(FaultKind::kJitter, FaultChannel::kWheelsets, 1.0, 1e-4);
  EXPECT_TRUE(log_.has(FaultKind::kJitter));
  EXPECT_FALSE(log_.has(FaultKind::kClipping));
  EXPECT_NE(log_.find(FaultKind::kJitter, FaultChannel::kWheelsets), nullptr);
  EXPECT_EQ(log_.find(FaultKind::kJitter, FaultChannel::kFrame), nullptr);
  EXPECT_EQ(log_.find(FaultKind::kClipping, FaultChannel::kWheelsets), nullptr);
  EXPECT_EQ(log_.seconds(25), 2.5);
}

TEST_F(FaultLogTest, SpoilsTheSecondsThatHoldATick) {
  log_.spoil(FaultKind::kClipping, FaultChannel::kWheelset1, 29, 40);
  EXPECT_EQ(log_.spoilt(0, 19), 0U);
  EXPECT_EQ(log_.spoilt(20, 20), bit(FaultKind::kClipping));
  EXPECT_EQ(log_.spoilt(49, 49), bit(FaultKind::kClipping));
  EXPECT_EQ(log_.spoilt(50, 90), 0U);
  EXPECT_EQ(log_.spoilt(0, 20), bit(FaultKind::kClipping));
  EXPECT_EQ(log_.spoilt(49, 90), bit(FaultKind::kClipping));
  EXPECT_EQ(log_.spoilt(-30, -1), 0U);
  EXPECT_TRUE(log_.spoilt(FaultKind::kClipping, FaultChannel::kWheelset1, 35));
  EXPECT_FALSE(log_.spoilt(FaultKind::kClipping, FaultChannel::kWheelset2, 35));
  EXPECT_FALSE(log_.spoilt(FaultKind::kSpikes, FaultChannel::kWheelset1, 35));
  EXPECT_FALSE(log_.spoilt(FaultKind::kClipping, FaultChannel::kWheelset1, 19));
}

TEST_F(FaultLogTest, HoldsSeveralKindsOfASecond) {
  log_.spoil(FaultKind::kClipping, FaultChannel::kFrame, 31, 31);
  log_.spoil(FaultKind::kSpikes, FaultChannel::kFrame, 32, 32);
  log_.spoil(FaultKind::kDcJump, FaultChannel::kAll, 33, 33);
  EXPECT_EQ(log_.spoilt(30, 39),
            bit(FaultKind::kClipping) | bit(FaultKind::kSpikes) | bit(FaultKind::kDcJump));
  EXPECT_TRUE(log_.spoilt(FaultKind::kClipping, FaultChannel::kFrame, 39));
}

TEST_F(FaultLogTest, TellsAGapThatTicksShow) {
  log_.spoil_by_gap(31, 52);
  for (const std::int64_t tick : {30, 45, 59})
    EXPECT_EQ(log_.spoilt(tick, tick), bit(FaultKind::kLostSamples) | FaultLog::kGapBit) << tick;
  EXPECT_EQ(log_.spoilt(60, 60), 0U);
  log_.spoil(FaultKind::kLostSamples, FaultChannel::kAll, 75, 75);
  EXPECT_EQ(log_.spoilt(75, 75), bit(FaultKind::kLostSamples)) << "that nobody counted";
}

TEST_F(FaultLogTest, BeginsAtTheFirstTick) {
  log_.spoil(FaultKind::kDcJump, FaultChannel::kFrame, -500, 5);
  EXPECT_EQ(log_.spoilt(0, 0), bit(FaultKind::kDcJump));
  EXPECT_EQ(log_.spoilt(10, 100), 0U);
}

TEST_F(FaultLogTest, KnowsTheNewest4096Seconds) {
  constexpr std::int64_t kTicks = 10 * FaultLog::kSeconds;
  log_.spoil(FaultKind::kClipping, FaultChannel::kFrame, 0, kTicks);  // one more than it knows
  EXPECT_EQ(log_.spoilt(0, 9), 0U);
  EXPECT_EQ(log_.spoilt(10, 10), bit(FaultKind::kClipping));
  EXPECT_EQ(log_.spoilt(kTicks, kTicks), bit(FaultKind::kClipping));
  log_.spoil(FaultKind::kSpikes, FaultChannel::kFrame, kTicks + 15, kTicks + 15);
  EXPECT_EQ(log_.spoilt(10, 10), 0U) << "its place is another's";
  EXPECT_EQ(log_.spoilt(kTicks + 15, kTicks + 15), bit(FaultKind::kSpikes));
  EXPECT_EQ(log_.spoilt(0, 2 * kTicks), bit(FaultKind::kSpikes))
      << "no further back than from its end";
}

}  // namespace
}  // namespace dampline
