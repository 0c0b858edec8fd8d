// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace dampline {

/// psi(y) of dv = -(beta y + alpha) dt + psi(y) dW as a polynomial: psi^2 is the conditional mean
/// of the squared input over y, brought to the input's spectral level. (Kisilowski and Urbanski
/// divide each eta_i by a pseudo-random number of no relation to it; the mean of that quotient does
/// not exist.)
class Modulation {
 public:
  static constexpr std::size_t kTerms = 5;
  /// Coefficients of (y / 1 mm)^m; mean over the samples: 1.
  using Polynomial = std::array<double, kTerms>;

  void take(double deflection_m, double input_mps2, double weight) noexcept {
    const double y = 1.0e3 * deflection_m;
    const double squared = input_mps2 * input_mps2;
    double power = weight;
    for (std::size_t m = 0; m < kMoments; ++m) {
      moments_[m] += power;
      if (m < kTerms) squares_[m] += power * squared;
      power *= y;
    }
  }
  void add(const Modulation& other, double factor) noexcept;
  void scale(double factor) noexcept;

  /// psi^2 over its mean. {1, 0, ...} while the samples do not determine it.
  [[nodiscard]] Polynomial shape() const noexcept;
  /// At a deflection; never negative.
  [[nodiscard]] static double at(const Polynomial& shape, double deflection_m) noexcept;

 private:
  static constexpr std::size_t kMoments = 2 * kTerms - 1;
  std::array<double, kMoments> moments_{};
  std::array<double, kTerms> squares_{};
};

}  // namespace dampline
