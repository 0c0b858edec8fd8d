// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

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

}  // namespace dampline
