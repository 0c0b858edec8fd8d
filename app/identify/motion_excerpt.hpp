// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "dampline/snapshot.hpp"

namespace dampline::app {

/// The first stretch of kLengthSeconds without a gap in which the truck really moves; where there
/// is none, the liveliest or, of a short record, the longest that there is. Bounded memory.
class MotionExcerpt {
 public:
  static constexpr double kLengthSeconds = 20.0;

  explicit MotionExcerpt(double sample_rate_hz);
  void take(const Motion& motion);
  /// Consecutive ticks; empty when there was no motion at all.
  [[nodiscard]] const std::vector<Motion>& best() const noexcept;

 private:
  static constexpr double kLivelyRmsMps = 4e-3;
  void judge();

  std::size_t length_;
  std::vector<Motion> current_;
  std::vector<Motion> best_;
  double current_sum_{0.0};  // of v^2, (m/s)^2
  double best_sum_{-1.0};
  bool settled_{false};
};

}  // namespace dampline::app
