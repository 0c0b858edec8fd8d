// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "dampline/basis/smooth_sign.hpp"
#include "dampline/numeric/information.hpp"
#include "dampline/rig/config.hpp"
#include "dampline/rig/motion.hpp"

namespace dampline::rig {

/// Columns of the equations: every model is made of sums of these.
namespace column {
inline constexpr int kInertia = 0;    ///< x''
inline constexpr int kStiffness = 1;  ///< x
inline constexpr int kViscous = 2;    ///< x'
inline constexpr int kSign = 3;       ///< smooth sign of v
inline constexpr int kOne = 4;
inline constexpr int kRampPositive = 5;  ///< 8 segments of v > 0, ascending; slope +1 in v
inline constexpr int kRampNegative = kRampPositive + static_cast<int>(kCurveSegments);
inline constexpr int kForce = kRampNegative + static_cast<int>(kCurveSegments);
inline constexpr int kCount = kForce + 1;
}  // namespace column

using Block = Information<column::kCount>;
inline constexpr int kMaxUnknowns = 4 + 2 * static_cast<int>(kCurveSegments);

/// smooth_sign() averaged exactly over the straight line between samples. Without the average the
/// jump at a reversal falls on whole samples and biases the friction level.
class MeanSign {
 public:
  explicit MeanSign(double width_mps) noexcept : width_mps_{width_mps} {}

  /// Mean over the stretch from half a sample before to half a sample after `v`.
  [[nodiscard]] double mean(double v_before, double v, double v_after) const noexcept {
    return 0.5 * (line_mean(0.5 * (v_before + v), v) + line_mean(v, 0.5 * (v + v_after)));
  }

 private:
  [[nodiscard]] double line_mean(double a, double b) const noexcept {
    const double far = 6.0 * width_mps_;
    if (a > far && b > far) return 1.0;
    if (a < -far && b < -far) return -1.0;
    if (std::abs(b - a) < 1e-3 * width_mps_)
      return std::erf(kSignSlope * 0.5 * (a + b) / width_mps_);
    return (integral(b) - integral(a)) / (b - a);
  }

  [[nodiscard]] double integral(double v) const noexcept {
    const double z = kSignSlope * v / width_mps_;
    return v * std::erf(z) + width_mps_ / kSignSlope * std::numbers::inv_sqrtpi * std::exp(-z * z);
  }

  double width_mps_;
};

/// Part of a speed that lies in each segment; the last segment has no end. Sums to `speed`.
[[nodiscard]] std::array<double, kCurveSegments> ramps(
    double speed, const std::array<double, kCurveSegments>& nodes) noexcept;

/// The columns that are functions of the velocity, at one instant. The others are left alone.
class Regressors {
 public:
  explicit Regressors(const Config& config) noexcept
      : sign_{config.sign_width_mps}, nodes_{config.curve_nodes_mps} {}

  void fill(const Motion& motion, Block::Row& row) const noexcept;
  /// The same in steady motion on one branch, with the friction's full sign.
  void fill_branch(bool positive, double speed_mps, Block::Row& row) const noexcept;

 private:
  MeanSign sign_;
  std::array<double, kCurveSegments> nodes_;
};

/// The compact test function psi(u) = (1 - u^2)^5, |u| < 1, sum psi = 1, and its derivatives in
/// time. Sums over samples take the place of integrals, so the derivatives are sixth-order
/// differences of the sampled psi: sum psi'' x is then the sixth-order x'' seen through psi,
/// whatever x is, and 0 for a constant.
class TestFunction {
 public:
  struct Values {
    double psi;
    double first;   ///< d psi / dt, 1/s
    double second;  ///< d^2 psi / dt^2, 1/s^2
  };

  /// `half` is the number of samples to either side, at least kDifference + 1.
  TestFunction(int half, double interval_s) noexcept;

  /// At sample j = -half ... half from the centre.
  [[nodiscard]] Values at(int j) const noexcept;

  [[nodiscard]] int half() const noexcept { return half_; }

  /// Standard deviation of <x, psi''> for white noise of standard deviation 1 in x.
  [[nodiscard]] double second_noise_gain() const noexcept;

  static constexpr int kDifference = 3;  ///< samples that a difference reaches to either side

 private:
  [[nodiscard]] double psi(int j) const noexcept;

  int half_;
  double interval_s_;
  double norm_{1.0};
};

/// One equation: the test function against every column and the force, in newtons.
struct Row {
  std::int64_t centre_tick{0};
  Block::Row row;
  double still_share{0.0};  ///< weight of the test function on standstill
};

/// Galerkin rows of m x'' + c x' + k x + ... = f by integration by parts,
///   <x'', psi> = <x, psi''>,  <x', psi> = -<x, psi'>,
/// so that no noisy derivative of the deflection enters a linear term. One row every half of a half
/// support. Each open window adds its share of every sample: no history, constant time per sample.
class Rows {
 public:
  explicit Rows(const Config& config) noexcept;

  /// Consecutive motion. True when `out` was filled.
  bool update(const Motion& motion, Row& out) noexcept;
  /// Drops the open windows: what they hold cannot be completed.
  void reset() noexcept;
  [[nodiscard]] int half() const noexcept { return psi_.half(); }

 private:
  static constexpr std::size_t kOpen = 6;

  struct Window {
    bool open{false};
    int position{0};
    Block::Row sum;
    double still{0.0};
  };

  void open_window() noexcept;
  void add(Window& window, const Motion& motion) const noexcept;

  Regressors regressors_;
  TestFunction psi_;
  double still_mps_;
  int stride_;
  int until_next_{0};
  Block::Row nonlinear_;
  std::array<Window, kOpen> windows_{};
};

}  // namespace dampline::rig
