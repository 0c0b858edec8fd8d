// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "app/diagnosis/common/evidence.hpp"

namespace dampline::app {
namespace {

constexpr double kMeterRateHz = 200.0;
constexpr double kMeterLengthS = 200.0;

/// Two tones without a common period; the residual is `left` of the point and of the travel since
/// the last reversal of y.
Signature signature_of(const std::function<double(EvidencePoint&, double travel_m, bool up)>& left,
                       Evidence* evidence = nullptr) {
  EvidenceMeter meter{{1.58e-3, 0.02, 5e-5, kMeterRateHz, kMeterLengthS}};
  double turned_m = 0.0;
  double last_m = 0.0;
  bool up = true;
  for (int i = 0; i < static_cast<int>(kMeterRateHz * kMeterLengthS); ++i) {
    EvidencePoint p;
    p.time_s = i / kMeterRateHz;
    const double a = 2.0 * M_PI * 1.31;
    const double b = 2.0 * M_PI * 2.917;
    p.deflection_m = 2e-3 * std::sin(a * p.time_s) + 1e-3 * std::sin(b * p.time_s + 0.4);
    p.velocity_mps = 2e-3 * a * std::cos(a * p.time_s) + 1e-3 * b * std::cos(b * p.time_s + 0.4);
    if ((p.velocity_mps > 0.0) != up) {
      turned_m = last_m;
      up = !up;
    }
    last_m = p.deflection_m;
    p.measured_n = 5000.0;
    p.base_n = 0.0;
    p.final_n = 5000.0 - left(p, std::abs(p.deflection_m - turned_m), up);
    meter.add(p);
  }
  if (evidence != nullptr) meter.fill(*evidence);
  return meter.signature();
}

TEST(Signature, TellsAnOddFunctionOfTheInstant) {
  const Signature s = signature_of([](EvidencePoint& p, double, bool) {
    return 900.0 * std::pow(p.deflection_m / 1e-3, 3) * 0.1 + 300.0 * p.velocity_mps / 0.02;
  });
  EXPECT_TRUE(s.memoryless());
  EXPECT_FALSE(s.has_memory());
  EXPECT_GT(s.surface_share, 0.85);
  EXPECT_GT(s.odd_share, 0.99);
}

TEST(Signature, TellsAnEvenFunctionOfTheInstant) {
  const Signature s = signature_of([](EvidencePoint& p, double, bool) {
    return 400.0 * std::abs(p.velocity_mps) / 0.02 - 500.0;
  });
  EXPECT_TRUE(s.memoryless());
  EXPECT_LT(s.odd_share, 0.01);
}

TEST(Signature, TellsWhatDependsOnTheTravelSinceTheReversal) {
  const Signature s = signature_of([](EvidencePoint&, double travel_m, bool up) {
    return (up ? 1000.0 : -1000.0) * std::exp(-travel_m / 0.4e-3);
  });
  EXPECT_TRUE(s.has_memory());
  EXPECT_FALSE(s.memoryless());
  EXPECT_GT(s.travel_share, 0.8);
}

TEST(Signature, FindsNoLawInNoise) {
  std::mt19937_64 random{5};
  std::normal_distribution<double> noise{0.0, 250.0};
  const Signature s = signature_of([&](EvidencePoint&, double, bool) { return noise(random); });
  EXPECT_LT(s.surface_share, 0.01);
  EXPECT_LT(s.travel_share, 0.01);
  EXPECT_NEAR(s.rms_n, 250.0, 5.0);
  for (const double c : s.coherence) EXPECT_LT(c, 0.02);
  // White: a tenth below a tenth of the half rate.
  EXPECT_NEAR(s.low_hz, 10.0, 2.0);
  EXPECT_NEAR(s.high_hz, 90.0, 2.0);
}

TEST(Signature, FindsBandTimeAndChannelOfATone) {
  std::mt19937_64 random{6};
  std::normal_distribution<double> noise{0.0, 1.0};
  const Signature s = signature_of([&](EvidencePoint& p, double, bool) {
    const double tone = std::sin(2.0 * M_PI * 37.3 * p.time_s);
    const bool burst = p.time_s > 120.0 && p.time_s < 124.0;
    p.channel[1] = tone + 0.1 * noise(random);
    p.channel[2] = noise(random);
    return (burst ? 900.0 : 300.0) * tone;
  });
  EXPECT_NEAR(s.peak_hz, 37.3, 0.3);
  EXPECT_NEAR(s.low_hz, 37.3, 1.0);
  EXPECT_NEAR(s.high_hz, 37.3, 1.0);
  EXPECT_NEAR(s.worst_time_s, 122.0, 2.5);
  EXPECT_GT(s.worst_share, 6.0);
  EXPECT_GT(s.coherence[1], 0.5);
  EXPECT_LT(s.coherence[2], 0.05);
}

TEST(Evidence, HoldsTheResidualOverEveryQuantity) {
  Evidence evidence;
  signature_of([](EvidencePoint& p, double, bool) { return 1e5 * p.deflection_m; }, &evidence);
  double energy = 0.0;
  std::size_t places = 0;
  for (const ResidualRow& r : evidence.residual) {
    if (r.over == "deflection_m") {
      EXPECT_NEAR(r.after_mean_n, 1e5 * r.place, 15.0);
      EXPECT_NEAR(r.before_rms_n, 5000.0, 1e-6);
      ++places;
    }
    if (r.over == "frequency_hz") energy += r.after_rms_n * r.after_rms_n;
  }
  EXPECT_GT(places, 15U);
  // 1e5 times the rms of y: the spectrum holds all of the energy.
  EXPECT_NEAR(std::sqrt(energy), 1e5 * std::sqrt(2.5) * 1e-3, 0.02 * 158.0);
  ASSERT_GT(evidence.loops.size(), 500U);
  EXPECT_LT(evidence.loops.back().time_s - evidence.loops.front().time_s, 12.1);
}

}  // namespace
}  // namespace dampline::app
