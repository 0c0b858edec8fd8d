// SPDX-License-Identifier: MIT
#pragma once

namespace dampline {

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

}  // namespace dampline
