// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/density/bin_axis.hpp"
#include "dampline/density/growing_weight.hpp"
#include "dampline/result.hpp"

namespace dampline {

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
