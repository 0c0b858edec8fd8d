// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/estimate/weighted_fit.hpp"

namespace dampline {

/// The column map of a friction law of width kLawWidthMps[i], the linear spring, and, with
/// Viscous, the viscous part; then the change with the width, so that the width is continuous and
/// its uncertainty is part of every other. Where the truck sticks for much of the time, the mean
/// force at small velocities, which are errors of a velocity that is 0, is none that a width alone
/// describes: Bent has the second difference over the widths as well. Far from 0 it vanishes, so
/// that the level stays what the law tends to.
template <bool Viscous, bool Bent = false>
struct LawModel {
  static constexpr int kUnknowns = (Viscous ? 4 : 3) + (Bent ? 1 : 0);
  static constexpr int kCoulomb = 0;
  static constexpr int kStiffness = 1;
  static constexpr int kViscous = 2;
  static constexpr int kWidthChange = kUnknowns - (Bent ? 2 : 1);
  static constexpr int kBend = kUnknowns - 1;  // with Bent

  static ColumnMap<kUnknowns - 1> fixed_width(std::size_t i) noexcept {
    ColumnMap<kUnknowns - 1> map = ColumnMap<kUnknowns - 1>::Zero();
    map(static_cast<int>(i), kCoulomb) = 1.0;
    map(kStiffnessColumn, kStiffness) = 1.0;
    if (Viscous) map(kViscousColumn, kViscous) = 1.0;
    map(kTargetColumn, kUnknowns - 1) = 1.0;
    return map;
  }

  static ColumnMap<kUnknowns> free_width(std::size_t i) noexcept {
    ColumnMap<kUnknowns> map = ColumnMap<kUnknowns>::Zero();
    map(static_cast<int>(i), kCoulomb) = 1.0;
    map(kStiffnessColumn, kStiffness) = 1.0;
    if (Viscous) map(kViscousColumn, kViscous) = 1.0;
    map(static_cast<int>(above(i)), kWidthChange) = 1.0;
    map(static_cast<int>(below(i)), kWidthChange) = -1.0;
    if constexpr (Bent) {
      map(static_cast<int>(above(i)), kBend) = 1.0;
      map(static_cast<int>(i), kBend) = -2.0;
      map(static_cast<int>(below(i)), kBend) = 1.0;
    }
    map(kTargetColumn, kUnknowns) = 1.0;
    return map;
  }

  /// The second difference needs a width on either side.
  static bool can_bend(std::size_t i) noexcept { return below(i) < i && i < above(i); }
  static std::size_t below(std::size_t i) noexcept { return i > 0 ? i - 1 : i; }
  static std::size_t above(std::size_t i) noexcept { return i + 1 < kLawWidths ? i + 1 : i; }
};

/// The width with the smallest objective, then all unknowns with the width free.
template <bool Viscous>
struct LawProfile {
  using Model = LawModel<Viscous>;
  static constexpr int kUnknowns = Model::kUnknowns;
  std::size_t width_index{0};
  WeightedFit<kUnknowns> fit;
  ColumnMap<kUnknowns> map = ColumnMap<kUnknowns>::Zero();

  /// Profiled again for every model: a width that belongs to another model biases this one.
  static LawProfile make(const ScaleFactors& factors, const ScaleMask& mask) noexcept {
    LawProfile best;
    double objective = 0.0;
    bool found = false;
    for (std::size_t i = 0; i < kLawWidths; ++i) {
      const auto fit = weighted_fit<kUnknowns - 1>(factors, Model::fixed_width(i), mask);
      if (!fit.ok || (found && fit.objective >= objective)) continue;
      found = true;
      objective = fit.objective;
      best.width_index = i;
    }
    if (!found) return best;
    best.map = Model::free_width(best.width_index);
    best.fit = weighted_fit<kUnknowns>(factors, best.map, mask);
    return best;
  }

  /// w* = w_i + (theta_dG / F) (w_(i+1) - w_(i-1)).
  [[nodiscard]] double width_mps() const noexcept {
    return kLawWidthMps[width_index] + shift() * span_mps();
  }
  /// theta_dG / F.
  [[nodiscard]] double shift() const noexcept {
    return fit.theta[Model::kWidthChange] / fit.theta[Model::kCoulomb];
  }
  [[nodiscard]] double span_mps() const noexcept {
    return kLawWidthMps[Model::above(width_index)] - kLawWidthMps[Model::below(width_index)];
  }
};

}  // namespace dampline
