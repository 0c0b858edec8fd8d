// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "dampline/rig/config.hpp"

namespace dampline::rig {

/// One sampling instant of a rig that measures motion and force.
struct Sample {
  std::int64_t tick{0};  ///< sample number; consecutive samples differ by 1, a gap by more
  double deflection_m{0.0};
  double velocity_mps{std::numeric_limits<double>::quiet_NaN()};  ///< NaN: not measured
  double force_n{0.0};
};

[[nodiscard]] inline bool is_finite(const Sample& sample, bool velocity_measured) noexcept {
  return std::isfinite(sample.deflection_m) && std::isfinite(sample.force_n) &&
         (!velocity_measured || std::isfinite(sample.velocity_mps));
}

/// Deflection, velocity and force of one instant, with the neighbours' velocities.
struct Motion {
  std::int64_t tick{0};
  double deflection_m{0.0};
  double velocity_before_mps{0.0};
  double velocity_mps{0.0};
  double velocity_after_mps{0.0};
  double force_n{0.0};
};

/// Weights of a derivative: j (1 - (j / (h + 1))^2)^2, exact for straight lines; or sixth-order
/// differences, three samples wide and exact for x^6, where noise permits.
class DerivativeWindow {
 public:
  DerivativeWindow(int half_width, double interval_s) noexcept;
  [[nodiscard]] static DerivativeWindow sharp(double interval_s) noexcept;
  [[nodiscard]] int half_width() const noexcept { return half_width_; }
  /// Weight at +j; at -j its negative. 1/s.
  [[nodiscard]] double weight(int j) const noexcept {
    return weights_[static_cast<std::size_t>(j)];
  }
  /// Standard deviation of the derivative for white noise of standard deviation 1.
  [[nodiscard]] double noise_gain() const noexcept;

 private:
  int half_width_;
  std::array<double, kMaxVelocityHalfWidth + 1> weights_{};
};

/// Measured deflection to motion, some samples late. Holds no time across reset().
class MotionEstimator {
 public:
  explicit MotionEstimator(const Config& config) noexcept;

  /// Consecutive, finite samples. True when `out` was filled, with the motion of latency_samples()
  /// ago.
  bool update(const Sample& sample, Motion& out) noexcept;
  void reset() noexcept { seen_ = 0; }
  [[nodiscard]] int latency_samples() const noexcept { return window_.half_width() + 1; }

 private:
  static constexpr int kRing = 2 * kMaxVelocityHalfWidth + 4;

  [[nodiscard]] const Sample& ago(int samples) const noexcept;
  [[nodiscard]] double newest_velocity() const noexcept;

  DerivativeWindow window_;
  bool velocity_measured_;
  std::array<Sample, kRing> ring_{};
  std::array<double, 3> velocity_{};  ///< newest last
  int next_{0};
  int seen_{0};
};

}  // namespace dampline::rig
