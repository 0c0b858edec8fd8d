// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>

#include "dampline/effect/gram.hpp"

namespace dampline::effect {

/// Watches the residual of friction and spring, row by row at one short scale, for the rare large
/// values that impacts leave. The two coefficients are those of all rows so far; the residual's
/// ordinary size is its running median, which impacts hardly move.
class ImpulseMeter {
 public:
  static constexpr std::size_t kScale = 3;           ///< about 16 Hz: a window of 0.17 s
  static constexpr double kLargeInDeviations = 6.0;  ///< of a normal residual of the same median
  static constexpr std::int64_t kApart = 45;         ///< samples between two events

  void update(std::int64_t tick, const Row& row) noexcept {
    const double friction = row[kSign + kWidth];
    const double spring = 2.0 * row[kFrameTwice] - row[kWheelset1Twice] - row[kWheelset2Twice];
    const double target = row[kTarget];
    ff_ += friction * friction;
    fs_ += friction * spring;
    ss_ += spring * spring;
    ft_ += friction * target;
    st_ += spring * target;
    if (++rows_ < kSettle) return;
    const double determinant = ff_ * ss_ - fs_ * fs_;
    const double a = (ft_ * ss_ - st_ * fs_) / determinant;
    const double b = (st_ * ff_ - ft_ * fs_) / determinant;
    judge(tick, std::abs(target - a * friction - b * spring));
  }

  [[nodiscard]] std::uint64_t events() const noexcept { return events_; }
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
  /// Share of the residual's energy that lies in large values.
  [[nodiscard]] double share() const noexcept { return all_ > 0.0 ? large_ / all_ : 0.0; }

 private:
  static constexpr int kWidth = 3;  // 2 mm/s
  static constexpr std::uint64_t kSettle = 400;
  static constexpr double kMedianOfNormal = 0.67449;

  void judge(std::int64_t tick, double magnitude) noexcept {
    if (median_ == 0.0) median_ = magnitude;
    const double step = std::fmax(0.002, 4.0 / static_cast<double>(rows_ - kSettle + 8));
    median_ *= magnitude > median_ ? 1.0 + step : 1.0 - step;
    if (rows_ < 2 * kSettle) return;
    all_ += magnitude * magnitude;
    if (magnitude < kLargeInDeviations / kMedianOfNormal * median_) return;
    large_ += magnitude * magnitude;
    if (tick - last_event_ >= kApart) ++events_;
    last_event_ = tick;
  }

  double ff_{0.0}, fs_{0.0}, ss_{0.0}, ft_{0.0}, st_{0.0};
  std::uint64_t rows_{0};
  double median_{0.0};
  double all_{0.0};
  double large_{0.0};
  std::uint64_t events_{0};
  std::int64_t last_event_{-1000};
};

}  // namespace dampline::effect
