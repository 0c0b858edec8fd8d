// SPDX-License-Identifier: MIT
#include "dampline/guard/spectral_guard.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/guard/track.hpp"

namespace dampline {
namespace {

TEST(SpectralGuard, FindsNothingWhereAllIsWellAndKnowsTheDelay) {
  Track track;
  track.run(5.0);
  EXPECT_FALSE(track.guard().has_delay());
  track.run(195.0);
  EXPECT_TRUE(track.faults().empty());
  EXPECT_TRUE(track.guard().has_delay());
  EXPECT_TRUE(track.guard().knows_delay());
  EXPECT_TRUE(track.guard().steady());
  EXPECT_NEAR(track.guard().delay_s(), kLater / kTrackRateHz, 3e-5);
  EXPECT_NEAR(track.guard().frame_follow().usual, 0.05, 0.02);
  for (std::size_t c = 0; c < kChannels; ++c)
    EXPECT_NEAR(track.guard().noise_mps2(c) / 0.02, 1.0, 0.2) << c;
  track.guard().restart();
  EXPECT_FALSE(track.guard().has_delay());
  EXPECT_FALSE(track.guard().steady());
}

TEST(SpectralGuard, JudgesNothingOfWheelsetsThatHardlyMove) {
  for (const auto& [size, judged] : {std::pair{0.095, false}, std::pair{0.145, true}}) {
    Track track;  // 2.5 m/s^2 rms lie above 4 Hz
    track.change = [s = size](std::int64_t, Track::Values& a) {
      for (double& value : a) value *= s;
      a[1] = -a[1];
    };
    track.run(60.0);
    EXPECT_EQ(track.find(FaultKind::kWrongPolarity) != nullptr, judged) << size;
  }
}

TEST(SpectralGuard, NamesTheSensorThatIsUpsideDown) {
  for (std::size_t c = 0; c < kChannels; ++c) {
    Track track;
    track.change = [c](std::int64_t, Track::Values& a) { a[c] = -a[c]; };
    track.run(6.0);
    EXPECT_TRUE(track.faults().empty()) << "two blocks are needed";
    track.run(60.0);
    ASSERT_EQ(track.faults().size(), 1U) << c;
    EXPECT_EQ(track.faults()[0].kind, FaultKind::kWrongPolarity);
    EXPECT_EQ(track.faults()[0].channel, channel_of(c));
    EXPECT_EQ(track.faults()[0].size, -1.0);
    EXPECT_GE(track.faults()[0].count, 3U);
  }
}

// Where wheelsets hardly match, none is upside down: 0.35 of the whitened correlation are needed.
TEST(SpectralGuard, NamesAWheelsetThatIsUpsideDownWhereTheyMatch) {
  for (const auto& [noise, named] : {std::pair{3.0, true}, std::pair{4.5, false}}) {
    Track track{GuardConfig{}};
    track.noise = noise;
    track.change = [](std::int64_t, Track::Values& a) { a[1] = -a[1]; };
    track.run(120.0);
    EXPECT_NEAR(track.guard().figures().match, named ? -0.42 : -0.27, 0.05);
    const auto* const fault = track.log().find(FaultKind::kWrongPolarity, FaultChannel::kWheelset1);
    EXPECT_EQ(fault != nullptr, named) << noise;
  }
}

// The frame takes part in what both wheelsets do; what stands in its place shakes more.
TEST(SpectralGuard, NamesAFrameAmongTheWheelsets) {
  for (const auto& [factor, named] : {std::pair{1.1, false}, std::pair{0.9, true}}) {
    Track track;
    track.change = [f = factor](std::int64_t, Track::Values& a) {
      const double frame = f * (a[1] + a[2]) / std::sqrt(2.0);
      a[0] = std::exchange(a[1], frame);
    };
    track.run(60.0);
    const Fault* const fault = track.find(FaultKind::kSwappedChannels);
    ASSERT_EQ(fault != nullptr, named) << factor;
    if (!named) continue;
    EXPECT_EQ(fault->channel, FaultChannel::kAll);
    EXPECT_NEAR(fault->size, 1.1, 0.15);
    EXPECT_FALSE(track.guard().has_delay()) << "nothing else is judged";
  }
}

// A slow car, whose frame friction holds: its wheelsets still follow one another.
TEST(SpectralGuard, TakesNoFrameThatShakesAsWheelsetsDoForOneOfThem) {
  Track track;
  track.change = [](std::int64_t, Track::Values& a) {
    a[0] = 1.3 * (a[1] + a[2]) / std::sqrt(2.0);
  };
  track.run(60.0);
  EXPECT_GT(track.guard().figures().frame_power, 1.2);
  EXPECT_LT(track.guard().figures().at_once, 0.2);
  EXPECT_EQ(track.find(FaultKind::kSwappedChannels), nullptr);
}

TEST(SpectralGuard, NamesWheelsetsThatCameInTheOtherOrder) {
  for (const auto& [leading, named] :
       {std::pair{Leading::kUnknown, false}, std::pair{Leading::kWheelset1, false},
        std::pair{Leading::kWheelset2, true}}) {
    GuardConfig config = declared();
    config.leading = leading;
    Track track{config};
    track.run(60.0);
    ASSERT_EQ(track.find(FaultKind::kSwappedChannels) != nullptr, named);
    if (!named) continue;
    EXPECT_EQ(track.faults()[0].channel, FaultChannel::kWheelsets);
  }
}

TEST(SpectralGuard, MeasuresAStepOfTheGain) {
  for (const auto& [gain, named] :
       {std::pair{1.010, false}, std::pair{1.016, true}, std::pair{0.95, true}}) {
    Track track;
    track.change = [g = gain](std::int64_t tick, Track::Values& a) {
      if (tick > 120 * 300) a[1] *= g;
    };
    track.run(240.0);
    const Fault* const fault = track.find(FaultKind::kGainChange);
    ASSERT_EQ(fault != nullptr, named) << gain;
    if (!named) continue;
    EXPECT_EQ(fault->channel, FaultChannel::kWheelsets);
    EXPECT_NEAR(fault->size, 100.0 * (gain - 1.0), 0.3);
    EXPECT_NEAR(fault->time_s, 120.0, 11.0);
    EXPECT_EQ(fault->count, 1U) << "once";
  }
}

TEST(SpectralGuard, MeasuresAGainThatCreeps) {
  Track track;
  track.change = [](std::int64_t tick, Track::Values& a) {
    a[2] *= std::exp(0.05 * static_cast<double>(tick) / (400.0 * 300.0));
  };
  track.run(400.0);
  const Fault* const fault = track.find(FaultKind::kGainChange);
  ASSERT_NE(fault, nullptr);
  EXPECT_NEAR(fault->size, -4.7, 0.7) << "of wheelset 1 over wheelset 2";
  EXPECT_NEAR(fault->time_s, 8.4, 0.1) << "from the first block that is usable";
  EXPECT_GT(fault->count, 3U);
}

TEST(SpectralGuard, ImpactsForbidAJudgementOfTheGain) {
  Track track;
  track.change = [&](std::int64_t tick, Track::Values& a) {
    if (tick > 120 * 300) a[1] *= 1.05;
    if (tick % 600 == 0) ++track.inputs.impacts[1];
  };
  track.run(240.0);
  EXPECT_EQ(track.find(FaultKind::kGainChange), nullptr);
}

// The delay says 24 samples: 2 m at so many metres a second.
TEST(SpectralGuard, NamesARateThatTheDelayContradicts) {
  constexpr double kRightMps = 2.0 * kTrackRateHz / kLater;
  for (const auto& [factor, named] : {std::pair{1.0025, false}, std::pair{1.0035, true},
                                      std::pair{0.9975, false}, std::pair{0.9965, true}}) {
    GuardConfig config = declared();
    config.wheelbase_m = 2.0;
    config.speed_mps = factor * kRightMps;
    Track track{config};
    track.run(120.0);
    const Fault* const fault = track.find(FaultKind::kWrongSampleRate);
    ASSERT_EQ(fault != nullptr, named) << factor;
    if (!named) continue;
    EXPECT_EQ(fault->channel, FaultChannel::kAll);
    EXPECT_NEAR(fault->size, factor * 300.0, 0.05);
    EXPECT_NEAR(fault->time_s, 54.1, 0.1)
        << "the delay is known from three blocks on, and four tell";
  }
  for (const bool speed : {true, false}) {
    GuardConfig config = declared();
    config.wheelbase_m = speed ? 0.0 : 5.0;
    config.speed_mps = speed ? 5.0 : 0.0;
    Track track{config};
    track.run(80.0);
    EXPECT_TRUE(track.faults().empty()) << "what is not declared is not judged";
  }
}

TEST(SpectralGuard, SaysNothingOfTheRateBesideAFaultOfTime) {
  GuardConfig config = declared();
  config.wheelbase_m = 2.0;
  config.speed_mps = 30.0;
  for (const FaultKind kind : {FaultKind::kClockDrift, FaultKind::kTimingStep,
                               FaultKind::kLostSamples, FaultKind::kRepeatedSamples}) {
    for (const FaultChannel channel :
         {FaultChannel::kWheelset1, FaultChannel::kWheelset2, FaultChannel::kWheelsets}) {
      Track track{config};
      track.log().report(kind, channel, 1.0, 1.0);
      track.run(80.0);
      EXPECT_EQ(track.find(FaultKind::kWrongSampleRate), nullptr);
    }
  }
  Track other{config};
  other.log().report(FaultKind::kTimingStep, FaultChannel::kFrame, 1.0, 1.0);
  other.run(80.0);
  EXPECT_NE(other.find(FaultKind::kWrongSampleRate), nullptr);
}

// 3.5 times the declared power: 1.87 of the deviation.
TEST(SpectralGuard, NamesNoiseAboveWhatIsDeclared) {
  for (const auto& [channel, noise, named] :
       {std::tuple{0U, 0.34, false}, std::tuple{0U, 0.41, true}}) {
    GuardConfig config;
    config.noise_mps2[channel] = channel == 0 ? 0.2 : 0.05;
    Track track{config};
    const Fault* const fault = noise_of(track, channel, noise);
    ASSERT_EQ(fault != nullptr, named) << channel << ": " << noise;
    if (!named) continue;
    EXPECT_EQ(fault->channel, channel_of(channel));
    EXPECT_NEAR(fault->size / noise, 1.0, 0.3);
  }
  Track undeclared{GuardConfig{}};
  EXPECT_EQ(noise_of(undeclared, 0, 0.5), nullptr);
}

TEST(SpectralGuard, TheResolutionIsNoiseToo) {
  for (const auto& [step, named] : {std::pair{0.1, true}, std::pair{1.5, false}}) {
    GuardConfig config;
    config.noise_mps2[0] = 0.01;
    config.step_mps2[0] = step;  // 1.5 / sqrt(12) is 0.43
    Track track{config};
    EXPECT_EQ(noise_of(track, 0, 0.41) != nullptr, named) << step;
  }
}

TEST(SpectralGuard, NoiseThatSecondDifferencesDoNotShowIsNone) {
  for (const auto& [scale, named] : {std::pair{0.7, false}, std::pair{0.9, true}}) {
    Track track;
    track.guard().set_change_scale(0, scale);  // sqrt(6) 0.45 / 1.4 is 0.79
    EXPECT_EQ(noise_of(track, 0, 0.45) != nullptr, named) << scale;
  }
}

TEST(SpectralGuard, WhatWasPutInIsNoNoise) {
  for (const auto& [bridged, named] : {std::pair{0.33, true}, std::pair{0.39, false}}) {
    Track track;  // 0.45^2 less 1.5 times that is above 3.5 times 0.05^2, or below
    BridgeFigures figures;
    figures.noise_mps2[0] = bridged;
    track.guard().set_bridged(figures);
    EXPECT_EQ(noise_of(track, 0, 0.45) != nullptr, named) << bridged;
  }
}

TEST(SpectralGuard, NoiseAmongImpactsIsNotJudged) {
  for (const std::size_t c : {0U, 1U}) {
    Track track;
    const Track::Change noise = noisy(c, 0.45);
    track.change = [&](std::int64_t tick, Track::Values& a) {
      noise(tick, a);
      if (tick % 600 == 0) ++track.inputs.impacts[c];
    };
    track.run(120.0);
    EXPECT_EQ(track.find(FaultKind::kExcessNoise), nullptr);
  }
}

// That of both wheelsets together is known where neither was struck; else the frame's stands for
// it.
TEST(SpectralGuard, NoiseOfWheelsetsIsNotMeasuredAmongImpacts) {
  for (const std::size_t struck : {0U, 1U, 2U}) {
    Track track;
    track.change = [&](std::int64_t tick, Track::Values&) {
      if (tick % 600 == 0) ++track.inputs.impacts[struck];
    };
    track.run(120.0);
    for (const std::size_t c : {1U, 2U})
      EXPECT_EQ(track.guard().noise_mps2(c) == track.guard().noise_mps2(0), struck > 0) << struck;
  }
}

// Six times the usual power.
TEST(SpectralGuard, NamesABurstAndItsBlocks) {
  for (const auto& [channel, size, named] :
       {std::tuple{0U, 0.034, false}, std::tuple{0U, 0.05, true}}) {
    Track track{GuardConfig{}};
    track.change = noisy(channel, size, 150.0, 175.0);
    track.run(240.0);
    const Fault* const fault = track.find(FaultKind::kNoiseBurst);
    ASSERT_EQ(fault != nullptr, named) << channel << ": " << size;
    if (!named) continue;
    const FaultChannel where = channel == 0 ? FaultChannel::kFrame : FaultChannel::kWheelsets;
    EXPECT_EQ(fault->channel, where);
    EXPECT_NEAR(fault->size / size, 1.0, 0.35);
    EXPECT_NEAR(fault->time_s, 162.0, 15.0);
    for (const double off_s : {-5.0, 5.0}) {  // a block is 11 s
      const std::int64_t tick = std::llround((fault->time_s + off_s) * kTrackRateHz);
      EXPECT_TRUE(track.log().spoilt(FaultKind::kNoiseBurst, where, tick)) << off_s;
    }
    EXPECT_TRUE(track.log().spoilt(FaultKind::kNoiseBurst, where, 162 * 300));
    EXPECT_FALSE(track.log().spoilt(FaultKind::kNoiseBurst, where, 130 * 300));
    EXPECT_FALSE(track.log().spoilt(FaultKind::kNoiseBurst, where, 195 * 300));
    EXPECT_EQ(track.find(FaultKind::kGainChange), nullptr) << "no change of gain";
  }
}

TEST(SpectralGuard, NamesNoiseOfAWheelset) {
  for (const std::size_t channel : {1U, 2U}) {
    for (const auto& [noise, named] : {std::pair{0.08, false}, std::pair{0.115, true}}) {
      GuardConfig config;
      config.noise_mps2[channel] = 0.05;
      Track track{config};
      track.motion = kStrong;
      const Fault* const fault = noise_of(track, channel, noise);
      ASSERT_EQ(fault != nullptr, named) << channel << ": " << noise;
      if (!named) continue;
      EXPECT_EQ(fault->channel, channel_of(channel));
      EXPECT_NEAR(fault->size / noise, 0.9, 0.15);
    }
  }
}

// Where it differs from the usual, the wheelsets' own difference in time tells how much it is.
TEST(SpectralGuard, NoiseOfAWheelsetIsNoMoreThanTheWheelsetsDiffer) {
  for (const auto& [difference_mps2, named] : {std::pair{0.08, false}, std::pair{0.115, true}}) {
    GuardConfig config;
    config.noise_mps2[1] = 0.05;
    Track track{config};
    track.motion = kStrong;
    track.guard().set_difference(difference_mps2);  // noise of 0.13 over 1.4 is 0.094
    EXPECT_EQ(noise_of(track, 1, 0.15) != nullptr, named);
  }
}

TEST(SpectralGuard, ASensorThatSaturatesMakesNoNoise) {
  GuardConfig config;
  config.noise_mps2.fill(0.05);
  for (const std::size_t channel : {0U, 1U}) {
    Track track{config};
    track.motion = kStrong;
    track.log().report(FaultKind::kSoftSaturation, FaultChannel::kWheelset2, 1.0, 1.0);
    EXPECT_EQ(noise_of(track, channel, 0.4) != nullptr, channel == 0) << channel;
  }
}

/// Whether so much noise of one sensor, from 150 s to 175 s, is a burst.
bool bursts(std::size_t channel, double noise_mps2, const GuardConfig& config) {
  Track track{config};
  if (channel > 0) track.motion = kStrong;
  track.change = noisy(channel, noise_mps2, 150.0, 175.0);
  track.run(240.0);
  EXPECT_EQ(track.find(FaultKind::kGainChange), nullptr) << "no change of gain";
  const Fault* const fault = track.find(FaultKind::kNoiseBurst);
  if (fault != nullptr) {
    EXPECT_EQ(fault->channel, channel == 0 ? FaultChannel::kFrame : FaultChannel::kWheelsets);
    EXPECT_NEAR(fault->time_s, 162.0, 15.0);
  }
  return fault != nullptr;
}

// Ten times the usual power of both.
TEST(SpectralGuard, NamesABurstOfAWheelset) {
  for (const std::size_t channel : {1U, 2U}) {
    EXPECT_FALSE(bursts(channel, 0.06, {})) << channel;
    EXPECT_TRUE(bursts(channel, 0.1, {})) << channel;
  }
}

TEST(SpectralGuard, KnowsWhatIsABurstFromFiveBlocksOn) {
  Track track{GuardConfig{}};
  track.change = noisy(0, 0.3, 24.0, 36.0);
  track.run(55.0);  // four of ten seconds, and what the first needs
  EXPECT_TRUE(track.faults().empty());
  track.run(3.0);
  EXPECT_NE(track.find(FaultKind::kNoiseBurst), nullptr);
}

// A burst of some blocks moves the ratio of the wheelsets' powers as a change of gain would.
TEST(SpectralGuard, ALongBurstIsNoChangeOfGain) {
  for (const std::size_t channel : {1U, 2U}) {
    Track track{GuardConfig{}};
    track.change = noisy(channel, 0.5, 150.0, 205.0);
    track.run(300.0);
    EXPECT_NE(track.find(FaultKind::kNoiseBurst), nullptr);
    EXPECT_EQ(track.find(FaultKind::kGainChange), nullptr) << channel;
  }
}

// 3.5 times the declared power, of the frame and of both wheelsets together.
TEST(SpectralGuard, ABurstIsAboveWhatIsDeclared) {
  GuardConfig frame;
  frame.noise_mps2[0] = 0.1;
  EXPECT_FALSE(bursts(0, 0.15, frame));
  EXPECT_TRUE(bursts(0, 0.3, frame));
  EXPECT_TRUE(bursts(1, 0.15, frame));
  for (const std::size_t declared : {1U, 2U}) {
    GuardConfig wheelset;
    wheelset.noise_mps2[declared] = 0.1;
    EXPECT_FALSE(bursts(1, 0.15, wheelset)) << declared;
    EXPECT_TRUE(bursts(1, 0.35, wheelset)) << declared;
    EXPECT_TRUE(bursts(0, 0.15, wheelset)) << declared;
  }
}

TEST(SpectralGuard, OfNothingTheFrameFollowsNothing) {
  Track track;
  const FrameFollow follow = track.guard().frame_follow();
  for (const double figure : {follow.usual, follow.step, follow.step_significance, follow.trend,
                              follow.trend_significance})
    EXPECT_EQ(figure, 0.0);
  EXPECT_EQ(track.guard().noise_mps2(0), 0.0);
}

TEST(SpectralGuard, MeasuresAStepOfWhatTheFrameFollows) {
  Track track;
  track.noise = 0.0;
  track.change = [](std::int64_t tick, Track::Values& a) {
    if (tick > 200 * 300) a[0] *= 1.5;
  };
  track.run(400.0);
  const FrameFollow follow = track.guard().frame_follow();
  EXPECT_NEAR(follow.step, 0.4, 0.25);
  EXPECT_GT(follow.step_significance, 1.0);
  EXPECT_GT(follow.trend, 0.0);
  // A straight line through a step in the middle rises by one and a half of it.
  EXPECT_NEAR(follow.trend, 1.5 * follow.step, 0.03);
  EXPECT_NEAR(follow.usual, 0.05, 0.02);
  EXPECT_GT(follow.trend_significance, 10.0);
}

}  // namespace
}  // namespace dampline
