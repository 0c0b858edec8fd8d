// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <array>

#include "dampline/effect/columns.hpp"
#include "dampline/effect/grids.hpp"
#include "dampline/effect/instant.hpp"
#include "dampline/effect/pitch_bank.hpp"

namespace dampline::effect {

/// Values of the columns that are functions of the motion; single precision, since they are
/// projected on thousands of windows and never differenced.
using LawValues = Eigen::Matrix<float, kLawColumnsOfEffects, 1>;

/// Every candidate law as a regressor over the motion and its history. Lengths are multiples of
/// the size of the deflection.
class EffectLaws {
 public:
  /// Precondition: grids.scale_m > 0.
  EffectLaws(const Grids& grids, double step_s) noexcept
      : grids_{grids}, pitch_{step_s, grids.pitch} {}

  /// The columns at a point; points come in the order of time, `step_s` apart, since some laws
  /// remember.
  [[nodiscard]] LawValues operator()(const Point& point) noexcept;
  /// Forgets the history.
  void reset() noexcept;
  [[nodiscard]] const Grids& grids() const noexcept { return grids_; }

 private:
  void friction(const Point& point, LawValues& out) const noexcept;
  void stiffness(double deflection_m, LawValues& out) const noexcept;
  void memory(const Point& point, double sign, LawValues& out) noexcept;

  Grids grids_;
  bool any_{false};
  double last_deflection_m_{0.0};
  std::array<double, kDahlDistances> zeta_{};
  std::array<double, kBacklashGaps> piston_m_{};
  PitchBank pitch_;
};

}  // namespace dampline::effect
