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
  bool update(double x, double& out) noexcept;

  void reset() noexcept {
    count_ = 0;
    instant_ = kFirstBox;
    next_box_ = box_half_ + kFirstBox * decimation_;
    knot_ = kFirstBox + kTapsHalf + 1;
    place_ = 0;
  }
  /// Subtracts a constant from everything stored; the output does not change.
  void rebase(double amount) noexcept;

  [[nodiscard]] int delay() const noexcept { return 10 * decimation_ + box_half_; }
  /// Values before this one come out never: the filters reach back that far.
  [[nodiscard]] int first() const noexcept { return (kFirstBox + kTapsHalf + 1) * decimation_; }

 private:
  static constexpr int kTapsHalf = 8;
  static constexpr int kFirstBox = 2;  // the first low-rate instant whose boxes lie in the data
  static constexpr std::size_t kRing = 1024;
  static constexpr std::size_t kMaxBox = 3 * kMaxDecimation - 2;

  [[nodiscard]] double at(std::int64_t n) const noexcept {
    return ring_[static_cast<std::size_t>(n) & (kRing - 1)];
  }
  void low_rate_step(std::int64_t instant) noexcept;

  int decimation_;
  int box_half_;
  Corner corner_{Corner::k0p7Hz};
  std::int64_t count_{0};
  // Counted along, because a division costs more than everything else that a sample needs.
  std::int64_t instant_{0};   // the next of the low rate
  std::int64_t next_box_{0};  // the sample that completes its boxes
  std::int64_t knot_{0};      // of the next value that comes out
  std::size_t place_{0};      // samples behind it
  std::array<double, kMaxBox> box_{};
  std::array<std::array<double, 4>, kMaxDecimation> spline_{};
  std::array<double, 32> low_{};          // box outputs, ring by low-rate instant
  std::array<double, 8> coefficients_{};  // spline coefficients, ring by low-rate instant
  std::array<double, kRing> ring_{};
};

}  // namespace dampline
