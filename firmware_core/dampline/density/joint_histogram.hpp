// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/density/histogram.hpp"
#include "dampline/result.hpp"

namespace dampline {

struct JointHistogramConfig {
  BinRange x{};
  BinRange y{};
  double memory_samples{0.0};  ///< time constant of forgetting; 0: none
};

/// Online joint density of two scalars; as Histogram, whose remarks on outside mass, forgetting,
/// learned ranges and merging hold here too.
template <std::size_t XBins, std::size_t YBins>
class JointHistogram {
 public:
  using XAxis = BinAxis<XBins>;
  using YAxis = BinAxis<YBins>;

  /// kInvalidConfig when a setting is out of its range.
  [[nodiscard]] static Result<JointHistogramConfig> check(
      const JointHistogramConfig& config) noexcept {
    const bool valid = XAxis::valid(config.x) && YAxis::valid(config.y) &&
                       config.memory_samples >= 0.0 && std::isfinite(config.memory_samples);
    if (!valid) return Errc::kInvalidConfig;
    return config;
  }

  /// Precondition: check(config).ok().
  explicit JointHistogram(const JointHistogramConfig& config) noexcept
      : x_{config.x}, y_{config.y}, weight_{config.memory_samples} {}

  void update(double x, double y) noexcept {
    const double x_place = x_.place(x);
    const double y_place = y_.place(y);
    if (weight_.forgets() || !XAxis::inside(x_place) || !YAxis::inside(y_place) ||
        x_.may_change(x) || y_.may_change(y))
      return update_slowly(x, y);
    x_.count();
    y_.count();
    ++usual_;
    masses_[static_cast<std::size_t>(static_cast<int>(x_place))]
           [static_cast<std::size_t>(static_cast<int>(y_place))] += 1.0;
  }

  /// Adds another histogram's samples. kMismatch when bins or memories differ.
  Result<std::uint64_t> merge(const JointHistogram& other) noexcept {
    if (!x_.same_bins(other.x_) || !y_.same_bins(other.y_) ||
        weight_.growth() != other.weight_.growth()) {
      return Errc::kMismatch;
    }
    const double factor = weight_.value() / other.weight_.value();
    for (std::size_t i = 0; i < XBins; ++i) {
      for (std::size_t j = 0; j < YBins; ++j) masses_[i][j] += factor * other.masses_[i][j];
    }
    total_ += factor * other.total();
    outside_ += factor * other.outside_;
    samples_ += other.samples();
    not_finite_ += other.not_finite_;
    return samples();
  }

  [[nodiscard]] const XAxis& x_axis() const noexcept { return x_; }
  [[nodiscard]] const YAxis& y_axis() const noexcept { return y_; }
  [[nodiscard]] std::uint64_t samples() const noexcept { return samples_ + usual_; }
  [[nodiscard]] std::uint64_t not_finite() const noexcept { return not_finite_; }

  /// Share of the mass in a cell and outside all cells: together 1 (0 without samples).
  [[nodiscard]] double share(std::size_t i, std::size_t j) const noexcept {
    return total() > 0.0 ? masses_[i][j] / total() : 0.0;
  }
  [[nodiscard]] double share_outside() const noexcept {
    return total() > 0.0 ? outside_ / total() : 0.0;
  }
  /// Probability per unit of x and of y. Its integral and share_outside() make 1.
  [[nodiscard]] double density(std::size_t i, std::size_t j) const noexcept {
    return share(i, j) / (x_.width() * y_.width());
  }

 private:
  /// Of all samples; those that were usual have weight 1, since nothing is forgotten then.
  [[nodiscard]] double total() const noexcept { return total_ + static_cast<double>(usual_); }
  using Masses = std::array<std::array<double, YBins>, XBins>;
  void update_slowly(double x, double y) noexcept {
    if (!std::isfinite(x) || !std::isfinite(y)) {
      ++not_finite_;
      return;
    }
    for (int folds = x_.learn(x); folds > 0; --folds) fold_x();
    for (int folds = y_.learn(y); folds > 0; --folds) fold_y();
    const double factor = weight_.step();
    if (factor != 1.0) scale(factor);
    const double w = weight_.value();
    const int i = x_.locate(x);
    const int j = y_.locate(y);
    ++samples_;
    total_ += w;
    if (i < 0 || i == XAxis::kAbove || j < 0 || j == YAxis::kAbove) {
      outside_ += w;
    } else {
      masses_[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] += w;
    }
  }
  void fold_x() noexcept {
    for (std::size_t j = 0; j < YBins; ++j) {
      std::array<double, XBins> wide{};
      for (std::size_t i = 0; i < XBins; ++i) wide[XAxis::folded(i)] += masses_[i][j];
      for (std::size_t i = 0; i < XBins; ++i) masses_[i][j] = wide[i];
    }
  }
  void fold_y() noexcept {
    for (auto& row : masses_) {
      std::array<double, YBins> wide{};
      for (std::size_t j = 0; j < YBins; ++j) wide[YAxis::folded(j)] += row[j];
      row = wide;
    }
  }
  void scale(double factor) noexcept {
    for (auto& row : masses_) {
      for (double& mass : row) mass *= factor;
    }
    total_ *= factor;
    outside_ *= factor;
  }

  XAxis x_;
  YAxis y_;
  GrowingWeight weight_;
  Masses masses_{};
  double total_{0.0};
  double outside_{0.0};
  std::uint64_t usual_{0};    // samples of weight 1 within a range that is known
  std::uint64_t samples_{0};  // all others
  std::uint64_t not_finite_{0};
};

struct Dependence {
  bool known{false};  ///< enough cells were visited often enough
  double size{0.0};   ///< sqrt(chi^2 / N), less what chance alone makes; 0...1
};

/// Chi-square of a joint histogram against the product of its marginals, over the cells where at
/// least five independent samples are expected. `independent` is the effective number of samples:
/// for an oscillation, the number of its half periods.
template <std::size_t XBins, std::size_t YBins>
[[nodiscard]] Dependence dependence(const JointHistogram<XBins, YBins>& joint,
                                    double independent) noexcept {
  constexpr double kFewestPerCell = 5.0;
  constexpr double kFewestCells = 9.0;
  std::array<double, XBins> x{};
  std::array<double, YBins> y{};
  for (std::size_t i = 0; i < XBins; ++i) {
    for (std::size_t j = 0; j < YBins; ++j) {
      x[i] += joint.share(i, j);
      y[j] += joint.share(i, j);
    }
  }
  double sum = 0.0;
  double cells = 0.0;
  for (std::size_t i = 0; i < XBins; ++i) {
    for (std::size_t j = 0; j < YBins; ++j) {
      const double expected = x[i] * y[j];
      if (!(independent * expected >= kFewestPerCell)) continue;
      const double excess = joint.share(i, j) - expected;
      sum += excess * excess / expected;
      cells += 1.0;
    }
  }
  if (cells < kFewestCells) return {};
  return {.known = true, .size = std::sqrt(std::max(sum - cells / independent, 0.0))};
}

}  // namespace dampline
