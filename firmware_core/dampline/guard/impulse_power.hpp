// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "dampline/numeric/log_histogram.hpp"

namespace dampline {

/// How much of a channel's fast motion comes in impulses, as the power of white noise that would
/// have it. The sixth difference passes what is above a third of the rate; of normal motion its
/// mean square is that which its median tells, of wheel flats it is more. So noise, which comes all
/// the time, differs from flats too weak to be seen one by one.
class ImpulsePower {
 public:
  void update(double accel_mps2) noexcept {
    std::array<double, kOrder + 1> difference{};
    difference[0] = accel_mps2;
    for (std::size_t i = 0; i < kOrder; ++i) difference[i + 1] = difference[i] - last_[i];
    last_ = difference;
    if (seen_ < kOrder) {
      ++seen_;
      return;
    }
    const double size = std::abs(difference[kOrder]);
    sum_squares_ += size * size;
    sizes_.add(static_cast<std::uint64_t>(std::min(size, kMostMps2) / kUnitMps2));
  }
  void restart() noexcept { seen_ = 0; }
  /// Of the samples since the last call, (m/s^2)^2.
  [[nodiscard]] double take() noexcept {
    const auto count = static_cast<double>(sizes_.count());
    const double usual = kMadToSigma * kUnitMps2 * sizes_.median();
    const double power = count > 0.0 ? (sum_squares_ / count - usual * usual) / kWhiteGain : 0.0;
    sizes_.clear();
    sum_squares_ = 0.0;
    return std::max(power, 0.0);
  }

 private:
  static constexpr std::size_t kOrder = 6;
  static constexpr double kWhiteGain = 924.0;  // sum of the squared binomials of order 6
  static constexpr double kMadToSigma = 1.0 / 0.6745;
  static constexpr double kUnitMps2 = 1e-3;
  static constexpr double kMostMps2 = 1e6;
  std::array<double, kOrder + 1> last_{};
  std::size_t seen_{0};
  MagnitudeHistogram sizes_;
  double sum_squares_{0.0};
};

}  // namespace dampline
