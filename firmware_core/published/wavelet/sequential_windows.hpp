// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "published/wavelet/estimate_scatter.hpp"
#include "published/wavelet/linear_estimate.hpp"

namespace dampline {

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

}  // namespace dampline
