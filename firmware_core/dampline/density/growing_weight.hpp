// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>

namespace dampline {

/// Exponential forgetting without touching what was summed: each new sample weighs a little more
/// than the last, and all sums are scaled back once in some 200 memories.
class GrowingWeight {
 public:
  /// `memory` in steps; 0: nothing is forgotten and every weight is exactly 1.
  explicit GrowingWeight(double memory) noexcept
      : growth_{memory > 0.0 ? std::exp(1.0 / memory) : 1.0}, forgets_{growth_ != 1.0} {}

  [[nodiscard]] double value() const noexcept { return weight_; }
  [[nodiscard]] bool forgets() const noexcept { return forgets_; }
  [[nodiscard]] double growth() const noexcept { return growth_; }

  /// The next sample's weight. Returns the factor that all sums must be scaled by, almost always 1.
  double step() noexcept {
    weight_ *= growth_;
    if (weight_ < kLimit) return 1.0;
    weight_ /= kLimit;
    return 1.0 / kLimit;
  }

 private:
  static constexpr double kLimit = 0x1p300;
  double growth_;
  double weight_{1.0};
  bool forgets_;
};

}  // namespace dampline
