// SPDX-License-Identifier: MIT
#include "dampline/density/modulation.hpp"

#include <algorithm>

#include "dampline/numeric/cholesky.hpp"

namespace dampline {

void Modulation::add(const Modulation& other, double factor) noexcept {
  for (std::size_t m = 0; m < kMoments; ++m) moments_[m] += factor * other.moments_[m];
  for (std::size_t m = 0; m < kTerms; ++m) squares_[m] += factor * other.squares_[m];
}

void Modulation::scale(double factor) noexcept {
  for (double& moment : moments_) moment *= factor;
  for (double& square : squares_) square *= factor;
}

Modulation::Polynomial Modulation::shape() const noexcept {
  constexpr int kSize = static_cast<int>(kTerms);
  Cholesky<kSize>::Matrix gram;
  Cholesky<kSize>::Vector right;
  for (std::size_t i = 0; i < kTerms; ++i) {
    for (std::size_t j = 0; j < kTerms; ++j) {
      gram(static_cast<int>(i), static_cast<int>(j)) = moments_[i + j];
    }
    right[static_cast<int>(i)] = squares_[i];
  }
  Polynomial out{1.0};
  Cholesky<kSize> cholesky;
  if (!(squares_[0] > 0.0) || !cholesky.factor(gram, kSize)) return out;
  cholesky.solve(right);
  const double mean = squares_[0] / moments_[0];
  for (std::size_t i = 0; i < kTerms; ++i) out[i] = right[static_cast<int>(i)] / mean;
  return out;
}

double Modulation::at(const Polynomial& shape, double deflection_m) noexcept {
  const double y = 1.0e3 * deflection_m;
  double sum = 0.0;
  for (std::size_t i = kTerms; i > 0; --i) sum = sum * y + shape[i - 1];
  return std::max(sum, 0.0);
}

}  // namespace dampline
