// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

#include "dampline/motion/anti_alias.hpp"
#include "tests/steps.hpp"

namespace dampline {
namespace {

/// Tap k weighs the sample k before the centre.
std::complex<double> response(const VelocityLift& lift, double relative) {
  std::complex<double> sum{};
  for (int k = -VelocityLift::kHalf; k <= VelocityLift::kHalf; ++k) {
    sum += lift.taps()[static_cast<std::size_t>(k + VelocityLift::kHalf)] *
           std::polar(1.0, -2.0 * std::numbers::pi * relative * k);
  }
  return sum;
}
double gain(const VelocityLift& lift, double relative) {
  const std::complex<double> all = response(lift, relative);
  return std::copysign(std::abs(all), all.real());
}

TEST(VelocityLift, DoesNothingWhereNoFilterIsKnown) {
  const VelocityLift lift{{.corner_hz = 0.0}, 300.0};
  for (int k = -VelocityLift::kHalf; k <= VelocityLift::kHalf; ++k)
    EXPECT_EQ(lift.taps()[static_cast<std::size_t>(k + VelocityLift::kHalf)], k == 0 ? 1.0 : 0.0);
}

TEST(VelocityLift, LiftsForAnyCornerThatIsKnown) {
  EXPECT_NE(VelocityLift({.corner_hz = 0.4}, 300.0).taps(),
            VelocityLift({.corner_hz = 0.0}, 300.0).taps());
}

/// The weighted squared error of a symmetric filter against its target: the share of the loss up to
/// the corner, but 0.4 of the rate at most, from there a raised cosine down to nothing at half the
/// rate, which counts 0.02.
double error_of(const std::array<double, VelocityLift::kHalf + 1>& cosines, double corner,
                int order) {
  const double edge = std::min(corner, 0.4);
  double error = 0.0;
  for (int i = 0; i < 512; ++i) {
    const double f = (i + 0.5) / 1024.0;
    const double beyond = f > edge ? (f - edge) / (0.5 - edge) : 0.0;
    const double lift = std::pow(1.0 + std::pow(f / corner, 2 * order), 0.5 * 0.60);
    double off = -lift * 0.5 * (1.0 + std::cos(std::numbers::pi * beyond));
    for (std::size_t k = 0; k < cosines.size(); ++k)
      off += cosines[k] * std::cos(2.0 * std::numbers::pi * f * static_cast<double>(k));
    error += (f > edge ? 0.02 : 1.0) * off * off;
  }
  return error;
}

// No other filter of its length that leaves zero frequency alone has less: exchanging a little of
// any two cosines makes the error larger, both ways alike.
TEST(VelocityLift, IsTheLeastSquaresFitOfItsTarget) {
  constexpr double kPart = 1e-3;
  for (const AntiAliasConfig& target : {AntiAliasConfig{.corner_hz = 100.0, .order = 4},
                                        AntiAliasConfig{.corner_hz = 120.0, .order = 2},
                                        AntiAliasConfig{.corner_hz = 140.0, .order = 6}}) {
    const VelocityLift lift{target, 300.0};
    std::array<double, VelocityLift::kHalf + 1> cosines{};
    for (std::size_t k = 0; k < cosines.size(); ++k)
      cosines[k] = (k == 0 ? 1.0 : 2.0) * lift.taps()[VelocityLift::kHalf + k];
    const double least = error_of(cosines, target.corner_hz / 300.0, target.order);
    for (std::size_t k = 1; k < cosines.size(); ++k) {
      const auto rise = [&](double part) {
        auto other = cosines;
        other[k] += part;
        other[k - 1] -= part;
        return error_of(other, target.corner_hz / 300.0, target.order) - least;
      };
      const double up = rise(kPart);
      const double down = rise(-kPart);
      EXPECT_GT(std::min(up, down), 0.0) << target.corner_hz << ", " << k;
      EXPECT_NEAR(0.5 * kPart * (down - up) / (down + up), 0.0, 1e-7)
          << target.corner_hz << ", " << k;
    }
  }
}

TEST(VelocityLift, LeavesZeroFrequencyAlone) {
  for (const double corner_hz : {50.0, 80.0, 100.0, 120.0, 140.0}) {
    const VelocityLift lift{{.corner_hz = corner_hz}, 300.0};
    EXPECT_NEAR(gain(lift, 0.0), 1.0, 1e-6) << corner_hz;
  }
}

TEST(VelocityLift, IsSymmetricBehindTheUsualFilterAndHigherOnes) {
  for (const double corner_hz : {100.0, 120.0}) {
    const VelocityLift lift{{.corner_hz = corner_hz}, 300.0};
    for (std::size_t k = 0; k < lift.taps().size(); ++k)
      EXPECT_EQ(lift.taps()[k], lift.taps()[lift.taps().size() - 1 - k]);
  }
}

/// Of an analogue Butterworth filter of fourth order, unwrapped, without the part that is straight
/// at low frequencies: from the polynomial of its two sections.
double phase_beside_delay(double relative) {
  const double first = 2.0 * std::sin(std::numbers::pi / 8.0);
  const double second = 2.0 * std::sin(3.0 * std::numbers::pi / 8.0);
  const auto section = [&](double damping) {
    return std::atan2(damping * relative, 1.0 - relative * relative);
  };
  return (first + second) * relative - section(first) - section(second);
}

// Four fifths of what a filter below 100 Hz delays the fast parts beyond what that one does.
TEST(VelocityLift, UndoesThePhaseOfALowCornerBeyondTheUsualOne) {
  for (const double corner_hz : {50.0, 60.0, 80.0}) {
    const VelocityLift lift{{.corner_hz = corner_hz}, 300.0};
    for (const double f_hz : steps(0.0, 0.9 * corner_hz, 5.0)) {
      const double beyond = phase_beside_delay(f_hz / corner_hz) - phase_beside_delay(f_hz / 100.0);
      EXPECT_NEAR(std::arg(response(lift, f_hz / 300.0)), -0.8 * beyond, 0.01)
          << f_hz << " of " << corner_hz;
    }
  }
}

// 60 % of the 3.01 dB at the corner, where the fit is within 0.1 dB (docs/adr/0003-anti-alias.md).
TEST(VelocityLift, LiftsBySixtyPercentOfTheLoss) {
  const VelocityLift lift{{}, 300.0};
  EXPECT_NEAR(20.0 * std::log10(gain(lift, 95.0 / 300.0)), 0.60 * 2.21, 0.1);
}

// The share itself is tuned on simulated records; that it is one share at all frequencies, corners
// and orders is what the filter is for.
TEST(VelocityLift, RaisesByOneShareOfTheButterworthLossUpToTheCorner) {
  const auto loss_db = [](double relative, int order) {
    return 10.0 * std::log10(1.0 + std::pow(relative, 2 * order));
  };
  const VelocityLift reference{{.corner_hz = 100.0, .order = 4}, 300.0};
  const double share = 20.0 * std::log10(gain(reference, 0.3)) / loss_db(0.9, 4);
  EXPECT_GT(share, 0.1);
  EXPECT_LT(share, 0.6);
  for (const int order : {2, 4, 6}) {
    for (const double corner_hz : {100.0, 115.0, 130.0}) {
      const VelocityLift lift{{.corner_hz = corner_hz, .order = order}, 300.0};
      for (const double f_hz : steps(0.0, 0.9 * corner_hz, 5.0)) {
        EXPECT_NEAR(20.0 * std::log10(gain(lift, f_hz / 300.0)),
                    share * loss_db(f_hz / corner_hz, order), 0.15)
            << f_hz << " of " << corner_hz << " Hz, order " << order;
      }
    }
  }
}

// Wheelsets shake most at 45 to 75 Hz, so what a low corner takes there comes back whole, and 5 %
// more of the decibels for each 24 Hz below 76.
TEST(VelocityLift, UndoesALowCornerWholly) {
  for (const double corner_hz : {50.0, 60.0, 70.0}) {
    const VelocityLift lift{{.corner_hz = corner_hz}, 300.0};
    for (const double f_hz : steps(0.0, 0.9 * corner_hz, 5.0)) {
      const double share = 1.0 + 0.05 * (76.0 - corner_hz) / 24.0;
      const double loss = std::pow(1.0 + std::pow(f_hz / corner_hz, 8), 0.5 * share);
      EXPECT_NEAR(gain(lift, f_hz / 300.0), loss, 0.03) << f_hz << " of " << corner_hz;
    }
  }
}

TEST(VelocityLift, DoesNotAmplifyWhatLiesBeyondTheEdge) {
  const VelocityLift lift{{}, 300.0};
  for (const double f_hz : steps(0.0, 150.0, 1.0)) EXPECT_LT(gain(lift, f_hz / 300.0), 1.3);
  EXPECT_LT(std::abs(gain(lift, 0.5)), 0.05);
}

}  // namespace
}  // namespace dampline
