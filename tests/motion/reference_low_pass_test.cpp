// SPDX-License-Identifier: MIT
#include "dampline/motion/reference_low_pass.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace dampline {
namespace {

constexpr double kCircle = 2.0 * std::numbers::pi;

/// A fourth-order Butterworth's response by its two sections, not by its poles.
std::complex<double> fourth_order(double relative) {
  const std::complex<double> s{0.0, relative};
  return 1.0 / ((s * s + 1.847759065 * s + 1.0) * (s * s + 0.7653668647 * s + 1.0));
}

Sample sample_at(std::int64_t tick, double value) {
  Sample out;
  out.tick = tick;
  out.accel_mps2 = {value, 2.0 * value, -value};
  out.extra_mps2 = {static_cast<float>(3.0 * value), static_cast<float>(-5.0 * value)};
  return out;
}

/// What becomes of a tone, by correlation with it over whole turns.
std::complex<double> response(double corner_hz, double rate_hz, double tone_hz) {
  ReferenceLowPass filter{{.corner_hz = corner_hz}, rate_hz};
  std::complex<double> sum{};
  const auto settled = static_cast<std::int64_t>(rate_hz);
  const auto counted = static_cast<std::int64_t>(10.0 * rate_hz);
  for (std::int64_t n = 0; n < settled + counted; ++n) {
    const double phase = kCircle * tone_hz * static_cast<double>(n) / rate_hz;
    const Sample out = filter.update(sample_at(n, std::cos(phase)));
    EXPECT_NEAR(out.accel_mps2[1], 2.0 * out.accel_mps2[0], 1e-12);
    EXPECT_NEAR(out.extra_mps2[0], 3.0 * out.accel_mps2[0], 1e-5);
    EXPECT_NEAR(out.extra_mps2[1], -5.0 * out.accel_mps2[0], 1e-5);
    if (n >= settled) sum += out.accel_mps2[0] * std::polar(2.0, -phase);
  }
  return sum / static_cast<double>(counted);
}

struct Sensors {
  double corner_hz;
  double rate_hz;
};

// In gain and phase, two samples later, within 1 % of what passes at zero frequency.
TEST(ReferenceLowPass, MakesAHighCornerOneOf100Hz) {
  for (const Sensors& s : {Sensors{120.0, 300.0}, Sensors{160.0, 400.0}, Sensors{240.0, 300.0},
                           Sensors{400.0, 1000.0 / 3.0}, Sensors{960.0, 400.0}}) {
    for (const double tone_hz : {1.0, 10.0, 30.0, 60.0, 90.0, 110.0}) {
      const std::complex<double> wanted = fourth_order(tone_hz / 100.0) /
                                          fourth_order(tone_hz / s.corner_hz) *
                                          std::polar(1.0, -kCircle * 2.0 * tone_hz / s.rate_hz);
      EXPECT_LT(std::abs(response(s.corner_hz, s.rate_hz, tone_hz) - wanted), 0.01)
          << s.corner_hz << ' ' << s.rate_hz << ' ' << tone_hz;
    }
  }
}

/// What becomes of a tone that all channels hold alike.
std::array<std::complex<double>, kChannels> responses(const AntiAliasConfig& sensors,
                                                      double tone_hz) {
  constexpr double kRateHz = 300.0;
  ReferenceLowPass filter{sensors, kRateHz};
  std::array<std::complex<double>, kChannels> sum{};
  for (std::int64_t n = 0; n < 3300; ++n) {
    const double phase = kCircle * tone_hz * static_cast<double>(n) / kRateHz;
    Sample in;
    in.tick = n;
    in.accel_mps2.fill(std::cos(phase));
    const Sample out = filter.update(in);
    for (std::size_t c = 0; n >= 300 && c < kChannels; ++c)
      sum[c] += out.accel_mps2[c] * std::polar(2.0 / 3000.0, -phase);
  }
  return sum;
}

// The lowest goes through as it is, but for the delay that all have.
TEST(ReferenceLowPass, BringsSingleSensorsBehindTheLowest) {
  const AntiAliasConfig sensors{.corner_hz = 100.0, .own_hz = {60.0, 0.0, 150.0}};
  EXPECT_EQ(ReferenceLowPass::seen_behind(sensors).corner_hz, 60.0);
  EXPECT_EQ(ReferenceLowPass::seen_behind(sensors).own_hz, AntiAliasConfig{}.own_hz);
  for (const double tone_hz : {1.0, 10.0, 30.0, 60.0, 90.0}) {
    const auto seen = responses(sensors, tone_hz);
    const std::complex<double> late = std::polar(1.0, -kCircle * 2.0 * tone_hz / 300.0);
    const auto wanted = [&](double own_hz) {
      return late * fourth_order(tone_hz / 60.0) / fourth_order(tone_hz / own_hz);
    };
    EXPECT_LT(std::abs(seen[0] - late), 1e-6) << tone_hz;
    EXPECT_LT(std::abs(seen[1] - wanted(100.0)), 0.01) << tone_hz;
    EXPECT_LT(std::abs(seen[2] - wanted(150.0)), 0.01) << tone_hz;
  }
}

TEST(ReferenceLowPass, OfSensorsThatAllLieHigherIsTheUsualOne) {
  const AntiAliasConfig sensors{.corner_hz = 240.0, .own_hz = {120.0, 0.0, 0.0}};
  EXPECT_EQ(ReferenceLowPass::seen_behind(sensors).corner_hz, 100.0);
  // One that is known is of no use where the others are not.
  EXPECT_EQ(ReferenceLowPass::seen_behind({.corner_hz = 0.0, .own_hz = {60.0, 0.0, 0.0}}).corner_hz,
            0.0);
}

TEST(ReferenceLowPass, LeavesLowAndUnknownCornersAlone) {
  for (const double corner_hz : {0.0, 60.0, 100.0, 105.0}) {
    const AntiAliasConfig sensors{.corner_hz = corner_hz};
    ReferenceLowPass filter{sensors, 300.0};
    EXPECT_EQ(ReferenceLowPass::seen_behind(sensors).corner_hz, corner_hz);
    for (std::int64_t n = 0; n < 40; ++n)
      EXPECT_EQ(filter.update(sample_at(n, std::sin(n))).accel_mps2[0], std::sin(n));
  }
  const AntiAliasConfig seen = ReferenceLowPass::seen_behind({.corner_hz = 240.0, .order = 2});
  EXPECT_EQ(seen.corner_hz, 100.0);
  EXPECT_EQ(seen.order, 4);
  EXPECT_TRUE(seen.thinned);
}

// What came before a gap, a missing value or a spoilt sample is not in what comes after it.
TEST(ReferenceLowPass, StartsAnew) {
  for (const int how : {0, 1, 2}) {
    ReferenceLowPass filter{{.corner_hz = 200.0}, 300.0};
    std::int64_t tick = 0;
    for (; tick < 50; ++tick) static_cast<void>(filter.update(sample_at(tick, 1000.0)));
    Sample broken = sample_at(tick++, 5.0);
    if (how == 0) tick += 3;
    if (how == 1) broken.accel_mps2[2] = std::numeric_limits<double>::quiet_NaN();
    if (how == 2) broken.spoilt = true;
    if (how != 0) {
      EXPECT_EQ(filter.update(broken).accel_mps2[0], 5.0);
    }
    for (int n = 0; n < 20; ++n)
      EXPECT_NEAR(filter.update(sample_at(tick++, 1.5)).accel_mps2[0], 1.5, 1e-6) << how;
  }
}

TEST(ReferenceLowPass, KeepsTheRestOfASample) {
  ReferenceLowPass filter{{.corner_hz = 200.0}, 300.0};
  Sample in = sample_at(7, 1.0);
  in.time_ns = 99;
  in.saturated = 5;
  in.bridged = 2;
  in.lost = true;
  in.wheelset_after_us = {3, -4};
  const Sample out = filter.update(in);
  EXPECT_EQ(out.tick, 7);
  EXPECT_EQ(out.time_ns, 99);
  EXPECT_EQ(out.saturated, 5);
  EXPECT_EQ(out.bridged, 2);
  EXPECT_TRUE(out.lost);
  EXPECT_EQ(out.wheelset_after_us, in.wheelset_after_us);
}

}  // namespace
}  // namespace dampline
