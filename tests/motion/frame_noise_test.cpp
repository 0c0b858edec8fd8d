// SPDX-License-Identifier: MIT
#include "dampline/motion/frame_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "dampline/motion/butterworth.hpp"

namespace dampline {
namespace {

/// The gain of a steady tone.
double gain(double hz, double corner_hz, double rate_hz) {
  ButterworthLowPass<1> filter{corner_hz, rate_hz};
  double cosine = 0.0;
  double sine = 0.0;
  const int samples = static_cast<int>(rate_hz);  // of a second, after one that settles
  for (int i = 0; i < 2 * samples; ++i) {
    const double turn = 2.0 * std::numbers::pi * hz * i / rate_hz;
    const double y = filter.update({std::cos(turn)})[0];
    if (i < samples) continue;
    cosine += 2.0 * y * std::cos(turn) / samples;
    sine += 2.0 * y * std::sin(turn) / samples;
  }
  return std::hypot(cosine, sine);
}

TEST(ButterworthLowPass, HasTheResponseOfItsFormula) {
  constexpr double kRateHz = 2400.0;
  for (const double corner_hz : {60.0, 100.0, 400.0}) {
    for (const double hz : {1.0, 50.0, 60.0, 100.0, 170.0, 400.0, 700.0}) {
      // Frequencies as the bilinear transform warps them.
      const double relative = std::tan(std::numbers::pi * hz / kRateHz) /
                              std::tan(std::numbers::pi * corner_hz / kRateHz);
      EXPECT_NEAR(gain(hz, corner_hz, kRateHz), 1.0 / std::sqrt(butterworth_loss(relative, 4)),
                  1e-6)
          << hz << " of " << corner_hz;
    }
  }
}

TEST(ButterworthLoss, IsAPowerOfTwiceItsOrder) {
  EXPECT_EQ(butterworth_loss(1.0, 4), 2.0);
  EXPECT_EQ(butterworth_loss(2.0, 1), 5.0);
  EXPECT_EQ(butterworth_loss(2.0, 3), 65.0);
}

/// A frame whose acceleration leaps at random, through the sensors' filter, and white noise.
class Frame {
 public:
  static constexpr double kRateHz = 300.0;
  static constexpr int kSteps = 16;

  Frame(double leap_mps2, double noise_mps2, double corner_hz = 100.0)
      : leap_{leap_mps2}, noise_{noise_mps2}, filter_{corner_hz, kRateHz * kSteps} {}
  Sample next() {
    double filtered = 0.0;
    for (int i = 0; i < kSteps; ++i) {
      if (uniform_(random_) < 6.0 / (kRateHz * kSteps)) level_ = leap_ * normal_(random_);
      filtered = filter_.update({level_})[0];
    }
    return {.tick = tick_++, .accel_mps2 = {filtered + noise_ * normal_(random_), 0.0, 0.0}};
  }

 private:
  double leap_;
  double noise_;
  double level_{0.0};
  std::int64_t tick_{0};
  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  ButterworthLowPass<1> filter_;
};

double noise_of(double leap_mps2, double noise_mps2, double time_s) {
  Frame frame{leap_mps2, noise_mps2};
  FrameNoise meter{Frame::kRateHz, {}};
  for (int i = 0; i < static_cast<int>(time_s * Frame::kRateHz); ++i) meter.take(frame.next());
  return meter.noise_mps2();
}

TEST(FrameNoise, IsTheWhitePartAndNotWhatLeapsOfFrictionLeave) {
  for (const double noise_mps2 : {0.01, 0.05}) {
    EXPECT_NEAR(noise_of(0.0, noise_mps2, 120.0) / noise_mps2, 1.0, 0.03);
    EXPECT_NEAR(noise_of(0.3, noise_mps2, 300.0) / noise_mps2, 1.0, 0.06) << noise_mps2;
  }
  EXPECT_LT(noise_of(0.3, 0.0, 300.0), 0.003);
}

// Whatever corner was declared: leaps tell of their own.
TEST(FrameNoise, TellsTheLowPassOfLeaps) {
  for (const double corner_hz : {40.0, 60.0, 80.0, 100.0}) {
    Frame frame{0.3, 0.01, corner_hz};
    FrameNoise meter{Frame::kRateHz, {}};
    for (int i = 0; i < 300 * 300; ++i) meter.take(frame.next());
    EXPECT_NEAR(meter.corner_hz(), corner_hz, 0.03 * corner_hz);
  }
  EXPECT_EQ(FrameNoise(Frame::kRateHz, {}).corner_hz(), 0.0);
}

/// A sample of this height in every 512, on top of something else.
template <class Motion>
double noise_of_pulses(double height_mps2, const AntiAliasConfig& filter, Motion motion) {
  FrameNoise meter{Frame::kRateHz, filter};
  for (std::int64_t i = 1; i <= 100 * 512 + 256; ++i) {
    const double pulse = i % 512 == 65 ? height_mps2 : 0.0;
    meter.take({.tick = i, .accel_mps2 = {pulse + motion(i), 0.0, 0.0}});
  }
  return meter.noise_mps2();
}

// The power of single samples is the same at all frequencies: height^2 / 512 on average.
TEST(FrameNoise, IsExactForSingleSamplesWhateverTheSlowMotion) {
  const double expected = 0.5 / std::sqrt(512.0);
  const auto slow = [](std::int64_t i) {
    const double t = static_cast<double>(i) / Frame::kRateHz;
    return 9.81 + 3.0 * std::sin(2.0 * std::numbers::pi * 3.3 * t);
  };
  for (const double corner_hz : {0.0, 60.0, 100.0, 400.0}) {
    const AntiAliasConfig filter{.corner_hz = corner_hz};
    EXPECT_NEAR(noise_of_pulses(0.5, filter, [](std::int64_t) { return 0.0; }), expected,
                1e-4 * expected);
    EXPECT_NEAR(noise_of_pulses(0.5, filter, slow), expected, 2e-3 * expected) << corner_hz;
  }
}

/// One period of 512 samples, even about its middle, with a power of `white` and of what leaps
/// leave: 1 / f^2 behind the filter, and the same of what lies beyond half the rate.
std::vector<double> period_of(double white, double folded, const AntiAliasConfig& filter) {
  const auto power = [&](double hz) {
    const double loss =
        filter.corner_hz > 0.0 ? 1.0 + std::pow(hz / filter.corner_hz, 2 * filter.order) : 1.0;
    return 1e4 / (loss * hz * hz);
  };
  std::vector<double> out(512, 0.0);
  for (int k = 60; k < 256; ++k) {  // below lies nothing that is looked at
    const double hz = Frame::kRateHz * k / 512.0;
    const double size = std::sqrt(white + folded * (power(hz) + power(Frame::kRateHz - hz)));
    for (int n = 0; n < 512; ++n)
      out[static_cast<std::size_t>(n)] +=
          2.0 / 512.0 * size * std::cos(2.0 * std::numbers::pi * k * (n - 256) / 512.0);
  }
  return out;
}

TEST(FrameNoise, TakesOutWhatIsFilteredAndFolded) {
  for (const AntiAliasConfig filter : {AntiAliasConfig{}, AntiAliasConfig{.corner_hz = 0.0},
                                       AntiAliasConfig{.corner_hz = 120.0, .order = 2}}) {
    const auto period = period_of(1.0, 3.0, filter);
    const auto alone = period_of(1.0, 0.0, filter);
    const auto noise = [&](const std::vector<double>& of) {
      FrameNoise meter{Frame::kRateHz, filter};
      for (std::int64_t i = 1; i <= 100 * 512 + 256; ++i)
        meter.take({.tick = i, .accel_mps2 = {of[static_cast<std::size_t>(i % 512)], 0.0, 0.0}});
      return meter.noise_mps2();
    };
    EXPECT_NEAR(noise(period) / noise(alone), 1.0, 0.02) << filter.corner_hz;
  }
}

TEST(FrameNoise, NeedsThirtySixSegmentsWithoutAGap) {
  Frame frame{0.0, 0.05};
  FrameNoise meter{Frame::kRateHz, {}};
  for (int i = 0; i < 36 * 256; ++i) meter.take(frame.next());  // 35 of 512, each half on the last
  EXPECT_EQ(meter.noise_mps2(), 0.0);
  for (int i = 0; i < 255; ++i) meter.take(frame.next());
  static_cast<void>(frame.next());  // lost
  for (int i = 0; i < 511; ++i) meter.take(frame.next());
  Sample none = frame.next();
  none.accel_mps2[0] = std::numeric_limits<double>::quiet_NaN();
  meter.take(none);
  for (int i = 0; i < 511; ++i) meter.take(frame.next());
  EXPECT_EQ(meter.noise_mps2(), 0.0);
  meter.take(frame.next());
  EXPECT_NEAR(meter.noise_mps2(), 0.05, 0.003);
}

}  // namespace
}  // namespace dampline
