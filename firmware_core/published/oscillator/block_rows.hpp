// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "dampline/numeric/information.hpp"
#include "published/oscillator/gram_polynomials.hpp"
#include "published/oscillator/sensitivity.hpp"

namespace dampline {

/// Galerkin rows of one block: a'' = -sum theta_i g_i(x, v) under a short compact test function.
/// Before the terms stand columns for what the drift removal took from deflection and velocity, a
/// polynomial over the block: the polynomials p_j themselves, exact for the terms that are linear,
/// and h p_j for each function h that a derivative of another term contains, exact to first order.
/// Triangularisation leaves the information about the terms alone in the last rows.
template <class Terms, int Block, int Slow>
class BlockRows {
 public:
  using Factors = Sensitivities<Terms>;
  static constexpr int kTerms = Terms::kCount;
  static constexpr int kNuisance = Slow * (1 + Factors::kCount);
  static constexpr int kColumns = kNuisance + kTerms + 1;
  using Row = typename Information<kColumns>::Row;
  using Polynomials = GramPolynomials<Slow, Block>;

  static constexpr int kHalf = 3;    ///< the test function reaches so many samples to either side
  static constexpr int kStride = 3;  ///< between rows
  static constexpr int kRows = (Block - 2 * kHalf + kStride - 1) / kStride;

  explicit BlockRows(const Terms& terms) noexcept : terms_{terms} {
    double sum = 0.0;
    for (int m = -kHalf; m <= kHalf; ++m) {
      const double u = static_cast<double>(m) / (kHalf + 1);
      weights_[at(m + kHalf)] = (1.0 - u * u) * (1.0 - u * u) * (1.0 - u * u);
      sum += weights_[at(m + kHalf)];
    }
    for (double& w : weights_) w /= sum;
  }

  [[nodiscard]] static int centre(int row) noexcept { return kHalf + row * kStride; }
  [[nodiscard]] const Polynomials& polynomials() const noexcept { return polynomials_; }

  /// Whether velocity keeps its sign and stays above `least_mps` under the test function. Always so
  /// where no term jumps at rest.
  template <class Window>
  [[nodiscard]] bool usable(int centre, const Window& window, double least_mps) const noexcept {
    if constexpr (!Terms::kKinkAtRest) return true;
    const double sign = window.velocity_mps(centre) > 0.0 ? 1.0 : -1.0;
    for (int n = centre - kHalf; n <= centre + kHalf; ++n) {
      if (sign * window.velocity_mps(n) < least_mps) return false;
    }
    return true;
  }

  /// `mass(n)` is the acceleration of the mass at sample n of the block.
  template <class Window, class Accel>
  [[nodiscard]] Row row(int centre, const Window& window, const Accel& mass) const noexcept {
    Row out = Row::Zero();
    for (int m = -kHalf; m <= kHalf; ++m) {
      const int n = centre + m;
      add(weights_[at(m + kHalf)], n, window.deflection_m(n), window.velocity_mps(n), mass(n), out);
    }
    return out;
  }

 private:
  static constexpr std::size_t at(int i) noexcept { return static_cast<std::size_t>(i); }

  void add(double weight, int n, double x, double v, double mass_mps2, Row& out) const noexcept {
    Eigen::Matrix<double, 1 + Factors::kCount, 1> factors;
    factors[0] = 1.0;
    Factors::fill(x, v, factors, 1);
    const auto slow = polynomials_.at(n);
    int column = 0;
    for (int i = 0; i <= Factors::kCount; ++i) {
      for (const double p : slow) out[column++] += weight * factors[i] * p;
    }
    Eigen::Matrix<double, kTerms, 1> values;
    terms_.fill(x, v, weight, values);
    for (int i = 0; i < kTerms; ++i) out[column++] += values[i];
    out[column] -= weight * mass_mps2;
  }

  Terms terms_;
  Polynomials polynomials_;
  std::array<double, static_cast<std::size_t>(2 * kHalf + 1)> weights_{};
};

}  // namespace dampline
