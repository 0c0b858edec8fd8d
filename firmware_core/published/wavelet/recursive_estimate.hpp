// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "published/wavelet/linear_estimate.hpp"

namespace dampline {

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

}  // namespace dampline
