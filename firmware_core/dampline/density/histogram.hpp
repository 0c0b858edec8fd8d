// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/result.hpp"

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

struct HistogramConfig {
  BinRange range{};
  double memory_samples{0.0};  ///< time constant of forgetting; 0: none
};

/// Online density of a scalar. What lies outside the range is counted; what is not finite is
/// counted apart and belongs to no mass. Bins may be kept per group of samples, so that the
/// scatter between groups is known. Without forgetting all masses are whole numbers, exact up to
/// 2^53 samples, and merging is exact.
///
/// O(1) per sample, except for one pass over the bins at a doubling of a learned range (at most 60
/// in a life) and, with forgetting, once in some 200 memories.
template <std::size_t Bins, std::size_t Groups = 1>
class Histogram {
 public:
  using Axis = BinAxis<Bins>;
  using Masses = std::array<double, Bins>;
  static constexpr std::size_t kBins = Bins;

  /// kInvalidConfig when a setting is out of its range.
  [[nodiscard]] static Result<HistogramConfig> check(const HistogramConfig& config) noexcept {
    if (!Axis::valid(config.range)) return Errc::kInvalidConfig;
    if (!(config.memory_samples >= 0.0) || !std::isfinite(config.memory_samples)) {
      return Errc::kInvalidConfig;
    }
    return config;
  }

  /// Precondition: check(config).ok().
  explicit Histogram(const HistogramConfig& config) noexcept
      : axis_{config.range}, weight_{config.memory_samples} {}

  void update(double x, std::size_t group = 0) noexcept {
    const double place = axis_.place(x);
    if (weight_.forgets() || !Axis::inside(place) || axis_.may_change(x))
      return update_slowly(x, group);
    axis_.count();
    ++usual_;
    masses_[group][static_cast<std::size_t>(static_cast<int>(place))] += 1.0;
  }

  /// Adds another histogram's samples. kMismatch when bins or memories differ. Returns the samples
  /// of both. With forgetting both are taken as seen at their own newest sample.
  Result<std::uint64_t> merge(const Histogram& other) noexcept {
    if (!axis_.same_bins(other.axis_) || weight_.growth() != other.weight_.growth()) {
      return Errc::kMismatch;
    }
    const double factor = weight_.value() / other.weight_.value();
    for (std::size_t g = 0; g < Groups; ++g) {
      for (std::size_t b = 0; b < Bins; ++b) masses_[g][b] += factor * other.masses_[g][b];
    }
    total_ += factor * other.total();
    below_ += factor * other.below_;
    above_ += factor * other.above_;
    samples_ += other.samples();
    not_finite_ += other.not_finite_;
    return samples();
  }

  [[nodiscard]] const Axis& axis() const noexcept { return axis_; }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_ + usual_; }
  [[nodiscard]] std::uint64_t not_finite() const noexcept { return not_finite_; }

  /// Share of the mass in a bin, below the range, above it: together 1 (0 without samples).
  [[nodiscard]] double share(std::size_t bin) const noexcept { return part(raw(bin)); }
  [[nodiscard]] double share_below() const noexcept { return part(below_); }
  [[nodiscard]] double share_above() const noexcept { return part(above_); }
  [[nodiscard]] double share_outside() const noexcept { return part(below_ + above_); }
  /// Probability per unit of x. Its integral over the range, share_below() and share_above() make
  /// 1.
  [[nodiscard]] double density(std::size_t bin) const noexcept {
    return share(bin) / axis_.width();
  }

  /// Samples in a bin, of all groups or of one; with forgetting the newest sample counts 1.
  [[nodiscard]] double mass(std::size_t bin) const noexcept { return raw(bin) / weight_.value(); }
  [[nodiscard]] double mass(std::size_t bin, std::size_t group) const noexcept {
    return masses_[group][bin] / weight_.value();
  }

 private:
  /// Of all samples; those that were usual have weight 1, since nothing is forgotten then.
  [[nodiscard]] double total() const noexcept { return total_ + static_cast<double>(usual_); }
  void update_slowly(double x, std::size_t group) noexcept {
    if (!std::isfinite(x)) {
      ++not_finite_;
      return;
    }
    for (int folds = axis_.learn(x); folds > 0; --folds) fold();
    const double factor = weight_.step();
    if (factor != 1.0) scale(factor);
    const double w = weight_.value();
    const int bin = axis_.locate(x);
    ++samples_;
    total_ += w;
    if (bin == Axis::kBelow) {
      below_ += w;
    } else if (bin == Axis::kAbove) {
      above_ += w;
    } else {
      masses_[group][static_cast<std::size_t>(bin)] += w;
    }
  }
  [[nodiscard]] double part(double mass) const noexcept {
    return total() > 0.0 ? mass / total() : 0.0;
  }
  [[nodiscard]] double raw(std::size_t bin) const noexcept {
    double sum = 0.0;
    for (const Masses& group : masses_) sum += group[bin];
    return sum;
  }
  void fold() noexcept {
    for (Masses& group : masses_) {
      Masses wide{};
      for (std::size_t b = 0; b < Bins; ++b) wide[Axis::folded(b)] += group[b];
      group = wide;
    }
  }
  void scale(double factor) noexcept {
    for (Masses& group : masses_) {
      for (double& mass : group) mass *= factor;
    }
    total_ *= factor;
    below_ *= factor;
    above_ *= factor;
  }

  Axis axis_;
  GrowingWeight weight_;
  std::array<Masses, Groups> masses_{};
  double total_{0.0};
  double below_{0.0};
  double above_{0.0};
  std::uint64_t usual_{0};    // samples of weight 1 within a range that is known
  std::uint64_t samples_{0};  // all others
  std::uint64_t not_finite_{0};
};

}  // namespace dampline
