// SPDX-License-Identifier: MIT
// Which blocks are judged, what is taken for no noise, and how many blocks tell.
#include <gtest/gtest.h>

#include <tuple>
#include <utility>

#include "dampline/sample/hole_bridge.hpp"
#include "tests/guard/track.hpp"

namespace dampline {
namespace {

void turn_over(std::int64_t, Track::Values& a) { a[1] = -a[1]; }

TEST(SpectralGuard, JudgesNoBlockThatAnotherFaultSpoils) {
  Track track;
  track.change = turn_over;
  track.log().spoil(FaultKind::kStuckChannel, FaultChannel::kFrame, 0, 60 * 300);
  track.run(50.0);
  EXPECT_TRUE(track.faults().empty());
  track.run(50.0);
  ASSERT_EQ(track.faults().size(), 1U);
  EXPECT_GT(track.faults()[0].time_s, 60.0);
}

TEST(SpectralGuard, SaysNothingOfTheRateBesideAMountThatRings) {
  for (const bool rings : {false, true}) {
    GuardConfig config = declared();
    config.wheelbase_m = 2.0;
    config.speed_mps = 30.0;
    Track track{config};
    if (rings) track.log().report(FaultKind::kRingingMount, FaultChannel::kFrame, 1.0, 60.0);
    track.run(80.0);
    EXPECT_EQ(track.find(FaultKind::kWrongSampleRate) == nullptr, rings);
  }
}

// 0.13^2 as the power of noise; one and a half times that of impulses goes off, and 3.5 times
// 0.05^2 may stay.
TEST(SpectralGuard, ImpulsesOfAWheelsetAreNoNoise) {
  for (const auto& [impulses, named] : {std::pair{0.0045, true}, std::pair{0.0065, false}}) {
    GuardConfig config;
    config.noise_mps2[1] = 0.05;
    Track track{config};
    track.motion = kStrong;
    track.guard().set_impulse_power(1, impulses);
    EXPECT_EQ(noise_of(track, 1, 0.15) != nullptr, named) << impulses;
  }
  Track frame;
  frame.guard().set_impulse_power(0, 1.0);
  EXPECT_NE(noise_of(frame, 0, 0.45), nullptr) << "of the wheelsets alone";
}

TEST(SpectralGuard, ThreeBlocksTellTheFramesNoiseAndEightAWheelsets) {
  for (const auto& [channel, silent_s] : {std::pair{0U, 24.5}, std::pair{1U, 96.5}}) {
    GuardConfig config;
    config.noise_mps2[channel] = 0.05;
    Track track{config};
    track.motion = channel == 0 ? 4.0 : kStrong;
    track.change = noisy(channel, 0.15);
    track.run(silent_s);
    EXPECT_TRUE(track.faults().empty()) << channel;
    track.run(1.5);
    EXPECT_NE(track.find(FaultKind::kExcessNoise), nullptr) << channel;
    // The middle of the first block of three segments, or of the third, whose delay is steady.
    EXPECT_NEAR(track.faults()[0].time_s, channel == 0 ? 2.0 : 18.7, 0.1);
  }
}

// Where more than a hundredth of the values were put in, a burst may be theirs.
TEST(SpectralGuard, ManyValuesThatWerePutInMakeNoBurst) {
  for (const auto& [share, named] :
       {std::pair{0.99 * HoleBridge::kMany, true}, std::pair{1.01 * HoleBridge::kMany, false}}) {
    Track track{GuardConfig{}};
    BridgeFigures figures;
    figures.share = share;
    track.guard().set_bridged(figures);
    track.change = noisy(0, 0.3, 150.0, 175.0);
    track.run(240.0);
    EXPECT_EQ(track.find(FaultKind::kNoiseBurst) != nullptr, named) << share;
  }
}

// A burst is told a block late: what else spoils it may become known by then, before its middle or
// after it.
TEST(SpectralGuard, ABurstBesideAnotherFaultIsThatFaults) {
  for (const double off_s : {-4.0, 4.0, 30.0}) {
    Track track{GuardConfig{}};
    track.change = noisy(0, 0.3, 150.0, 155.0);
    track.run(164.0);
    EXPECT_TRUE(track.faults().empty());
    const auto tick = static_cast<std::int64_t>((151.8 + off_s) * kTrackRateHz);
    track.log().spoil(FaultKind::kDcJump, FaultChannel::kFrame, tick, tick);
    track.run(40.0);
    EXPECT_EQ(track.find(FaultKind::kNoiseBurst) != nullptr, off_s > 10.0) << off_s;
  }
}

TEST(SpectralGuard, ThePlaceOfAStepOfTheGainIsKnownToHalfABlock) {
  for (const double step_s : {100.0, 103.0, 106.0}) {
    Track track;
    track.change = [&](std::int64_t tick, Track::Values& a) {
      if (static_cast<double>(tick) > step_s * kTrackRateHz) a[2] *= 0.95;
    };
    track.run(200.0);
    const Fault* const fault = track.find(FaultKind::kGainChange);
    ASSERT_NE(fault, nullptr) << step_s;
    EXPECT_NEAR(fault->time_s, step_s, 5.2) << step_s;
    EXPECT_NEAR(fault->size, 100.0 * (1.0 / 0.95 - 1.0), 0.1);
  }
}

// Three blocks after it and one more, the one that holds it not counted.
TEST(SpectralGuard, AStepOfTheGainIsKnownFourBlocksLater) {
  for (const double step_s : {100.0, 103.0, 106.0}) {
    Track track;
    track.change = [&](std::int64_t tick, Track::Values& a) {
      if (static_cast<double>(tick) > step_s * kTrackRateHz) a[2] *= 0.95;
    };
    track.run(step_s);
    double later_s = 0.0;
    for (; later_s < 100.0 && track.faults().empty(); later_s += 1.0) track.run(1.0);
    EXPECT_GT(later_s, 35.0) << step_s;
    EXPECT_LT(later_s, 48.0) << step_s;
  }
}

}  // namespace
}  // namespace dampline
