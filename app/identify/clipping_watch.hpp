// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "dampline/sample.hpp"

namespace dampline::app {

/// Notices channels that clip where nobody stated a full scale: motion reaches its largest value
/// once or twice, a limiter again and again. That is known only at the end, so it makes a warning,
/// not an exclusion.
class ClippingWatch {
 public:
  void take(const Sample& sample) noexcept {
    ++samples_;
    for (std::size_t c = 0; c < kChannels; ++c) {
      if ((sample.saturated >> c & 1U) != 0U) continue;  // known, and excluded
      high_[c].take(sample.accel_mps2[c]);
      low_[c].take(-sample.accel_mps2[c]);
    }
  }
  /// One sentence for every channel that seems to clip.
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Extreme {
    double value{-std::numeric_limits<double>::infinity()};
    std::uint64_t hits{0};
    /// A value that is no number compares false and leaves everything as it is.
    void take(double x) noexcept {
      if (x > value) {
        value = x;
        hits = 1;
      } else if (x == value) {
        ++hits;
      }
    }
  };
  std::array<Extreme, kChannels> high_{};
  std::array<Extreme, kChannels> low_{};
  std::uint64_t samples_{0};
};

}  // namespace dampline::app
