// SPDX-License-Identifier: MIT
#include "dampline/sample/hole_bridge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "sim_hw/noise.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLength = 30 * sim::kSampleRateHz;

std::vector<Sample> record() {
  sim::Simulation simulation{sim::reference_run(sim::Load::kLaden, 80.0, 3)};
  std::vector<Sample> out;
  for (std::size_t i = 0; i < kLength; ++i) out.push_back(sim::to_sample(simulation.next()));
  return out;
}

struct Bridged {
  std::vector<Sample> samples;
  BridgeFigures figures;
};

Bridged bridged(const std::vector<Sample>& in) {
  HoleBridge bridge;
  Bridged out;
  const auto take = [&] {
    for (Sample sample; bridge.pop(sample);) out.samples.push_back(sample);
  };
  for (const Sample& sample : in) {
    bridge.push(sample);
    take();
  }
  bridge.finish();
  take();
  out.figures = bridge.figures();
  return out;
}

/// Without each sample with this probability.
std::vector<Sample> thinned(const std::vector<Sample>& in, double share) {
  sim::Random random{7, sim::Stream::kFaults};
  std::vector<Sample> out;
  for (const Sample& sample : in)
    if (random.uniform() >= share) out.push_back(sample);
  return out;
}

TEST(HoleBridge, HandsOnWhatIsWholeBitForBit) {
  const auto in = record();
  const Bridged out = bridged(in);
  ASSERT_EQ(out.samples.size(), in.size());
  for (std::size_t i = 0; i < in.size(); ++i) {
    EXPECT_EQ(out.samples[i].tick, in[i].tick);
    EXPECT_EQ(out.samples[i].accel_mps2, in[i].accel_mps2);
    EXPECT_EQ(out.samples[i].bridged, 0U);
  }
  EXPECT_EQ(out.figures.values, 0U);
}

TEST(HoleBridge, PutsSingleValuesWhereTheyWereAndSaysHowWell) {
  const auto in = record();
  auto holed = in;
  for (std::size_t i = 1000; i < kLength - 100; i += 97) holed[i].accel_mps2[i % 3] = kNothing;
  const Bridged out = bridged(holed);
  ASSERT_EQ(out.samples.size(), in.size());
  std::array<double, kChannels> squares{}, power{}, count{};
  for (std::size_t i = 1000; i < kLength - 100; i += 97) {
    const std::size_t c = i % 3;
    EXPECT_EQ(out.samples[i].bridged, 1U << c);
    EXPECT_FALSE(out.samples[i].lost);
    squares[c] += std::pow(out.samples[i].accel_mps2[c] - in[i].accel_mps2[c], 2);
    power[c] += std::pow(in[i].accel_mps2[c], 2);
    count[c] += 1.0;
  }
  for (std::size_t c = 0; c < kChannels; ++c) {
    EXPECT_LT(std::sqrt(squares[c] / power[c]), c == 0 ? 0.4 : 0.2) << c;
    EXPECT_NEAR(out.figures.error_mps2[c] / std::sqrt(squares[c] / count[c]), 1.0, 0.4) << c;
  }
}

TEST(HoleBridge, PutsInSamplesThatNeverCame) {
  const auto in = record();
  const Bridged out = bridged(thinned(in, 0.01));
  ASSERT_GT(out.samples.size(), in.size() - 20);
  double squares = 0.0, power = 0.0;
  std::uint64_t lost = 0;
  for (const Sample& sample : out.samples) {
    const Sample& truth = in[static_cast<std::size_t>(sample.tick)];
    if (!sample.lost) {
      EXPECT_EQ(sample.accel_mps2, truth.accel_mps2);
      continue;
    }
    ++lost;
    EXPECT_EQ(sample.bridged & 7U, 7U);
    EXPECT_NEAR(static_cast<double>(sample.time_ns), static_cast<double>(truth.time_ns), 2.0);
    squares += std::pow(sample.accel_mps2[1] - truth.accel_mps2[1], 2);
    power += std::pow(truth.accel_mps2[1], 2);
  }
  EXPECT_NEAR(static_cast<double>(lost), 0.01 * kLength, 40.0);
  EXPECT_EQ(out.figures.values, kChannels * lost);
  EXPECT_LT(squares, 0.07 * power);
}

TEST(HoleBridge, LeavesLongerHolesAsTheyAre) {
  auto in = record();
  for (std::size_t i = 2000; i < 2004; ++i) in[i].accel_mps2[1] = kNothing;
  for (std::size_t i = 3000; i < 3004; ++i) {
    in[i].accel_mps2[1] = kNothing;
    in[i].lost = true;
  }
  in.erase(in.begin() + 4000, in.begin() + 4004);
  const Bridged out = bridged(in);
  EXPECT_EQ(out.figures.values, 0U);
  EXPECT_EQ(out.samples.size(), in.size() - 4);  // those that came without a channel
  std::size_t nothing = 0;
  for (const Sample& sample : out.samples) nothing += std::isnan(sample.accel_mps2[1]) ? 1U : 0U;
  EXPECT_EQ(nothing, 4U);
}

TEST(HoleBridge, KeepsTicksRisingWhateverIsMissing) {
  const auto in = record();
  for (const double share : {0.05, 0.3, 0.8}) {
    const Bridged out = bridged(thinned(in, share));
    for (std::size_t i = 1; i < out.samples.size(); ++i) {
      ASSERT_GT(out.samples[i].tick, out.samples[i - 1].tick);
      for (const double a : out.samples[i].accel_mps2) ASSERT_TRUE(std::isfinite(a));
    }
  }
}

TEST(HoleBridge, LetsADeadChannelBe) {
  auto in = record();
  for (Sample& sample : in) sample.accel_mps2[2] = kNothing;
  const Bridged out = bridged(in);
  EXPECT_EQ(out.samples.size(), in.size());
  EXPECT_EQ(out.figures.values, 0U);
}

/// So many samples of a ramp, which a smooth curve continues exactly; the frame's value is missing
/// at these places.
Bridged ramp_without(std::size_t length, const std::vector<std::size_t>& missing) {
  std::vector<Sample> in;
  for (std::size_t i = 0; i < length; ++i) {
    const auto x = static_cast<double>(i);
    in.push_back({.tick = static_cast<std::int64_t>(i), .accel_mps2 = {3.0 + 0.1 * x, x, -x}});
  }
  for (const std::size_t place : missing) in[place].accel_mps2[0] = kNothing;
  return bridged(in);
}

TEST(HoleBridge, PutsInThreeValuesInARowWithSixAfter) {
  EXPECT_EQ(ramp_without(60, {53}).figures.values, 1U);
  EXPECT_EQ(ramp_without(60, {54}).figures.values, 0U);
  EXPECT_EQ(ramp_without(60, {20, 21, 22}).figures.values, 3U);
  EXPECT_NEAR(ramp_without(60, {20, 21, 22}).samples[21].accel_mps2[0], 5.1, 1e-9);
  EXPECT_EQ(ramp_without(60, {20, 21, 22, 23}).figures.values, 0U);
  EXPECT_EQ(ramp_without(60, {20, 22, 24, 26}).figures.values, 4U) << "several at once";
}

// Once a model is learned.
TEST(HoleBridge, NeedsEightSamplesAfterAHoleThatStays) {
  for (const auto& [later, filled] : {std::pair{7U, 0U}, std::pair{8U, 1U}}) {
    auto holed = record();
    holed[1500].accel_mps2[1] = kNothing;
    for (std::size_t at = 2000; at < 2004; ++at) holed[at].accel_mps2[1] = kNothing;
    holed[2004 + later].accel_mps2[1] = kNothing;
    EXPECT_EQ(bridged(holed).figures.values, 1U + filled) << later;
  }
}

TEST(HoleBridge, LagsByTwentySamples) {
  HoleBridge bridge;
  Sample out;
  for (std::int64_t tick = 0; tick < 20; ++tick) {
    bridge.push({.tick = tick});
    EXPECT_FALSE(bridge.pop(out)) << tick;
  }
  bridge.push({.tick = 20});
  ASSERT_TRUE(bridge.pop(out));
  EXPECT_EQ(out.tick, 0);
  EXPECT_FALSE(bridge.pop(out));
}

// Gravity, or whatever a sensor stands at.
TEST(HoleBridge, AMeanChangesNothing) {
  const auto in = record();
  std::array<Bridged, 2> out;
  for (std::size_t i = 0; i < 2; ++i) {
    auto holed = in;
    for (Sample& sample : holed)
      for (double& a : sample.accel_mps2) a += i == 0 ? 0.0 : 100.0;
    for (std::size_t at = 1000; at < kLength - 100; at += 97) holed[at].accel_mps2[1] = kNothing;
    out[i] = bridged(holed);
  }
  for (std::size_t at = 1000; at < kLength - 100; at += 97)
    EXPECT_NEAR(out[1].samples[at].accel_mps2[1] - 100.0, out[0].samples[at].accel_mps2[1], 1e-6);
  EXPECT_NEAR(out[1].figures.error_mps2[1] / out[0].figures.error_mps2[1], 1.0, 1e-6);
}

// Errors of single values, over all samples.
TEST(HoleBridge, SaysWhatNoiseItMakesOfAllSamples) {
  auto holed = record();
  std::uint64_t count = 0;
  for (std::size_t at = 1000; at < kLength - 100; at += 97, ++count)
    holed[at].accel_mps2[2] = kNothing;
  const BridgeFigures figures = bridged(holed).figures;
  EXPECT_EQ(figures.values, count);
  const double share = static_cast<double>(count) / static_cast<double>(kLength);
  EXPECT_NEAR(figures.share, share, 1e-12);
  EXPECT_NEAR(figures.noise_mps2[2], figures.error_mps2[2] * std::sqrt(share), 1e-12);
  EXPECT_EQ(figures.noise_mps2[0], 0.0);
  EXPECT_EQ(figures.error_mps2[1], 0.0);
}

/// What is put in at a place of a tone that no smooth curve follows, off the truth by this; these
/// samples never came.
double off_a_tone(std::size_t place, const std::vector<std::size_t>& lost = {}) {
  const auto truth = [](std::size_t i) { return std::sin(1.9 * static_cast<double>(i)); };
  std::vector<Sample> in;
  for (std::size_t i = 0; i < place + 60; ++i) {
    if (std::find(lost.begin(), lost.end(), i) != lost.end()) continue;
    const double value = i == place ? kNothing : truth(i);
    in.push_back({.tick = static_cast<std::int64_t>(i), .accel_mps2 = {value, 0.1, 0.2}});
  }
  return std::abs(bridged(in).samples[place].accel_mps2[0] - truth(place));
}

TEST(HoleBridge, LearnsFrom256SamplesOn) {
  for (const std::size_t place : {20U, 200U, 255U}) EXPECT_GT(off_a_tone(place), 0.1) << place;
  for (const std::size_t place : {256U, 600U}) EXPECT_LT(off_a_tone(place), 0.03) << place;
}

// Another hole a little later does not spoil it, though its samples are there by then.
TEST(HoleBridge, LearnsFromWhatWasBefore) {
  for (const std::size_t place : {600U, 1111U})
    for (const std::size_t last : {20U, 21U, 22U})
      EXPECT_LT(off_a_tone(place, {place + last - 2, place + last - 1, place + last}), 0.03)
          << place << ", " << last;
}

}  // namespace
}  // namespace dampline
