// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/information.hpp"

namespace dampline {

/// When rows count as enough for an estimate. With less, the last estimate is held.
struct Sufficiency {
  double tolerance{1e-9};        ///< least pivot, relative to its column's norm
  double rows_per_unknown{5.0};  ///< more rows than this times the unknowns
};

/// A least-squares solution and what is known about it.
template <int Unknowns, class Scalar = double>
struct LinearEstimate {
  using Vector = Eigen::Matrix<Scalar, Unknowns, 1>;
  Vector theta = Vector::Zero();
  Vector deviation = Vector::Zero();  ///< standard deviations, for rows with independent errors
  Scalar residual_rms{0};             ///< in the unit of the right-hand side
  double rows{0.0};                   ///< a real number: forgetting makes fractions of rows
  bool valid{false};
};

/// The solution of `information` that `rows` equations made. False, and `out` left as it was, where
/// they do not suffice.
template <int Unknowns, class Scalar>
[[nodiscard]] bool solve(const Information<Unknowns + 1, Scalar>& information, double rows,
                         const Sufficiency& enough,
                         LinearEstimate<Unknowns, Scalar>& out) noexcept {
  if (!(rows > enough.rows_per_unknown * Unknowns)) return false;
  typename LinearEstimate<Unknowns, Scalar>::Vector theta;
  if (!information.solve(theta, static_cast<Scalar>(enough.tolerance))) return false;
  out.theta = theta;
  const auto freedom = static_cast<Scalar>(rows - Unknowns);
  out.residual_rms = information.residual_norm() / std::sqrt(freedom);
  const auto inverse = information.inverse();
  for (int i = 0; i < Unknowns; ++i) {
    out.deviation[i] = out.residual_rms * std::sqrt(inverse(i, i));
  }
  out.rows = rows;
  out.valid = true;
  return true;
}

/// Least squares over all rows so far: square-root information with or without forgetting. Equal to
/// the batch solution to rounding. Rows are gathered and taken kPanel at once, by reflections,
/// which costs a third of taking each by itself; what is asked for always includes every row.
template <int Unknowns, class Scalar = double>
class RecursiveEstimate {
 public:
  using Factor = Information<Unknowns + 1, Scalar>;
  static constexpr std::size_t kPanel = 12;

  /// `memory_rows`: time constant of exponential forgetting, in rows; 0 forgets nothing.
  explicit RecursiveEstimate(double memory_rows = 0.0, const Sufficiency& enough = {}) noexcept
      : keep_{memory_rows > 0.0 ? std::exp(-1.0 / memory_rows) : 1.0}, enough_{enough} {
    const auto root = static_cast<Scalar>(std::sqrt(keep_));
    for (std::size_t i = 0; i < kPanel; ++i) fade_[i + 1] = fade_[i] * root;
  }

  void absorb(const typename Factor::Row& row) noexcept {
    rows_ = keep_ * rows_ + 1.0;
    waiting_.set(count_, row);
    if (++count_ < kPanel) return;
    fade();
    factor_.absorb_panel(waiting_);
    count_ = 0;
  }

  /// Solves. False, and latest() held, where the rows do not suffice.
  [[nodiscard]] bool update() noexcept { return solve(information(), rows_, enough_, latest_); }

  [[nodiscard]] const LinearEstimate<Unknowns, Scalar>& latest() const noexcept { return latest_; }
  [[nodiscard]] const Factor& information() noexcept {
    fade();
    for (std::size_t i = 0; i < count_; ++i) factor_.absorb(waiting_.row(i));
    count_ = 0;
    return factor_;
  }
  [[nodiscard]] double rows() const noexcept { return rows_; }

 private:
  /// Brings the factor and the rows that wait to the age that they have at the newest of them.
  void fade() noexcept {
    if (!(keep_ < 1.0) || count_ == 0) return;
    factor_.scale(fade_[count_]);
    for (std::size_t i = 0; i + 1 < count_; ++i) waiting_.scale(i, fade_[count_ - 1 - i]);
  }

  double keep_;
  Sufficiency enough_;
  std::array<Scalar, kPanel + 1> fade_{Scalar(1)};
  typename Factor::template Panel<kPanel> waiting_{};
  std::size_t count_{0};
  Factor factor_{};
  double rows_{0.0};
  LinearEstimate<Unknowns, Scalar> latest_{};
};

/// Mean and scatter of repeated estimates, in one pass (Welford 1962).
template <int Unknowns>
class EstimateScatter {
 public:
  using Vector = Eigen::Matrix<double, Unknowns, 1>;

  void add(const Vector& theta) noexcept {
    ++count_;
    const Vector from_old = theta - mean_;
    mean_ += from_old / static_cast<double>(count_);
    sum_squares_ += from_old.cwiseProduct(theta - mean_);
  }

  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  [[nodiscard]] const Vector& mean() const noexcept { return mean_; }
  /// Sample standard deviation, with count - 1 below the sum; 0 for one estimate.
  [[nodiscard]] Vector deviation() const noexcept {
    if (count_ < 2) return Vector::Zero();
    return (sum_squares_ / static_cast<double>(count_ - 1)).cwiseSqrt();
  }
  /// Coefficient of variation: deviation / |mean|.
  [[nodiscard]] Vector cov() const noexcept { return deviation().cwiseQuotient(mean_.cwiseAbs()); }

 private:
  Vector mean_ = Vector::Zero();
  Vector sum_squares_ = Vector::Zero();
  std::int64_t count_{0};
};

/// What a row did to the windows.
enum class WindowEvent : std::uint8_t {
  kOpen,    ///< the window takes more rows
  kSolved,  ///< the window was full; latest() is its estimate
  kHeld,    ///< the window was full but does not determine all unknowns; latest() is older
};

/// Estimates from windows of equally many rows, one after the other, as in Ghanem and Romeo (2001):
/// they solve sets of 32 rows and state mean and coefficient of variation of the estimates. The
/// plain mean is a poor combination where windows are unequally informative; RecursiveEstimate over
/// the same rows weighs each by its information.
template <int Unknowns>
class SequentialWindows {
 public:
  using Factor = Information<Unknowns + 1>;

  /// `rows_per_window`: 32 in the paper; with two degrees of freedom, both rows of an instant
  /// count.
  explicit SequentialWindows(std::int64_t rows_per_window = 32, double tolerance = 1e-9) noexcept
      : rows_per_window_{rows_per_window},
        enough_{.tolerance = tolerance, .rows_per_unknown = 1.0} {}

  WindowEvent absorb(const typename Factor::Row& row) noexcept {
    factor_.absorb(row);
    if (++rows_ < rows_per_window_) return WindowEvent::kOpen;
    const bool solved = solve(factor_, static_cast<double>(rows_), enough_, latest_);
    if (solved) {
      scatter_.add(latest_.theta);
    } else {
      ++held_;
    }
    restart();
    return solved ? WindowEvent::kSolved : WindowEvent::kHeld;
  }

  /// Gives up the open window, after a gap.
  void restart() noexcept {
    factor_.clear();
    rows_ = 0;
  }

  [[nodiscard]] const LinearEstimate<Unknowns>& latest() const noexcept { return latest_; }
  /// Over all solved windows.
  [[nodiscard]] const EstimateScatter<Unknowns>& scatter() const noexcept { return scatter_; }
  /// Windows that did not determine all unknowns.
  [[nodiscard]] std::int64_t held() const noexcept { return held_; }

 private:
  std::int64_t rows_per_window_;
  Sufficiency enough_;
  Factor factor_{};
  std::int64_t rows_{0};
  std::int64_t held_{0};
  LinearEstimate<Unknowns> latest_{};
  EstimateScatter<Unknowns> scatter_{};
};

/// A sliding window: the factors of the latest `Blocks` blocks of rows, merged on demand. The
/// oldest block leaves as a whole, so nothing is ever subtracted. The window holds between (Blocks
/// - 1) rows_per_block + 1 and Blocks rows_per_block rows. update() costs Blocks (Unknowns + 1)
/// absorbed rows, absorb() one.
template <int Unknowns, std::size_t Blocks, class Scalar = double>
class FactorRing {
  static_assert(Blocks >= 2);

 public:
  using Factor = Information<Unknowns + 1, Scalar>;

  explicit FactorRing(std::int64_t rows_per_block, const Sufficiency& enough = {}) noexcept
      : rows_per_block_{rows_per_block}, enough_{enough} {}

  void absorb(const typename Factor::Row& row) noexcept {
    if (rows_[newest_] == rows_per_block_) {
      newest_ = (newest_ + 1) % Blocks;
      factors_[newest_].clear();
      rows_[newest_] = 0;
    }
    factors_[newest_].absorb(row);
    ++rows_[newest_];
  }

  /// Merges the blocks and solves. False, and latest() held, where the rows do not suffice.
  [[nodiscard]] bool update() noexcept { return solve(merged(), rows(), enough_, latest_); }

  /// The information of all rows in the window.
  [[nodiscard]] Factor merged() const noexcept {
    Factor out = factors_[newest_];
    for (std::size_t i = 1; i < Blocks; ++i) out.merge(factors_[(newest_ + i) % Blocks]);
    return out;
  }
  [[nodiscard]] double rows() const noexcept {
    std::int64_t sum = 0;
    for (const std::int64_t n : rows_) sum += n;
    return static_cast<double>(sum);
  }
  [[nodiscard]] const LinearEstimate<Unknowns, Scalar>& latest() const noexcept { return latest_; }

 private:
  std::int64_t rows_per_block_;
  Sufficiency enough_;
  std::array<Factor, Blocks> factors_{};
  std::array<std::int64_t, Blocks> rows_{};
  std::size_t newest_{0};
  LinearEstimate<Unknowns, Scalar> latest_{};
};

}  // namespace dampline
