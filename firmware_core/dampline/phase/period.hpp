// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

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

}  // namespace dampline
