// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Quantiles of positive numbers of unknown size: sixteen bins per factor of two, 2^-60 to 2^20, so
/// a quantile is within 2.2 % of the true one. Smaller and larger numbers count as the ends.
class LogHistogram {
 public:
  void add(double x) noexcept {
    if (!(x > 0.0)) return;
    const double place = kBinsPerOctave * (std::log2(x) - kLowest);
    const auto last = static_cast<double>(kBins - 1);
    ++bins_[static_cast<std::size_t>(std::clamp(place, 0.0, last))];
    ++count_;
  }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

  /// The number below which a share `q` of all lies; 0 without data.
  [[nodiscard]] double quantile(double q) const noexcept {
    if (count_ == 0) return 0.0;
    const double target = q * static_cast<double>(count_);
    double below = 0.0;
    std::size_t bin = 0;
    while (bin + 1 < kBins && below + static_cast<double>(bins_[bin]) < target)
      below += static_cast<double>(bins_[bin++]);
    return std::exp2(kLowest + (static_cast<double>(bin) + 0.5) / kBinsPerOctave);
  }

 private:
  static constexpr double kBinsPerOctave = 16.0;
  static constexpr double kLowest = -60.0;
  static constexpr std::size_t kBins = 1280;

  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_{0};
};

}  // namespace dampline
