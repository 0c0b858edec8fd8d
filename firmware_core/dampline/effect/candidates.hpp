// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/effect/columns.hpp"
#include "dampline/effect/grids.hpp"
#include "dampline/explanation.hpp"

namespace dampline::effect {

/// A regressor made of a few columns.
struct Regressor {
  static constexpr std::size_t kMost = 5;
  std::size_t count{0};
  std::array<int, kMost> column{};
  std::array<double, kMost> weight{};

  [[nodiscard]] static Regressor of(int column, double weight = 1.0) noexcept {
    return Regressor{}.plus(column, weight);
  }
  [[nodiscard]] Regressor plus(int c, double w) const noexcept {
    Regressor out = *this;
    out.column[out.count] = c;
    out.weight[out.count++] = w;
    return out;
  }
};

/// One way an effect may look: its regressors, and the sign that its first coefficient must have
/// (0: any).
struct Candidate {
  static constexpr std::size_t kMostRegressors = 3;
  Effect effect{Effect::kUnknown};
  std::uint8_t variant{0};  ///< place in the effect's grid
  std::uint8_t form{0};     ///< which of the effect's forms
  std::int8_t sign{0};
  std::size_t count{0};
  std::size_t slopes{0};  ///< how many of the last regressors are derivatives along the grid
  std::array<Regressor, kMostRegressors> regressor{};
};

[[nodiscard]] constexpr bool is_of_grid(const Candidate& a, const Candidate& b) noexcept {
  return a.effect == b.effect && a.form == b.form;
}
/// Two neighbours of a grid.
[[nodiscard]] constexpr bool is_pair(const Candidate& candidate) noexcept {
  return candidate.count - candidate.slopes > 1 && candidate.effect != Effect::kAsymmetricViscous;
}

/// Forms of the effects that have more than one.
enum Form : std::uint8_t {
  kPlainForm = 0,
  kOneSidedUp = 1,    ///< bump stop for y > 0
  kOneSidedDown = 2,  ///< bump stop for y < 0
  kPitchForm = 1,     ///< unmodelled mode: pitch of the frame
  kFlexibleForm = 2,  ///< unmodelled mode: a mass on the frame
  kAbsoluteForm = 1,  ///< progressive friction over |y|
  kFrameForm = 0,     ///< of time skew and gain: which channel
  kWheelset1Form = 1,
  kWheelset2Form = 2,
};

/// What candidates need of the base model, per unit of moving mass.
struct BaseForce {
  double coulomb{0.0};
  double stiffness{0.0};
};

inline constexpr std::size_t kMostCandidates = 128;
struct CandidateList {
  std::size_t count{0};
  std::array<Candidate, kMostCandidates> item{};
};

/// The library of effects, every point of every grid, and between neighbours where the grid is
/// wide.
void list_candidates(const BaseForce& base, const Grids& grids, CandidateList& out) noexcept;

/// A candidate with the derivatives of its regressor along the grid, per step, beside it: of its
/// length, speed or frequency, then of a mode's slip or damping. What lies between two points of a
/// grid, or has none, as it is.
[[nodiscard]] Candidate with_slopes(const Candidate& candidate, const Grids& grids) noexcept;

/// The candidates of a model that need the base force, with what is known of it now: channels that
/// are late or wrongly scaled.
void refresh(const BaseForce& base, Candidate& candidate) noexcept;

/// y and v as regressors.
[[nodiscard]] Regressor stiffness_regressor() noexcept;
[[nodiscard]] Regressor viscous_regressor() noexcept;

}  // namespace dampline::effect
