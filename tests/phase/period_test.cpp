// SPDX-License-Identifier: MIT
#include "dampline/phase/period.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

constexpr double kPeriodStepS = 1.0 / 300.0;
using Meter = PeriodMeter<512>;
Meter meter() { return Meter::make(kPeriodStepS, 6).value(); }

double tone(double time_s, double period_s) {
  const double angle = 2.0 * std::numbers::pi * time_s / period_s;
  return std::sin(angle) + 0.4 * std::sin(3.0 * angle + 0.8);
}

/// White noise through a resonance of one degree of freedom.
class Resonance {
 public:
  Resonance(double frequency_hz, double damping, std::uint64_t seed)
      : random_{seed, sim::Stream::kTrack} {
    const double w = 2.0 * std::numbers::pi * frequency_hz;
    const double fall = std::exp(-damping * w * kPeriodStepS);
    a1_ = 2.0 * fall * std::cos(w * std::sqrt(1.0 - damping * damping) * kPeriodStepS);
    a2_ = -fall * fall;
  }
  double next() {
    const double x = a1_ * x1_ + a2_ * x2_ + random_.normal();
    x2_ = x1_;
    return x1_ = x;
  }

 private:
  sim::Random random_;
  double a1_{0.0}, a2_{0.0}, x1_{0.0}, x2_{0.0};
};

TEST(PeriodMeter, FindsThePeriodOfATone) {
  for (const double period_s : {0.21, 0.371, 0.75, 2.2}) {
    Meter m = meter();
    for (int i = 0; i < 36000; ++i) m.update(5.0 + tone(i * kPeriodStepS, period_s));
    const Period p = m.period();
    ASSERT_EQ(p.state, PeriodState::kFound) << period_s;
    EXPECT_NEAR(p.period_s, period_s, 5e-4 * period_s);
    EXPECT_GT(p.confidence, 0.95);
    EXPECT_GT(p.height, 0.9);
  }
}

TEST(PeriodMeter, FindsItUnderNoiseOfTwiceItsPower) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    sim::Random random{seed, sim::Stream::kSensors};
    Meter m = Meter::make(kPeriodStepS, 1).value();
    for (int i = 0; i < 60000; ++i) {
      const double s = std::sin(2.0 * std::numbers::pi * i * kPeriodStepS / 0.31);
      m.update(s + random.normal());
    }
    const Period p = m.period();
    ASSERT_EQ(p.state, PeriodState::kFound);
    EXPECT_NEAR(p.period_s, 0.31, 1e-3);
    EXPECT_NEAR(p.height, 1.0 / 3.0, 0.03);
  }
}

TEST(PeriodMeter, FindsNoneInNoiseNorInAResonanceThatNoiseKeepsAlive) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    sim::Random random{seed, sim::Stream::kSensors};
    Resonance damped{2.7, 0.1, seed};
    Resonance sharp{2.7, 0.02, seed};
    Meter white = meter();
    Meter broad = meter();
    Meter narrow = meter();
    for (int i = 0; i < 60000; ++i) {
      white.update(random.normal());
      broad.update(damped.next());
      narrow.update(sharp.next());
    }
    EXPECT_EQ(white.period().state, PeriodState::kNone) << seed;
    EXPECT_EQ(broad.period().state, PeriodState::kNone) << seed;
    EXPECT_EQ(narrow.period().state, PeriodState::kNone) << seed;
    EXPECT_EQ(narrow.period().period_s, 0.0);
  }
}

TEST(PeriodMeter, SaysNoMotionAndNotEnough) {
  Meter still = meter();
  Meter shortly = meter();
  for (int i = 0; i < 36000; ++i) still.update(0.3);
  for (int i = 0; i < 6000; ++i) shortly.update(tone(i * kPeriodStepS, 0.4));
  EXPECT_EQ(still.period().state, PeriodState::kNoMotion);
  EXPECT_EQ(shortly.period().state, PeriodState::kNotEnough);
  EXPECT_FALSE(Meter::make(0.0, 1).ok());
  EXPECT_FALSE(Meter::make(0.01, 0).ok());
}

TEST(PeriodMeter, GoesOnAfterAGap) {
  Meter m = meter();
  for (int i = 0; i < 40000; ++i) {
    const bool lost = i % 9000 == 8999;
    m.update(lost ? std::numeric_limits<double>::quiet_NaN() : tone(i * kPeriodStepS, 0.4));
  }
  EXPECT_EQ(m.period().state, PeriodState::kFound);
  EXPECT_NEAR(m.period().period_s, 0.4, 4e-4);
}

}  // namespace
}  // namespace dampline
