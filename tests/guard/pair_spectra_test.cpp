// SPDX-License-Identifier: MIT
#include "dampline/guard/pair_spectra.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <set>
#include <vector>

#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

/// Pushes samples and does the work that is due, one slice a sample.
class Spectra {
 public:
  PairSpectra& spectra() { return *spectra_; }
  void run(std::int64_t samples, const std::set<std::int64_t>& made_up = {}) {
    for (std::int64_t i = 0; i < samples; ++i, ++tick_) {
      spectra_->push(tick_, signal(tick_), made_up.contains(tick_));
      if (spectra_->advance()) segments.push_back(spectra_->segment());
    }
  }
  std::function<std::array<double, kChannels>(std::int64_t)> signal = [](std::int64_t) {
    return std::array<double, kChannels>{};
  };
  std::vector<SegmentFigures> segments;

 private:
  std::unique_ptr<PairSpectra> spectra_{std::make_unique<PairSpectra>(300.0)};
  std::int64_t tick_{0};
};

// A segment of 512 ends 96 before the newest sample; 96 more lie before it; then every 256.
TEST(PairSpectra, HasASegmentEvery256SamplesAndTellsItsMiddle) {
  Spectra spectra;
  spectra.run(704 + 118);
  EXPECT_TRUE(spectra.segments.empty());
  spectra.run(1);
  ASSERT_EQ(spectra.segments.size(), 1U) << "32, 72 and 16 slices";
  EXPECT_EQ(spectra.segments[0].tick, 96 + 256);
  spectra.run(2560);
  ASSERT_EQ(spectra.segments.size(), 11U);
  EXPECT_EQ(spectra.segments[10].tick, 96 + 256 + 2560);
}

TEST(PairSpectra, LeavesOutSegmentsOfWhatWasMadeUp) {
  for (const auto& [tick, lost] : {std::pair{1000, 2U}, std::pair{0, 1U}, std::pair{703, 3U}}) {
    Spectra spectra;
    spectra.run(5000, {tick});
    EXPECT_EQ(spectra.segments.size() + lost, 17U) << tick;
    for (const SegmentFigures& segment : spectra.segments)
      EXPECT_FALSE(tick >= segment.tick - 256 - 96 && tick < segment.tick + 256 + 96);
  }
}

TEST(PairSpectra, ARestartLeavesTheOpenSegment) {
  Spectra spectra;
  spectra.run(704 + 50);
  spectra.spectra().restart();
  spectra.run(704);
  EXPECT_TRUE(spectra.segments.empty());
  spectra.run(200);
  ASSERT_EQ(spectra.segments.size(), 1U);
  EXPECT_EQ(spectra.segments[0].tick, 754 + 96 + 256);
}

TEST(PairSpectra, AnotherDelayBeginsTheSumsAnew) {
  Spectra spectra;
  spectra.run(704 + 3 * 256 + 250);
  EXPECT_EQ(spectra.spectra().sums().segments, 4U);
  EXPECT_EQ(spectra.spectra().sums().delay, 0);
  spectra.spectra().set_delay(9);
  spectra.run(256);
  EXPECT_EQ(spectra.spectra().sums().segments, 1U);
  EXPECT_EQ(spectra.spectra().sums().delay, 9);
  EXPECT_EQ(spectra.spectra().sums().first_tick, 96 + 4 * 256);
}

TEST(PairSpectra, WhatIsTakenStaysUntilTheNextIs) {
  Spectra spectra;
  spectra.signal = [](std::int64_t n) {
    return std::array<double, kChannels>{std::cos(0.5 * static_cast<double>(n)), 0.0, 0.0};
  };
  spectra.run(704 + 250);
  const SpectrumSums& taken = spectra.spectra().take();
  EXPECT_EQ(taken.segments, 1U);
  EXPECT_EQ(spectra.spectra().sums().segments, 0U);
  EXPECT_EQ(spectra.spectra().sums().frame[41], 0.0);
  const double power = taken.frame[41];
  EXPECT_GT(power, 1.0);
  spectra.run(512);
  EXPECT_EQ(taken.frame[41], power);
  EXPECT_EQ(spectra.spectra().sums().segments, 2U);
}

// Of two tones, the phase of each bin, weighted by f^2, tells the fraction.
TEST(PairSpectra, MeasuresADelayBeyondWholeSamples) {
  constexpr double kTurn = 2.0 * std::numbers::pi / 512.0;
  for (const double samples : {0.0, 0.3, -0.4}) {
    Spectra spectra;
    spectra.spectra().set_delay(11);
    PairSpectra::Weights weights{};
    weights[40] = 1.0;
    weights[90] = 2.0;
    spectra.spectra().set_weights(weights);
    const double turned = 0.2;  // of the slower tone, which no delay explains
    spectra.signal = [&](std::int64_t n) {
      const auto x = static_cast<double>(n);
      const auto track = [](double at, double off) {
        return std::cos(40.0 * kTurn * at - off) + std::sin(90.0 * kTurn * at);
      };
      return std::array<double, kChannels>{0.0, track(x, 0.0), track(x - 11.0 - samples, turned)};
    };
    spectra.run(2000);
    const double fitted = turned * 40.0 / (kTurn * (40.0 * 40.0 + 2.0 * 90.0 * 90.0));
    ASSERT_FALSE(spectra.segments.empty());
    for (const SegmentFigures& segment : spectra.segments)
      EXPECT_NEAR(segment.excess_delay_s * 300.0, samples + fitted, 1e-6);
    spectra.spectra().set_weights({});
    spectra.run(512);
    EXPECT_EQ(spectra.segments.back().excess_delay_s, 0.0) << "where no bin counts";
  }
}

TEST(PairSpectra, SeesAWheelset1ThatIsLater) {
  Spectra spectra;
  spectra.spectra().set_delay(-90);
  sim::Random random{5, sim::Stream::kTrack};
  std::vector<double> track(6000);
  for (double& x : track) x = random.normal();
  spectra.signal = [&](std::int64_t n) {
    return std::array<double, kChannels>{0.0, track[static_cast<std::size_t>(n + 10)],
                                         track[static_cast<std::size_t>(n + 100)]};
  };
  spectra.run(3000);
  const SpectrumSums& sums = spectra.spectra().sums();
  for (const std::size_t k : {20U, 100U, 200U}) {
    EXPECT_NEAR(std::norm(sums.aligned[k]) / (sums.delayed1[k] * sums.wheelset2[k]), 1.0, 1e-9);
    EXPECT_NEAR(sums.aligned[k].imag() / sums.delayed1[k], 0.0, 1e-9);
    EXPECT_NEAR(sums.delayed1[k] / sums.wheelset2[k], 1.0, 1e-9);
  }
}

}  // namespace
}  // namespace dampline
