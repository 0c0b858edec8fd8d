// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>

#include "dampline/effect/modes.hpp"

namespace dampline::effect {
namespace {

constexpr double kBankStepS = 1.0 / 1200.0;
constexpr std::size_t kMode = 4;  // 12 Hz, 0.8 mm

double velocity_mps(double t) { return 0.02 * std::sin(15.0 * t) + 0.008 * std::sin(41.0 * t); }
double turn_mps2(double t) { return 2.5 * std::sin(73.0 * t) + 2.0 * std::sin(29.0 * t + 1.0); }

/// The same equation by brute force: sign v as a steep tanh, Heun's steps of 8 us.
class Truth {
 public:
  /// Mean of (sign(v + 2 d') + sign(v - 2 d')) / 2 over a step that is centred on t.
  double vertical_share(double t) {
    constexpr int kFine = 100;
    constexpr double kFineS = kBankStepS / kFine;
    double sum = 0.0;
    for (int i = 0; i < kFine; ++i) {
      const double now = t - 0.5 * kBankStepS + i * kFineS;
      const double first = acceleration(now, angle_, rate_);
      const double guess = rate_ + kFineS * first;
      const double second = acceleration(now + kFineS, angle_ + kFineS * rate_, guess);
      angle_ += 0.5 * kFineS * (rate_ + guess);
      rate_ += 0.5 * kFineS * (first + second);
      const double v = velocity_mps(now + kFineS);
      sum += 0.5 * (sign(v + 2.0 * rate_) + sign(v - 2.0 * rate_));
    }
    return sum / kFine;
  }

 private:
  static double sign(double v) { return std::tanh(v / 0.5e-3); }
  static double acceleration(double t, double d, double rate) {
    const double omega = 2.0 * 3.141592653589793238 * kPitch[kMode].frequency_hz;
    const double v = velocity_mps(t);
    const double opposed = 0.5 * (sign(v + 2.0 * rate) - sign(v - 2.0 * rate));
    return turn_mps2(t) - omega * omega * (d + kPitch[kMode].slip_m * opposed) -
           2.0 * kPitchDamping * omega * rate;
  }
  double angle_{0.0};
  double rate_{0.0};
};

TEST(PitchBank, FrictionThatTurnsTheFrameIsThatOfFineSteps) {
  PitchBank bank{kBankStepS};
  Truth truth;
  double error = 0.0;
  double moved = 0.0;
  for (int n = 0; n < 6000; ++n) {
    const double t = n * kBankStepS;
    bank.update(velocity_mps(t), turn_mps2(t));
    const double want = std::abs(truth.vertical_share(t));
    const double got = 1.0 - bank.opposed(kMode);
    error += (got - want) * (got - want);
    moved += (1.0 - want) * (1.0 - want);
  }
  EXPECT_GT(moved, 600.0);  // the frame does pitch
  EXPECT_LT(std::sqrt(error / moved), 0.15);
}

TEST(PitchBank, NoTurnNoPitch) {
  PitchBank bank{kBankStepS};
  for (int n = 0; n < 600; ++n) bank.update(velocity_mps(n * kBankStepS), 0.0);
  for (std::size_t i = 0; i < kPitchModes; ++i) EXPECT_EQ(bank.opposed(i), 0.0);
}

}  // namespace
}  // namespace dampline::effect
