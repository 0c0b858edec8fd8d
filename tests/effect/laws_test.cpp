// SPDX-License-Identifier: MIT
#include "dampline/effect/laws.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace dampline::effect {
namespace {

constexpr double kScaleM = 1.0e-3;
constexpr double kStepS = 1.0 / 1200.0;

Point moving(double deflection_m, double velocity_mps) {
  Point p;
  p.deflection_m = deflection_m;
  p.velocity_mps = velocity_mps;
  return p;
}

TEST(Laws, PolynomialsAndContactsAreWhatTheyAreCalled) {
  Laws laws{{.scale_m = kScaleM}, kStepS};
  const LawValues up = laws(moving(2.5e-3, 0.05));
  EXPECT_FLOAT_EQ(up[kSquare], 6.25e-6F);
  EXPECT_FLOAT_EQ(up[kCube], 15.625e-9F);
  EXPECT_FLOAT_EQ(up[kMagnitude], 2.5e-3F);
  EXPECT_FLOAT_EQ(up[kSpeedSquared], 2.5e-3F);
  EXPECT_FLOAT_EQ(up[kBumpUp + 2], 1.3e-3F);  // gap 1.2 mm
  EXPECT_EQ(up[kBumpDown + 2], 0.0F);
  const LawValues down = laws(moving(-2.5e-3, -0.05));
  EXPECT_EQ(down[kBumpUp + 2], 0.0F);
  EXPECT_FLOAT_EQ(down[kBumpDown + 2], 1.3e-3F);
  EXPECT_FLOAT_EQ(down[kSpeedSquared], -2.5e-3F);
  EXPECT_FLOAT_EQ(down[kProgressive], 2.5e-3F);           // y sign v
  EXPECT_FLOAT_EQ(down[kProgressiveAbsolute], -2.5e-3F);  // |y| sign v
}

// A cubic polynomial of time between two samples, and its slopes there; what has no slope of its
// own lies on a straight line.
TEST(Hermite, IsExactForACubicAndStraightForItsSlopes) {
  constexpr double kLongS = 0.004;
  const auto x = [](double t, double k) {
    return k * (3.0 - 2.0 * t + 5e2 * t * t - 3e4 * t * t * t);
  };
  const auto rate = [](double t, double k) { return k * (-2.0 + 1e3 * t - 9e4 * t * t); };
  const auto instant = [&](double t) {
    const auto slope = [&](double k) { return Slope{x(t, k), rate(t, k)}; };
    return Instant{slope(1.0), slope(2.0), slope(-3.0), slope(0.5), 40.0 * t};
  };
  for (const double u : {0.0, 0.25, 0.5, 0.9, 1.0}) {
    const Point p = Hermite::at(u, kLongS)(instant(0.0), instant(kLongS));
    const double t = u * kLongS;
    EXPECT_NEAR(p.deflection_m, x(t, 1.0), 1e-12);
    EXPECT_NEAR(p.velocity_mps, x(t, 2.0), 1e-12);
    EXPECT_NEAR(p.wheelset1_mps, x(t, -3.0), 1e-12);
    EXPECT_NEAR(p.wheelset2_mps, x(t, 0.5), 1e-12);
    const auto straight = [&](double k) { return (1.0 - u) * rate(0.0, k) + u * rate(kLongS, k); };
    EXPECT_NEAR(p.wheelset1_mps2, straight(-3.0), 1e-12);
    EXPECT_NEAR(p.wheelset2_mps2, straight(0.5), 1e-12);
    EXPECT_NEAR(p.turn_mps2, 40.0 * t, 1e-12);
  }
}

TEST(Laws, StribeckFrictionFadesByItsSpeed) {
  Laws laws{{.scale_m = kScaleM}, kStepS};
  const LawValues out = laws(moving(0.0, 0.024));
  for (std::size_t i = 0; i < kStribeckSpeeds; ++i)
    EXPECT_NEAR(out[kStribeck + at(i)], std::exp(-0.024 / kStribeckMps[i]), 1e-6);
}

TEST(Laws, TangentsAreTheSlopeOfTheSign) {
  Laws laws{{.scale_m = kScaleM}, kStepS};
  const int column = kSign + 3;
  ASSERT_EQ(kWidthMps[3], kInnerWidthMps);
  constexpr double kStepMps = 1e-4;
  for (const double v : {0.0, 0.7e-3, -1.6e-3}) {
    Point p = moving(0.0, v);
    p.wheelset1_mps = 0.02;
    p.wheelset2_mps2 = -1.5;
    const LawValues out = laws(p);
    const double slope = (static_cast<double>(laws(moving(0.0, v + kStepMps))[column]) -
                          static_cast<double>(laws(moving(0.0, v - kStepMps))[column])) /
                         (2.0 * kStepMps);
    EXPECT_NEAR(out[kTangent1], 0.02 * slope, 0.01 * std::abs(0.02 * slope) + 1e-4);
    EXPECT_NEAR(out[kTangentRate2], -1.5 * slope, 0.01 * std::abs(1.5 * slope) + 1e-2);
    EXPECT_NEAR(out[kTangentV], v * slope, 0.01 * std::abs(v * slope) + 1e-4);
  }
}

TEST(Laws, DahlFrictionBuildsUpOverItsDistance) {
  Laws laws{{.scale_m = kScaleM}, kStepS};
  const double step_m = 1e-6;
  double y = 0.0;
  static_cast<void>(laws(moving(y, 0.01)));
  for (int n = 0; n < 6000; ++n) static_cast<void>(laws(moving(y += step_m, 0.01)));
  // After the reversal zeta = -1 + (zeta_0 + 1) exp(-x / r), zeta_0 of the way up.
  LawValues out;
  for (int n = 0; n < 200; ++n) out = laws(moving(y -= step_m, -0.01));
  for (std::size_t i = 0; i < kDahlDistances; ++i) {
    const double r = kDahlDistance[i] * kScaleM;
    const double start = 1.0 - std::exp(-6.0e-3 / r);
    EXPECT_NEAR(out[kDahl + at(i)], -1.0 + (start + 1.0) * std::exp(-0.2e-3 / r), 1e-4) << i;
  }
}

TEST(Laws, ASpringBehindADashpotGivesWayInItsTime) {
  Laws laws{{.scale_m = kScaleM}, kStepS};
  static_cast<void>(laws(moving(0.0, 0.05)));
  // Drawn at an even speed: x = v tau (1 - exp(-t / tau)); then held: x fades.
  LawValues out;
  constexpr int kDrawn = 30;
  for (int n = 1; n <= kDrawn; ++n) out = laws(moving(0.05 * kStepS * n, 0.05));
  const auto drawn_m = [](std::size_t i) {
    return 0.05 * kRelaxationS[i] * (1.0 - std::exp(-kDrawn * kStepS / kRelaxationS[i]));
  };
  for (std::size_t i = 0; i < kRelaxations; ++i)
    EXPECT_NEAR(out[kRelaxing + at(i)], drawn_m(i), 1e-6 * drawn_m(i)) << i;
  for (int n = 0; n < 12; ++n) out = laws(moving(0.05 * kStepS * kDrawn, 0.0));
  for (std::size_t i = 0; i < kRelaxations; ++i)
    EXPECT_NEAR(out[kRelaxing + at(i)], drawn_m(i) * std::exp(-12 * kStepS / kRelaxationS[i]),
                1e-6 * drawn_m(i))
        << i;
  laws.reset();
  EXPECT_EQ(laws(moving(0.3, 0.0))[kRelaxing], 0.0F);
}

TEST(Laws, BacklashHoldsNothingUntilTheGapIsTakenUp) {
  Laws laws{{.scale_m = kScaleM}, kStepS};
  const double gap_m = kBacklashGap[4] * kScaleM;
  const int column = kBacklash + 4;
  double y = 0.0;
  LawValues out;
  for (int n = 0; n <= 1000; ++n) out = laws(moving(y = n * 2e-6, 0.05));
  EXPECT_FLOAT_EQ(out[column], 1.0F);
  const double top = y;
  for (double way = 0.05; way < 1.3; way += 0.05) {
    out = laws(moving(top - way * gap_m, -0.05));
    if (way < 0.89) {
      EXPECT_EQ(out[column], 0.0F) << way;
    } else if (way > 1.01) {
      EXPECT_FLOAT_EQ(out[column], -1.0F) << way;
    }
  }
}

// An end that yields does not hold a slow truck with its whole force.
TEST(Laws, APlayHasTheWidthOfItsLine) {
  Grids grids{.scale_m = kScaleM};
  for (std::size_t i = kFineGaps; i < kBacklashGaps; ++i) grids.play[i].width_mps = 8e-3;
  Laws laws{grids, kStepS};
  constexpr double kSlowMps = 4e-3;
  LawValues out;
  for (int n = 0; n <= 2000; ++n) out = laws(moving(n * 2e-6, kSlowMps));
  for (std::size_t i = 0; i < kBacklashGaps; ++i)
    EXPECT_NEAR(out[kBacklash + at(i)],
                std::erf(0.5 * std::sqrt(M_PI) * kSlowMps / grids.play[i].width_mps), 1e-5)
        << i;
}

// A mass at the speed of the width comes to rest as the end's force is whole: energy against work.
TEST(Laws, AnEndYieldsAsFarAsItStopsAMass) {
  EXPECT_EQ(end_yields_m(kInnerWidthMps, 0.2), 0.0) << "no more than the velocity's error";
  EXPECT_EQ(end_yields_m(6e-3, 0.0), 0.0);
  const double own_mps = std::sqrt(6e-3 * 6e-3 - kInnerWidthMps * kInnerWidthMps);
  const double yields_m = end_yields_m(6e-3, 0.2);
  double s_m = 0.0;
  double v_mps = own_mps;
  for (double step_s = 1e-7; v_mps > 0.0; s_m += step_s * v_mps)
    v_mps -= step_s * 2.0 * 0.2 * s_m / yields_m;  // y'' = -2 F / M
  EXPECT_NEAR(s_m, yields_m, 1e-4 * yields_m);
}

TEST(Laws, PitchTurnsAroundNoFrictionUntilOneDamperSlidesBack) {
  Laws laws{{.scale_m = kScaleM}, kStepS};
  const Point p = moving(0.0, 0.02);
  EXPECT_NEAR(laws(p)[kPitchSign], 1.0, 1e-6);  // nothing turns the frame
  Point turned = p;
  turned.turn_mps2 = 200.0;  // beyond what friction holds, at 19 Hz: 5.7 m/s^2
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(laws(turned)[kPitchSign + 2], 0.0, 1e-6);
}

}  // namespace
}  // namespace dampline::effect
