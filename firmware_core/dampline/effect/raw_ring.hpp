// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstdint>

#include "dampline/motion/drift_free_integral.hpp"
#include "dampline/sample.hpp"

namespace dampline::effect {

/// The last accelerations by tick, and the wheelsets' velocities without drift, which follow some
/// two seconds later.
class RawRing {
 public:
  struct Entry {
    std::array<double, kChannels> accel_mps2{};
    std::array<double, 2> wheelset_mps{};
  };

  explicit RawRing(double sample_rate_hz) noexcept
      : integral_{DriftFreeIntegral{sample_rate_hz}, DriftFreeIntegral{sample_rate_hz}} {}

  void push(const Sample& sample) noexcept {
    bool finite = true;
    for (const double a : sample.accel_mps2) finite = finite && std::isfinite(a);
    Entry& entry = ring_[index(sample.tick)];
    if (!finite || sample.tick != last_tick_ + 1) {
      for (DriftFreeIntegral& integral : integral_) integral.reset();
    }
    last_tick_ = sample.tick;
    if (!finite) return;  // what needs this sample is never asked for
    entry.accel_mps2 = sample.accel_mps2;
    for (std::size_t w = 0; w < 2; ++w) {
      double velocity_mps = 0.0;
      if (integral_[w].update(sample.accel_mps2[1 + w], velocity_mps)) {
        ring_[index(sample.tick - integral_[w].delay())].wheelset_mps[w] = velocity_mps;
      }
    }
  }
  /// Of the last kLength ticks.
  [[nodiscard]] const Entry& at(std::int64_t tick) const noexcept { return ring_[index(tick)]; }

 private:
  static constexpr std::size_t kLength = 4096;
  static std::size_t index(std::int64_t tick) noexcept {
    return static_cast<std::size_t>(tick) & (kLength - 1);
  }
  std::array<DriftFreeIntegral, 2> integral_;
  std::int64_t last_tick_{-2};
  std::array<Entry, kLength> ring_{};
};

}  // namespace dampline::effect
