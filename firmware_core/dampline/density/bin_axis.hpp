// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace dampline {

struct BinRange {
  double low{0.0};         ///< left end of the first bin
  double high{0.0};        ///< right end of the last; low = high = 0: learned during the warm-up
  double resolution{0.0};  ///< learned ranges: the bin width to begin with, > 0
  std::uint32_t warm_up_samples{0};  ///< learned ranges: how long the range may grow, > 0
};

/// Equal bins over a range that is given or learned.
///
/// A learned range is symmetric about zero and begins with bins of the width `resolution`. A sample
/// outside doubles every bin as often as it takes, neighbours in pairs becoming one, so that no
/// sample is forgotten and nothing has to be stored. After the warm-up the range holds half as much
/// again as the largest sample of it, and is fixed.
template <std::size_t Bins>
class BinAxis {
  static_assert(Bins >= 4 && Bins % 4 == 0, "pairs of bins must not straddle zero");

 public:
  static constexpr int kBelow = -1;
  static constexpr int kAbove = static_cast<int>(Bins);

  [[nodiscard]] static bool valid(const BinRange& range) noexcept {
    if (!std::isfinite(range.low) || !std::isfinite(range.high)) return false;
    if (range.low == 0.0 && range.high == 0.0) {
      return range.resolution > 0.0 && std::isfinite(range.resolution) && range.warm_up_samples > 0;
    }
    return range.low < range.high;
  }

  /// Precondition: valid(range).
  explicit BinAxis(const BinRange& range) noexcept {
    if (range.low < range.high) {
      low_ = range.low;
      set_width((range.high - range.low) / static_cast<double>(Bins));
    } else {
      low_ = -0.5 * static_cast<double>(Bins) * range.resolution;
      set_width(range.resolution);
      to_learn_ = range.warm_up_samples;
    }
  }

  /// Where x lies: from 0 up to Bins inside the range.
  [[nodiscard]] double place(double x) const noexcept { return (x - low_) * per_width_; }
  /// Of a place, not of a NaN.
  [[nodiscard]] static bool inside(double place) noexcept {
    return place >= 0.0 && place < static_cast<double>(Bins);
  }

  /// Bin of x, kBelow or kAbove. x must be finite.
  [[nodiscard]] int locate(double x) const noexcept {
    const double place = this->place(x);
    if (place < 0.0) return kBelow;
    return place < static_cast<double>(Bins) ? static_cast<int>(place) : kAbove;
  }

  /// Takes a sample of the warm-up; the caller folds its bins as often as the number returned.
  [[nodiscard]] int learn(double x) noexcept {
    if (to_learn_ == 0) return 0;
    largest_ = std::max(largest_, std::abs(x));
    --to_learn_;
    const double room = to_learn_ == 0 ? kMargin * largest_ : largest_;
    int folds = 0;
    while (!(room < high()) && doublings_ < kMaxDoublings) {
      low_ *= 2.0;
      set_width(2.0 * width_);
      ++doublings_;
      ++folds;
    }
    return folds;
  }

  [[nodiscard]] bool learning() const noexcept { return to_learn_ > 0; }
  /// False: learn() would count the sample and change nothing. Not of a NaN.
  [[nodiscard]] bool may_change(double x) const noexcept {
    return to_learn_ > 0 && (to_learn_ == 1 || !(std::abs(x) <= largest_));
  }
  /// As learn() of a sample that changes nothing.
  void count() noexcept { to_learn_ -= to_learn_ > 0 ? 1U : 0U; }
  [[nodiscard]] double low() const noexcept { return low_; }
  [[nodiscard]] double high() const noexcept { return low_ + static_cast<double>(Bins) * width_; }
  [[nodiscard]] double width() const noexcept { return width_; }
  [[nodiscard]] double centre(std::size_t bin) const noexcept {
    return low_ + (static_cast<double>(bin) + 0.5) * width_;
  }
  [[nodiscard]] bool same_bins(const BinAxis& other) const noexcept {
    return low_ == other.low_ && width_ == other.width_;
  }

  /// Bins of twice the width about zero: where the content of an old bin goes.
  [[nodiscard]] static constexpr std::size_t folded(std::size_t bin) noexcept {
    return (bin + Bins / 2) / 2;
  }

 private:
  static constexpr double kMargin = 1.5;
  static constexpr int kMaxDoublings = 60;
  void set_width(double width) noexcept {
    width_ = width;
    per_width_ = 1.0 / width;
  }

  double low_{0.0};
  double width_{1.0};
  double per_width_{1.0};
  double largest_{0.0};
  std::uint32_t to_learn_{0};
  int doublings_{0};
};

}  // namespace dampline
