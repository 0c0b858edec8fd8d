// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// Running integral by a symmetric ten-point rule,
///   V_n = V_(n-1) + h sum_(j=1..5) c_j (x_(n-1+j) + x_(n-j)).
/// Its gain is within 0.4 % of an integrator's up to 0.27 of the sampling rate (80 Hz at 300 Hz); a
/// trapezoid or Simpson rule is several percent low there, which alone would bias friction by 1 %.
class ShortIntegral {
 public:
  static constexpr int kDelay = 4;  ///< the integral at sample n needs x up to n + 4
  static constexpr int kPoints = 10;

  explicit constexpr ShortIntegral(double step_s) noexcept : step_s_{step_s} {}

  /// Takes x_n; returns V_(n-4). Meaningful once kPoints values were given.
  constexpr double update(double x) noexcept {
    x_[++newest_ % kRing] = x;
    double sum = 0.0;
    for (std::size_t j = 0; j < kWeights.size(); ++j) sum += kWeights[j] * (at(4 - j) + at(5 + j));
    integral_ += step_s_ * sum;
    return integral_;
  }

  constexpr void rebase(double amount) noexcept { integral_ -= amount; }

  constexpr void reset() noexcept {
    x_.fill(0.0);
    integral_ = 0.0;
  }

 private:
  static constexpr std::size_t kRing = 16;
  /// So many samples before the newest. One by one out of a ring: four at once would have to wait
  /// for the last one written.
  [[nodiscard]] constexpr double at(std::size_t age) const noexcept {
    return x_[(newest_ - age) % kRing];
  }

  // The last weight is set so that the sum is exactly one half: a constant integrates to a ramp.
  static constexpr std::array<double, 5> kWeights{.58196271, -.11699357, .05002951, -.02081392,
                                                  .00581527};
  double step_s_;
  double integral_{0.0};
  std::array<double, kRing> x_{};
  std::size_t newest_{0};
};

/// Removes everything slower than a corner frequency from a running integral, without phase error.
///
/// The slow part is formed at a low rate: three boxes of `decimation` samples, every
/// `decimation`-th value, a symmetric 17-tap filter, and a cubic B-spline through the result.
/// Together they approach 1 / (1 + (f / corner)^8): within 0.04 at the corner; of 0.5 Hz they pass
/// 0.8. All parts are symmetric and have unit gain at zero frequency, so constants and ramps of the
/// input vanish exactly and the input may be re-based at any time. O(1) per sample but for one pass
/// over the boxes every `decimation` samples.
class Baseline {
 public:
  enum class Corner : std::uint8_t { k0p7Hz, k1p0Hz };
  static constexpr int kMaxDecimation = 69;

  explicit Baseline(int decimation) noexcept;

  /// The filter may be chosen until the first value comes out.
  void set_corner(Corner corner) noexcept { corner_ = corner; }
  [[nodiscard]] Corner corner() const noexcept { return corner_; }

  /// Takes x_n. True when `out` was set to x_(n-delay()) less its slow part.
  bool update(double x, double& out) noexcept {
    const std::int64_t n = count_++;
    ring_[static_cast<std::size_t>(n) & (kRing - 1)] = x;
    if (n == next_box_) low_rate_step();
    if (n < first_known_) return false;
    const std::array<double, 4>& b = spline_[place_];
    const double slow = b[0] * knots_[0] + b[1] * knots_[1] + b[2] * knots_[2] + b[3] * knots_[3];
    out = ring_[static_cast<std::size_t>(n - delay_) & (kRing - 1)] - slow;
    ++place_;
    return true;
  }

  void reset() noexcept {
    count_ = 0;
    instant_ = kFirstBox;
    next_box_ = box_half_ + kFirstBox * decimation_;
    place_ = 0;
  }
  /// Subtracts a constant from everything stored; the output does not change.
  void rebase(double amount) noexcept;

  [[nodiscard]] int delay() const noexcept { return delay_; }
  /// Values before this one come out never: the filters reach back that far.
  [[nodiscard]] int first() const noexcept { return (kFirstBox + kTapsHalf + 1) * decimation_; }

 private:
  static constexpr int kTapsHalf = 8;
  static constexpr int kFirstBox = 2;  // the first low-rate instant whose boxes lie in the data
  static constexpr std::size_t kRing = 1024;
  static constexpr std::size_t kMaxBox = 3 * kMaxDecimation - 2;

  void low_rate_step() noexcept;

  int decimation_;
  int box_half_;
  int delay_;
  int first_known_;  // the sample with which the first value comes out
  Corner corner_{Corner::k0p7Hz};
  std::int64_t count_{0};
  // Counted along, because a division costs more than everything else that a sample needs.
  std::int64_t instant_{0};        // the next of the low rate
  std::int64_t next_box_{0};       // the sample that completes its boxes
  std::size_t place_{0};           // of the next value that comes out, behind its knot
  std::array<double, 4> knots_{};  // the latest spline coefficients, the newest of this value
  std::array<double, kMaxBox> box_{};
  std::array<std::array<double, 4>, kMaxDecimation> spline_{};
  std::array<double, 32> low_{};  // box outputs, ring by low-rate instant
  std::array<double, kRing> ring_{};
};

/// Integral of a signal over time without drift, delay() samples late, linear in phase.
/// A constant in the input gives nothing, a ramp a small constant (2.8 ms^2 times its slope); what
/// lies a little above the corner is exact.
class DriftFreeIntegral {
 public:
  /// `sample_rate_hz` 150...400. `times` raises the corner and shortens the delay, 1 to some 5.
  explicit DriftFreeIntegral(double sample_rate_hz, double times = 1.0) noexcept
      : short_{1.0 / sample_rate_hz}, baseline_{decimation(sample_rate_hz / times)} {}

  void set_corner(Baseline::Corner corner) noexcept { baseline_.set_corner(corner); }
  [[nodiscard]] Baseline::Corner corner() const noexcept { return baseline_.corner(); }

  /// Takes x_n. True when `out` was set to the integral at n - delay().
  bool update(double x, double& out) noexcept {
    const double integral = short_.update(x);
    if (++count_ < ShortIntegral::kPoints) return false;
    const bool ready = baseline_.update(integral, out);
    if (std::abs(integral) > kRebaseAt) {
      short_.rebase(integral);
      baseline_.rebase(integral);
    }
    return ready;
  }

  void reset() noexcept {
    count_ = 0;
    short_.reset();
    baseline_.reset();
  }

  /// Of its baseline: the odd number of samples nearest to 0.17 s.
  [[nodiscard]] static int decimation(double sample_rate_hz) noexcept {
    return 2 * static_cast<int>(0.085 * sample_rate_hz) + 1;
  }
  [[nodiscard]] int delay() const noexcept { return ShortIntegral::kDelay + baseline_.delay(); }
  /// Samples before the first one that has an integral.
  [[nodiscard]] int first() const noexcept {
    return ShortIntegral::kPoints - 1 - ShortIntegral::kDelay + baseline_.first();
  }

 private:
  static constexpr double kRebaseAt = 64.0;  // far above any motion, far below loss of digits

  std::int64_t count_{0};
  ShortIntegral short_;
  Baseline baseline_;
};

}  // namespace dampline
