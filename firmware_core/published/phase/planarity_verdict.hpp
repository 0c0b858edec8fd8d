// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/numeric/information.hpp"
#include "dampline/phase/stroboscope.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

/// Columns y, v, sgn v, y sgn v, y^3, and a less its known input.
using PlanarityFactor = Information<6>;

struct PlanaritySums {
  std::uint64_t points{0};
  std::uint64_t not_finite{0};
  std::uint64_t slow{0};
  std::uint64_t nuisances{0};  ///< constants that the regimes took
  double sum_y{0.0};
  double sum_v{0.0};
  PlanarityFactor::Row squares = PlanarityFactor::Row::Zero();  ///< of each column
  void add(const PhasePoint& p, const PlanarityFactor::Row& row) noexcept;
};

enum class PlanarityState : std::uint8_t {
  kNotEnough,      ///< fewer than 30 points beyond the unknowns
  kNoMotion,       ///< deflection or velocity is constant: nothing to test
  kNotDetermined,  ///< none of the three terms can be told from the plane
  kLinear,
  kNonlinear
};

/// Above this F a section is not plane. Noise in the regressors (errors in variables) lifts the F
/// of a linear system to about 5 at 5 % noise; the textbook's 3.8 would reject those.
inline constexpr double kPlanarityThreshold = 10.0;
/// And the three terms must take away this share of the residual's variance: the effect of noise
/// in the regressors on F grows with the number of points, this share does not.
inline constexpr double kPlanarityLeastGain = 0.01;

struct PlanarityVerdict {
  PlanarityState state{PlanarityState::kNotEnough};
  double index{0.0};  ///< rms distance from the plane over rms a: non-planarity
  double f{0.0};      ///< F of the three terms
  double gain{0.0};   ///< share of the residual's variance that they take away
  int terms{0};       ///< how many of the three the data determine
  std::uint64_t points{0};
  std::uint64_t slow{0};        ///< left out: no motion, or too little
  std::uint64_t not_finite{0};  ///< left out
  /// Of the extended regression a = p + k y + h v + s sgn v + t y sgn v + u y^3; deviation 0: not
  /// determined.
  Estimate deflection_per_s2{}, velocity_per_s{}, sign_mps2{}, deflection_sign_per_s2{},
      cubic_per_m2s2{};
};

[[nodiscard]] PlanarityFactor::Row planarity_row(const PhasePoint& p, double input_mps2) noexcept;
[[nodiscard]] PlanarityVerdict judge_planarity(const PlanarityFactor& total,
                                               const PlanaritySums& sums) noexcept;

}  // namespace dampline
