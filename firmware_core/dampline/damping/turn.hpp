// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/basis/smooth_sign.hpp"
#include "dampline/motion/anti_alias.hpp"
#include "dampline/motion/drift_free_integral.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// What pitch does to the friction of a frame that turns, where an accelerometer at its end shows
/// it. With d = a theta - (z_1 - z_2) / 2 the dampers over the wheelsets slide at v + 2 d' and
/// v - 2 d'; f_1 and f_2 are their forces, J = I / a^2:
///   M z_b'' + k y + (f_1 + f_2) / 2 = 0,   J a theta'' + 2 k d + (f_1 - f_2) / 2 = 0.
/// The faster one slides as v does, F sign v; the other, which may stick, is known by the second
/// equation. With s = sign(v d'), that the first is the faster one:
///   M z_b'' + k y + F sign v + s (J a theta'' + 2 k d) = 0.
struct Turn {
  double spring_m{0.0};   ///< 2 s d, beside y
  double push_mps2{0.0};  ///< s a theta''
};

/// The frame's turning at one instant.
struct TurnMotion {
  double velocity_mps{0.0};  ///< v
  double rate_mps{0.0};      ///< d'
  double turn_m{0.0};        ///< d
  double end_mps2{0.0};      ///< a theta''
};

/// Means of Turn by the hat function that the friction law goes through (LawAverage).
class TurnMean {
 public:
  /// Takes the instant of sample n; returns the mean at n - 1.
  Turn update(const TurnMotion& now) noexcept {
    const Turn p0 = between(now, 0.0);
    const Turn p1 = between(now, 0.25);
    const Turn p2 = between(now, 0.5);
    const Turn p3 = between(now, 0.75);
    Turn mean = from_left_;
    add(mean, p0, 0.25);
    add(mean, p1, 0.1875);
    add(mean, p2, 0.125);
    add(mean, p3, 0.0625);
    from_left_ = {};
    add(from_left_, p1, 0.0625);
    add(from_left_, p2, 0.125);
    add(from_left_, p3, 0.1875);
    last_ = now;
    return mean;
  }

 private:
  static constexpr double kWidthMps = 1.0e-3;      // of v's sign
  static constexpr double kRateWidthMps = 0.5e-3;  // of d's
  // Where v is so much faster than 2 d', both slide one way and the second equation is but noise.
  static constexpr double kMarginMps = 10.0e-3;
  static constexpr double kMarginWidthMps = 3.0e-3;

  static void add(Turn& sum, const Turn& part, double weight) noexcept {
    sum.spring_m += weight * part.spring_m;
    sum.push_mps2 += weight * part.push_mps2;
  }
  [[nodiscard]] Turn between(const TurnMotion& now, double u) const noexcept {
    const auto at = [&](double a, double b) { return a + u * (b - a); };
    const double v = at(last_.velocity_mps, now.velocity_mps);
    const double rate = at(last_.rate_mps, now.rate_mps);
    const double slack_mps = kMarginMps + 2.0 * std::abs(rate) - std::abs(v);
    const double opposed = 0.5 + 0.5 * smooth_sign(slack_mps, kMarginWidthMps);
    const double s = opposed * smooth_sign(v, kWidthMps) * smooth_sign(rate, kRateWidthMps);
    return {2.0 * s * at(last_.turn_m, now.turn_m), s * at(last_.end_mps2, now.end_mps2)};
  }

  TurnMotion last_{};
  Turn from_left_{};
};

/// From accelerations to d' by the way of the velocity, and on to d, delay() samples later.
class TurnPath {
 public:
  static constexpr double kFaster = 4.0;  ///< corner of d over that of d'

  TurnPath(const VelocityLift::Taps& taps, double sample_rate_hz) noexcept
      : lift_{taps}, rate_{sample_rate_hz}, turn_{sample_rate_hz, kFaster} {}

  void set_corner(Baseline::Corner corner) noexcept { rate_.set_corner(corner); }
  /// Of d after d'.
  [[nodiscard]] int delay() const noexcept { return turn_.delay(); }
  /// Sample n of a stretch; true when d is known, of the sample whose d' came delay() calls ago.
  bool take(const Sample& sample, std::int64_t n) noexcept {
    end_mps2_[slot(n)] = static_cast<float>(end_turn_mps2(sample));
    double accel_mps2 = 0.0;
    double rate_mps = 0.0;
    if (!lift_.update(turn_mps2(sample), accel_mps2) || !rate_.update(accel_mps2, rate_mps))
      return false;
    const std::int64_t then = n - VelocityLift::kHalf - rate_.delay();
    rate_mps_[slot(then)] = static_cast<float>(rate_mps);
    return turn_.update(rate_mps, turn_m_);
  }
  /// The mean at n - 1. Precondition: n is the sample that take() knew d of.
  [[nodiscard]] Turn mean(std::int64_t n, double velocity_mps) noexcept {
    return mean_.update({velocity_mps, rate_mps_[slot(n)], turn_m_, end_mps2_[slot(n)]});
  }
  void reset() noexcept {
    lift_.reset();
    rate_.reset();
    turn_.reset();
  }

 private:
  static constexpr std::size_t kHistory = 1024;
  static std::size_t slot(std::int64_t n) noexcept {
    return static_cast<std::size_t>(n) % kHistory;
  }

  Fir<VelocityLift::kHalf> lift_;
  DriftFreeIntegral rate_;
  DriftFreeIntegral turn_;  // pitch is faster than what drifts: from 3 Hz on
  TurnMean mean_;
  double turn_m_{0.0};
  std::array<float, kHistory> rate_mps_{};
  std::array<float, kHistory> end_mps2_{};
};

}  // namespace dampline
