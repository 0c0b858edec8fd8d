// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/numeric/log_histogram.hpp"

namespace dampline {

/// A jump of a channel's zero.
struct LevelJump {
  std::int64_t tick{0};
  double size_mps2{0.0};
};

/// One channel's means over a second; a jump is a difference between the five seconds after and the
/// five before one second that stands out from all such differences.
class LevelWatch {
 public:
  explicit LevelWatch(std::int64_t second_samples) noexcept : second_{second_samples} {}
  /// True when it wrote a jump, some 10 s after it happened.
  bool update(std::int64_t tick, double accel_mps2, LevelJump& jump) noexcept;
  void restart() noexcept;

 private:
  static constexpr std::size_t kSide = 5;
  static constexpr std::size_t kSeconds = 2 * kSide + 1;
  [[nodiscard]] bool end_second(std::int64_t tick, LevelJump& jump) noexcept;

  std::int64_t second_;
  std::int64_t samples_{0};
  double sum_{0.0};
  std::array<double, kSeconds> mean_{};  // oldest first
  std::size_t seconds_{0};
  MagnitudeHistogram differences_;  // in 0.1 mm/s^2
  LevelJump peak_{};                // the largest of a run of outstanding differences
  int since_peak_{-1};              // seconds; -1: there is none
};

}  // namespace dampline
