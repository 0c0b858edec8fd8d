// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>

#include "dampline/effect/conclusion.hpp"
#include "dampline/effect/model_fit.hpp"
#include "dampline/estimate/velocity_error.hpp"

namespace dampline::effect {

/// A number made of a fit's unknowns, and how it changes with them: formulas written once give
/// their value and, with the fit's covariance, their deviation.
struct Uncertain {
  double value{0.0};
  ModelFit::Vector slope = ModelFit::Vector::Zero();

  [[nodiscard]] static Uncertain of(const ModelFit& fit, int term) noexcept {
    Uncertain out{fit.theta[term], ModelFit::Vector::Zero()};
    out.slope[term] = 1.0;
    return out;
  }
  [[nodiscard]] double covariance(const Uncertain& other, const ModelFit& fit) const noexcept {
    return slope.dot(fit.covariance.lazyProduct(other.slope));
  }
  [[nodiscard]] double std(const ModelFit& fit) const noexcept {
    const double variance = covariance(*this, fit);
    return variance > 0.0 ? std::sqrt(variance) : 0.0;
  }
};
[[nodiscard]] inline Uncertain operator+(const Uncertain& a, const Uncertain& b) noexcept {
  return {a.value + b.value, a.slope + b.slope};
}
[[nodiscard]] inline Uncertain operator-(const Uncertain& a, const Uncertain& b) noexcept {
  return {a.value - b.value, a.slope - b.slope};
}
[[nodiscard]] inline Uncertain operator*(double factor, const Uncertain& a) noexcept {
  return {factor * a.value, factor * a.slope};
}
[[nodiscard]] inline Uncertain operator*(const Uncertain& a, const Uncertain& b) noexcept {
  return {a.value * b.value, b.value * a.slope + a.value * b.slope};
}
[[nodiscard]] inline Uncertain operator/(const Uncertain& a, const Uncertain& b) noexcept {
  const double ratio = a.value / b.value;
  return {ratio, (1.0 / b.value) * (a.slope - ratio * b.slope)};
}

/// A model as it is fitted for its parameters: each length, speed and frequency has a column of its
/// own derivative.
struct Detail {
  Model model;
  ModelFit fit;
  ModelFit slow;       ///< without the shortest scale, which knows nothing of stiffness
  double factor{1.0};  ///< on deviations, for few entries
  double mass_kg{0.0};
  VelocityError velocity;
  double deflection_rms_m{0.0};
};

/// Friction and spring of a model.
struct BaseParameters {
  Estimate coulomb_n, stiffness_npm;
};
[[nodiscard]] BaseParameters base_parameters(const Detail& detail) noexcept;

/// Fills in the parameters of every step and of the final model, and where the steps' places in
/// their grids are.
void describe(const Detail& detail, Explanation& out) noexcept;

}  // namespace dampline::effect
