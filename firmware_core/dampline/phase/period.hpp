// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/result.hpp"

namespace dampline {

enum class PeriodState : std::uint8_t {
  kNotEnough,  ///< the record is shorter than about four times the longest lag
  kNoMotion,   ///< the signal does not vary
  kNone,       ///< there is no period between four lags and a quarter of the longest lag
  kFound
};

/// The period of a signal. Without kFound, period_s and period_std_s are 0.
struct Period {
  PeriodState state{PeriodState::kNotEnough};
  double period_s{0.0};
  double period_std_s{0.0};
  /// Autocorrelation at the multiples of the period: the periodic share of the variance.
  double height{0.0};
  /// Autocorrelation at the far multiples over that at the near ones: 1 for a period, falling to 0
  /// with the memory of a resonance that noise keeps alive.
  double persistence{0.0};
  /// 1 - exp(-z^2 / 2), z the far autocorrelation in standard deviations of a signal that has no
  /// memory that long (Bartlett's formula), times persistence.
  double confidence{0.0};
};

/// Period from the autocorrelation at lags 0 .. lags - 1, each `lag_s` long, estimated from
/// `pairs` products. A resonance whose memory is far longer than the lags looks like a period.
[[nodiscard]] Period find_period(const double* correlation, int lags, std::uint64_t pairs,
                                 double lag_s) noexcept;

/// Whether the motion has the period that it is said to have: kFound with the period measured near
/// it, kNone if it has not, kNotEnough if fewer than four of it fit into the lags.
[[nodiscard]] Period confirm_period(const double* correlation, int lags, std::uint64_t pairs,
                                    double lag_s, double period_s) noexcept;

/// Autocovariance of a signal up to Lags - 1 steps of `decimation` samples, and from it the
/// signal's period. Every decimation-th sample costs Lags multiplications; nothing grows.
template <int Lags>
class PeriodMeter {
  static_assert(Lags >= 64);

 public:
  /// `step_s`: time between samples. kInvalidConfig unless it is above 0 and decimation at least 1.
  [[nodiscard]] static Result<PeriodMeter> make(double step_s, int decimation) noexcept {
    if (!(step_s > 0.0) || !std::isfinite(step_s) || decimation < 1) return Errc::kInvalidConfig;
    return PeriodMeter{step_s, decimation};
  }
  PeriodMeter() noexcept = default;  ///< of no signal, as Result holds one beside an error
  /// The same in place, for what make() takes: a meter is some 16 KiB.
  PeriodMeter(double step_s, int decimation) noexcept
      : lag_s_{step_s * decimation}, decimation_{decimation} {}

  /// Samples are equally spaced; a sample that is no number counts as a gap.
  void update(double x) noexcept {
    if (!std::isfinite(x)) return restart();
    sum_ += x;
    if (++summed_ < decimation_) return;
    push(sum_ / decimation_);
    sum_ = 0.0;
    summed_ = 0;
  }

  /// After a gap: what follows is no neighbour of what was. The statistics stay.
  void restart() noexcept {
    sum_ = 0.0;
    summed_ = 0;
    filled_ = 0;
  }

  /// Not for the sample path of a small controller: some 10 Lags operations.
  [[nodiscard]] Period period() const noexcept {
    Correlations r;
    const Period refused = correlate(r);
    if (refused.state != PeriodState::kFound) return refused;
    return find_period(r.data(), Lags, pairs_, lag_s_);
  }

  /// Whether the signal has the period that it is said to have.
  [[nodiscard]] Period confirm(double period_s) const noexcept {
    Correlations r;
    const Period refused = correlate(r);
    if (refused.state != PeriodState::kFound) return refused;
    return confirm_period(r.data(), Lags, pairs_, lag_s_, period_s);
  }

 private:
  static constexpr std::size_t kLags = static_cast<std::size_t>(Lags);
  using Correlations = std::array<double, kLags>;

  /// kFound: the autocorrelation is there; otherwise why not.
  [[nodiscard]] Period correlate(Correlations& r) const noexcept {
    if (pairs_ < 3 * static_cast<std::uint64_t>(Lags)) return {};
    const auto pairs = static_cast<double>(pairs_);
    const double mean = total_ / pairs;
    const double variance = products_[0] / pairs - mean * mean;
    if (!(variance > kRounding * (offset_ * offset_ + mean * mean)))
      return {.state = PeriodState::kNoMotion};
    for (std::size_t l = 0; l < kLags; ++l)
      r[l] = (products_[l] / pairs - mean * (lagged_[l] / pairs)) / variance;
    return {.state = PeriodState::kFound};
  }

  void push(double x) noexcept {
    if (!has_offset_) {  // keeps a large mean out of the sums
      offset_ = x;
      has_offset_ = true;
    }
    newest_ = newest_ == 0 ? kLags - 1 : newest_ - 1;
    ring_[newest_] = x - offset_;
    ring_[newest_ + kLags] = x - offset_;  // twice, so that the lags lie in one row
    if (filled_ < kLags && ++filled_ < kLags) return;
    const double* past = ring_.data() + newest_;
    const double now = past[0];
    for (std::size_t l = 0; l < kLags; ++l) {
      products_[l] += now * past[l];
      lagged_[l] += past[l];
    }
    total_ += now;
    ++pairs_;
  }

  static constexpr double kRounding = 1e-24;  // of the squares of a constant

  double lag_s_{0.0};
  int decimation_{1};
  int summed_{0};
  double sum_{0.0};
  bool has_offset_{false};
  double offset_{0.0};
  std::size_t newest_{0};
  std::size_t filled_{0};
  std::array<double, 2 * kLags> ring_{};
  std::array<double, kLags> products_{};
  std::array<double, kLags> lagged_{};
  double total_{0.0};
  std::uint64_t pairs_{0};
};

}  // namespace dampline
