// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>

#include "dampline/guard/block_series.hpp"
#include "dampline/guard/block_survey.hpp"
#include "dampline/guard/channel_watch.hpp"
#include "dampline/guard/pair_spectra.hpp"
#include "dampline/guard/spike_watch.hpp"
#include "dampline/numeric/fourier.hpp"
#include "dampline/numeric/log_histogram.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

TEST(Fourier512, IsTheSumOfItsDefinitionInAnyNumberOfSlices) {
  sim::Random random{5, sim::Stream::kSensors};
  std::array<std::complex<double>, Fourier512::kSize> x{};
  for (auto& value : x) value = {random.normal(), random.normal()};
  Fourier512 fourier;
  for (std::size_t n = 0; n < x.size(); ++n) fourier.set(n, x[n]);
  fourier.start();
  int calls = 1;
  while (!fourier.advance(37)) ++calls;
  EXPECT_EQ(calls, 63);  // 2304 butterflies
  for (const std::size_t k : {0U, 1U, 7U, 128U, 255U, 256U, 400U, 511U}) {
    std::complex<double> sum;
    for (std::size_t n = 0; n < x.size(); ++n) {
      sum += x[n] * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(n * k) / 512.0);
    }
    EXPECT_NEAR(std::abs(fourier[k] - sum), 0.0, 1e-10) << k;
  }
}

TEST(Fourier512, ItsQuarterTurnsAreExact) {
  EXPECT_EQ(Fourier512::turn(0), (std::complex<double>{1.0, 0.0}));
  EXPECT_EQ(Fourier512::turn(128), (std::complex<double>{0.0, -1.0}));
}

TEST(MagnitudeHistogram, KnowsItsMedianToFivePercent) {
  MagnitudeHistogram histogram;
  for (std::uint64_t i = 1; i <= 9999; ++i) histogram.add(i);
  EXPECT_NEAR(histogram.median(), 5000.0, 250.0);
}

TEST(BlockSeries, FindsAStepAndItsPlaceInNoise) {
  sim::Random random{3, sim::Stream::kSensors};
  BlockSeries series;
  for (int i = 0; i < 30; ++i) series.add((i < 17 ? 0.0 : 8.0) + random.normal(), 100 * i);
  EXPECT_EQ(series.step().block, 17U);
  EXPECT_GT(series.step().significance, 12.0);
  EXPECT_NEAR(series.step().size, 8.0, 1.5);
  EXPECT_NEAR(series.change_at(1650), 8.0, 3.0);
}

TEST(BlockSeries, SeesNoStepInNoiseAlone) {
  sim::Random random{4, sim::Stream::kSensors};
  for (int run = 0; run < 200; ++run) {
    BlockSeries series;
    for (int i = 0; i < 30; ++i) series.add(random.normal(), i);
    EXPECT_LT(series.step().significance, 12.0);
  }
}

TEST(BlockSeries, MeasuresATrendWithoutTakingItForScatter) {
  sim::Random random{6, sim::Stream::kSensors};
  BlockSeries series;
  for (int i = 0; i < 40; ++i) series.add(0.5 * i + 0.1 * random.normal(), i);
  EXPECT_NEAR(series.trend().per_block, 0.5, 0.01);
  EXPECT_LT(series.scatter(), 0.6);
}

// A parabola: all first differences differ, and every figure is known on paper.
TEST(BlockSeries, ATrendIsItsStraightLineOfLeastSquares) {
  constexpr int kBlocks = 21;
  BlockSeries series;
  for (int i = 0; i < 30; ++i) series.add(1e6, i);  // forgotten, but still in its memory
  series.drop(30);
  for (int i = 0; i < kBlocks; ++i) series.add(0.1 * i * i, i);
  const BlockSeries::Trend trend = series.trend();
  constexpr double kSxx = kBlocks * (kBlocks * kBlocks - 1) / 12.0;
  EXPECT_NEAR(trend.per_block, 0.1 * (kBlocks - 1), 1e-12);
  EXPECT_NEAR(trend.total, 0.1 * (kBlocks - 1) * (kBlocks - 1), 1e-11);
  // The middle one of the squared differences 0.1 (2 i + 1), i = 0...19, is that of i = 10.
  const double scatter = 2.1 / std::sqrt(0.4549 * 2.0);
  EXPECT_NEAR(series.scatter(), scatter, 1e-12);
  EXPECT_NEAR(trend.significance, 2.0 * std::sqrt(kSxx) / scatter, 1e-9);
  series.drop(kBlocks - 5);
  EXPECT_EQ(series.trend().significance, 0.0) << "five blocks are too few";
}

TEST(BlockSeries, ComparesBlocksBesideAChangeAndLeavesTheNearestOut) {
  BlockSeries series;
  for (const double value : {9.0, 1.0, 2.0, 3.0, 50.0, 60.0, 5.0, 6.0, 7.0, 9.0})
    series.add(value, static_cast<std::int64_t>(series.size()) * 10);
  EXPECT_EQ(series.change_at(45), 6.0 - 2.0);
  EXPECT_EQ(series.change_at(50), 6.0 - 2.0);
  EXPECT_EQ(series.change_at(5), 0.0) << "no block before it is left";
  EXPECT_EQ(series.change_at(85), 0.0) << "no block after it is left";
  EXPECT_EQ(series.change_at(15), (3.0 + 50.0 + 60.0) / 3.0 - 9.0);
  EXPECT_EQ(series.change_since(60), 8.0 - 5.5);
  EXPECT_EQ(series.change_since(65), 0.0) << "three blocks are too few";
}

// All of one tone, so that each sum is known from the frame's.
TEST(PairSpectra, SumsPowersAndProductsOfTheThreeChannels) {
  constexpr std::size_t kBin = 40;
  constexpr int kDelay = 5;
  PairSpectra spectra{300.0};
  spectra.set_delay(kDelay);
  PairSpectra::Weights weights{};
  weights[kBin] = 1.0;
  spectra.set_weights(weights);
  const auto tone = [](std::int64_t n) {
    return std::cos(2.0 * std::numbers::pi * static_cast<double>(kBin) * static_cast<double>(n) /
                    512.0);
  };
  double excess_s = 1.0;
  for (std::int64_t n = 0; n < 2000; ++n) {
    spectra.push(n, {tone(n), 2.0 * tone(n + kDelay), 3.0 * tone(n)}, false);
    for (int slices = 0; slices < 100; ++slices)
      if (spectra.advance()) excess_s = spectra.segment().excess_delay_s;
  }
  const SpectrumSums& sums = spectra.take();
  EXPECT_EQ(sums.segments, 6U);  // after 704, 960, ... samples
  EXPECT_EQ(sums.delay, kDelay);
  EXPECT_EQ(sums.first_tick, 704 - 96 - 512);
  EXPECT_EQ(sums.last_tick, 704 + 5 * 256 - 96 - 1);
  EXPECT_NEAR(excess_s, 0.0, 1e-9);
  const double one = 6.0 * 128.0 * 128.0;  // Hann's window halves a tone's 256
  const auto turn = std::polar(1.0, 2.0 * std::numbers::pi * kBin * kDelay / 512.0);
  EXPECT_NEAR(sums.frame[kBin], one, 1e-6 * one);
  EXPECT_NEAR(sums.wheelset1[kBin], 4.0 * one, 1e-6 * one);
  EXPECT_NEAR(sums.delayed1[kBin], 4.0 * one, 1e-6 * one);
  EXPECT_NEAR(sums.wheelset2[kBin], 9.0 * one, 1e-6 * one);
  EXPECT_NEAR(sums.mean[kBin], std::norm(turn + 1.5) * one, 1e-6 * one);
  EXPECT_NEAR(std::abs(sums.wheelsets[kBin] - 6.0 * one * std::conj(turn)), 0.0, 1e-6 * one);
  EXPECT_NEAR(std::abs(sums.aligned[kBin] - 6.0 * one), 0.0, 1e-6 * one);
  EXPECT_NEAR(std::abs(sums.frame_to[0][kBin] - 2.0 * one * std::conj(turn)), 0.0, 1e-6 * one);
  EXPECT_NEAR(std::abs(sums.frame_to[1][kBin] - 3.0 * one), 0.0, 1e-6 * one);
  EXPECT_NEAR(sums.frame[kBin + 7], 0.0, 1e-6 * one);
}

/// A block's spectra: shared power, white noise of each wheelset, and a share of the power that the
/// wheels do not have in common.
SpectrumSums noisy_block(double noise1, double noise2, double not_common) {
  SpectrumSums sums;
  sums.segments = 12;
  for (std::size_t k = 0; k < kSpectrumBins; ++k) {
    sums.wheelset1[k] = sums.delayed1[k] = 1.0 + noise1;
    sums.wheelset2[k] = 1.0 + noise2;
    sums.aligned[k] = sums.wheelsets[k] = 1.0 - not_common;
    sums.frame[k] = 0.5;
    sums.mean[k] = 1.0;
  }
  return sums;
}

BlockSurvey surveyed(const SpectrumSums& sums) {
  BlockSurvey survey{300.0, {}};
  survey.start(sums);
  for (int calls = 0; !survey.advance(); ++calls)
    if (calls > 10'000) throw std::runtime_error{"never done"};
  return survey;
}

BlockFigures figures_of(const SpectrumSums& sums) { return surveyed(sums).figures(); }

TEST(BlockSurvey, ABinWeighsByItsCoherence) {
  const SpectrumSums all = noisy_block(0.0, 0.0, 0.0);
  const SpectrumSums half = noisy_block(0.0, 0.0, 1.0 - std::sqrt(0.5));
  const double most = surveyed(all).weights()[100];
  EXPECT_GT(most, 10.0);
  EXPECT_NEAR(surveyed(half).weights()[100], 1.0, 1e-9);
  EXPECT_EQ(surveyed(all).weights()[200], 0.0) << "above 90 Hz none counts";
  EXPECT_EQ(surveyed(all).figures().coherent_share, 1.0);
}

// Where noise is in the middle of the band as at its end, it is motion that is not shared.
TEST(BlockSurvey, TellsWhatWheelsDoNotShareFromNoise) {
  const BlockFigures clean = figures_of(noisy_block(0.0, 0.0, 0.0));
  EXPECT_NEAR(clean.incoherent_share, 0.0, 1e-12);
  EXPECT_NEAR(clean.noise[1] + clean.noise[2], 0.0, 1e-12);
  const BlockFigures differ = figures_of(noisy_block(0.0, 0.0, 0.2));
  EXPECT_NEAR(differ.incoherent_share, 0.2, 1e-12);
  EXPECT_NEAR(differ.noise[1] + differ.noise[2], 0.0, 1e-12);
}

TEST(BlockSurvey, MeasuresWhiteNoiseThatTheMiddleOfTheBandLacks) {
  SpectrumSums sums = noisy_block(0.03, 0.01, 0.0);
  for (std::size_t k = 0; k < kSpectrumBins; ++k)  // below 95 Hz the motion is a thousand times it
    if (static_cast<double>(k) * 300.0 / 512.0 < 95.0) {
      sums.delayed1[k] = sums.wheelset1[k] = sums.wheelset2[k] = 1000.0;
      sums.aligned[k] = 1000.0;
    }
  const BlockFigures figures = figures_of(sums);
  const double density = 2.0 / (300.0 * 0.375 * 512.0 * 12.0);
  EXPECT_NEAR(figures.incoherent_share, 0.0, 1e-12);
  EXPECT_NEAR(figures.noise[1] + figures.noise[2], density * (0.03 + 0.01), 0.03 * density * 0.04);
  EXPECT_NEAR(figures.noise[1] / figures.noise[2], 3.0, 0.1);
}

TEST(LevelWatch, SeesAJumpAndNoneAcrossARestart) {
  constexpr int kSecond = 10;
  sim::Random random{8, sim::Stream::kSensors};
  LevelWatch watch{kSecond};
  std::int64_t tick = 0;
  int jumps = 0;
  double size = 0.0;
  const auto seconds = [&](int count, double level) {
    for (int i = 0; i < count * kSecond; ++i) {
      LevelJump jump;
      if (!watch.update(tick++, level + 0.01 * random.normal(), jump)) continue;
      ++jumps;
      size = jump.size_mps2;
    }
  };
  seconds(200, 0.0);
  EXPECT_EQ(jumps, 0);
  seconds(60, 3.0);
  EXPECT_EQ(jumps, 1);
  EXPECT_NEAR(size, 3.0, 0.1);
  watch.restart();
  seconds(60, -3.0);
  EXPECT_EQ(jumps, 1);
}

TEST(CodeWatch, SeesThePileAtAnEndAndTheBitsThatDoNotMove) {
  sim::Random random{9, sim::Stream::kSensors};
  CodeWatch clipped;
  CodeWatch coarse;
  CodeWatch sound;
  for (int i = 0; i < 3000; ++i) {
    const auto code = static_cast<std::int64_t>(std::lround(100.0 * random.normal()));
    clipped.update(i, std::min<std::int64_t>(code, 200));
    coarse.update(i, code / 4 * 4);
    sound.update(i, code);
  }
  const CodeVerdict verdict = clipped.close();
  EXPECT_TRUE(verdict.clips);
  EXPECT_EQ(verdict.clip_code, 200);
  EXPECT_EQ(coarse.close().dead_bits, 2);
  const CodeVerdict clean = sound.close();
  EXPECT_FALSE(clean.clips);
  EXPECT_EQ(clean.dead_bits, 0);
}

// Twice as many at the extreme as next to it, by chance: three in each of fifteen blocks.
TEST(CodeWatch, TakesAFewCodesMoreAtTheExtremeForChance) {
  CodeWatch watch;
  for (int block = 0; block < 15; ++block) {
    for (int i = 0; i < 1000; ++i) watch.update(i, i % 150 - 75);
    for (const int code : {200, 200, 200, 199}) watch.update(1000, code);
    for (int code = 198; code > 180; --code) {
      for (const int tick : {1001, 1002}) watch.update(tick, code);
    }
    EXPECT_FALSE(watch.close().clips) << "block " << block;
  }
}

TEST(SpikeWatch, TellsAWrongSampleFromAnImpact) {
  sim::Random random{2, sim::Stream::kSensors};
  SpikeWatch watch{600};
  int digital = 0;
  int impacts = 0;
  for (int i = 0; i < 6010; ++i) {
    const double smooth = 50.0 * std::sin(0.2 * i) + 3.0 * random.normal();
    const double spike = i % 1000 == 500 ? 300.0 : 0.0;
    const int since = i % 1000 - 800;  // a blow that rings for some samples
    const double blow =
        since >= 0 && since < 12 ? 300.0 * std::exp(-0.25 * since) * std::cos(1.8 * since) : 0.0;
    watch.update(i, std::lround(smooth + spike + blow));
    Strike strike;
    if (!watch.next(strike)) continue;
    if (strike.digital) {
      EXPECT_EQ(strike.tick % 1000, 500);
      EXPECT_NEAR(static_cast<double>(strike.height), 300.0, 30.0);
      ++digital;
    } else {
      ++impacts;
    }
  }
  EXPECT_EQ(digital, 6);
  EXPECT_EQ(impacts, 6);
}

}  // namespace
}  // namespace dampline
