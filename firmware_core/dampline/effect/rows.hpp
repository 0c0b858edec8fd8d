// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>

#include "dampline/basis/window_bank.hpp"
#include "dampline/damping/turn.hpp"
#include "dampline/effect/gram_store.hpp"
#include "dampline/effect/laws.hpp"
#include "dampline/motion/drift_free_integral.hpp"
#include "dampline/sample.hpp"

namespace dampline::effect {

/// The last accelerations by tick, and the wheelsets' velocities without drift, which follow some
/// two seconds later.
class RawRing {
 public:
  struct Entry {
    std::array<double, kChannels> accel_mps2{};
    double pushed_mps2{0.0};  ///< z_b'' with what the far truck's share of the body adds
    double end_mps2{0.0};     ///< the frame's turn where it is known (TurnMotion)
    double turn_mps{0.0};
    double turn_m{0.0};
    std::array<double, 2> wheelset_mps{};
  };

  RawRing(double sample_rate_hz, double far_share, bool knows_turn) noexcept
      : integral_{DriftFreeIntegral{sample_rate_hz}, DriftFreeIntegral{sample_rate_hz},
                  DriftFreeIntegral{sample_rate_hz}},
        turn_{sample_rate_hz, TurnPath::kFaster},
        far_share_{far_share},
        knows_turn_{knows_turn} {}

  void push(const Sample& sample) noexcept {
    bool finite = true;
    for (const double a : sample.accel_mps2) finite = finite && std::isfinite(a);
    Entry& entry = ring_[index(sample.tick)];
    if (!finite || sample.tick != last_tick_ + 1) {
      for (DriftFreeIntegral& integral : integral_) integral.reset();
      turn_.reset();
    }
    last_tick_ = sample.tick;
    if (!finite) return;  // what needs this sample is never asked for
    entry.accel_mps2 = sample.accel_mps2;
    entry.pushed_mps2 = pushed_mps2(sample, far_share_);
    for (std::size_t w = 0; w < 2; ++w) {
      double velocity_mps = 0.0;
      if (integral_[w].update(sample.accel_mps2[1 + w], velocity_mps)) {
        ring_[index(sample.tick - integral_[w].delay())].wheelset_mps[w] = velocity_mps;
      }
    }
    if (knows_turn_) take_turn(sample, entry);
  }
  /// Of the last kLength ticks.
  [[nodiscard]] const Entry& at(std::int64_t tick) const noexcept { return ring_[index(tick)]; }

 private:
  static constexpr std::size_t kLength = 4096;
  static std::size_t index(std::int64_t tick) noexcept {
    return static_cast<std::size_t>(tick) & (kLength - 1);
  }
  void take_turn(const Sample& sample, Entry& entry) noexcept {
    entry.end_mps2 = end_turn_mps2(sample);
    double rate_mps = 0.0;
    if (!integral_[2].update(turn_mps2(sample), rate_mps)) return;
    const std::int64_t then = sample.tick - integral_[2].delay();
    ring_[index(then)].turn_mps = rate_mps;
    double turn_m = 0.0;
    if (turn_.update(rate_mps, turn_m)) ring_[index(then - turn_.delay())].turn_m = turn_m;
  }

  std::array<DriftFreeIntegral, 3> integral_;
  DriftFreeIntegral turn_;
  double far_share_;
  bool knows_turn_;
  std::int64_t last_tick_{-2};
  std::array<Entry, kLength> ring_{};
};

/// Galerkin rows of all candidate columns, by the windows of the base estimate.
class Rows {
 public:
  using Sampled = Eigen::Matrix<float, kSampledColumns, 1>;

  explicit Rows(double sample_rate_hz) noexcept;

  [[nodiscard]] const WindowBank& bank() const noexcept { return bank_; }

  /// The averaged columns at a tick, and whether the truck stood still then.
  void set(std::int64_t tick, const Sampled& values, bool still) noexcept {
    values_[index(tick)] = values;
    still_[index(tick)] = still ? 1.0F : 0.0F;
  }

  /// What a frame's known turn adds at a tick; per unit of mass.
  void set_turn(std::int64_t tick, double spring_m, double push_mps2) noexcept {
    turn_[index(tick)] = {spring_m, push_mps2};
    any_turn_ = true;
  }
  [[nodiscard]] const Sampled& values(std::int64_t tick) const noexcept {
    return values_[index(tick)];
  }

  /// The row of a scale centred on a tick. Needs the columns at tick - half...tick + half and the
  /// accelerations one further on each side.
  [[nodiscard]] Row row(std::size_t scale, std::int64_t tick, const RawRing& raw) const noexcept;
  /// Share of the row's weight that lies on samples at a standstill, 0...1.
  [[nodiscard]] double still_share(std::size_t scale, std::int64_t tick) const noexcept;

 private:
  static constexpr std::size_t kRing = 2 * static_cast<std::size_t>(WindowBank::kMaxHalf) + 2;
  static constexpr std::size_t kRateTable = 1104;
  static std::size_t index(std::int64_t tick) noexcept {
    return static_cast<std::size_t>(tick) % kRing;
  }
  void linear(std::size_t scale, std::int64_t tick, const RawRing& raw, Row& row) const noexcept;
  void add_turn(std::size_t scale, std::int64_t tick, Row& row) const noexcept;

  WindowBank bank_;
  std::array<std::size_t, kScales> rate_start_{};
  std::array<double, kRateTable> lumped_rate_{};  // psi' at -half-1...half+1, by scale
  std::array<Sampled, kRing> values_{};
  std::array<float, kRing> still_{};
  std::array<Turn, kRing> turn_{};
  bool any_turn_{false};
};

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
