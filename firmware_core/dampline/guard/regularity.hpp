// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Whether events come at multiples of one interval, as wheel flats and rail joints do and wrong
/// samples do not. Sees the newest eight intervals.
class Regularity {
 public:
  void add(std::int64_t tick) noexcept {
    if (any_) intervals_[count_++ % kKept] = std::abs(tick - last_);
    any_ = true;
    last_ = tick;
  }
  [[nodiscard]] bool regular() const noexcept {
    if (count_ < kKept) return false;
    const std::int64_t base = *std::min_element(intervals_.begin(), intervals_.end());
    if (base < kLeastTicks) return false;
    std::size_t fit = 0;
    for (const std::int64_t interval : intervals_) {
      const double turns = static_cast<double>(interval) / static_cast<double>(base);
      if (std::abs(turns - std::round(turns)) < kTolerance) ++fit;
    }
    return fit >= kFit;
  }

 private:
  static constexpr std::size_t kKept = 8;
  static constexpr std::size_t kFit = 7;
  static constexpr std::int64_t kLeastTicks = 12;
  static constexpr double kTolerance = 0.12;
  std::array<std::int64_t, kKept> intervals_{};
  std::size_t count_{0};
  bool any_{false};
  std::int64_t last_{0};
};

}  // namespace dampline
