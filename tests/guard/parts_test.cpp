// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "dampline/guard/block_series.hpp"
#include "dampline/guard/channel_watch.hpp"
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
