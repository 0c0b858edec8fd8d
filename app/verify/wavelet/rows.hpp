// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "app/verify/reference/chain.hpp"
#include "app/verify/reference/cooper_verner.hpp"
#include "published/wavelet/models.hpp"
#include "published/wavelet/motion_rows.hpp"

/// The models of the published cases, from the core's vocabulary.
namespace dampline::app {

using LinearTerms = TermList<Viscous, Spring>;
using ProductTerms = TermList<Viscous, Spring, Power<1, 1>>;
using DuffingTerms = TermList<Viscous, Spring, CubicSpring>;
using VanDerPolTerms = TermList<Viscous, Spring, VanDerPolDamper>;
using BothTerms = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper>;
template <class Sign>
using CoulombTerms = TermList<Viscous, Spring, Friction<Sign>>;
template <class Sign>
using LinearCoulombTerms = TermList<Viscous, Spring, Friction<Sign>, ProgressiveFriction<Sign>>;
using TeflonTerms = TermList<Viscous, Spring, Friction<TanhSign>, ExponentialFriction<TanhSign>>;

/// The over-specified models of tables 17 and 18: seven terms, and five per element, with Coulomb
/// friction or a square spring. c(3) is x^2 x' in equation 25 and x'^3 in equation 3.
template <class Sign, class ThirdDamper = VanDerPolDamper>
using SevenTerms =
    TermList<Viscous, Spring, CubicSpring, ThirdDamper, Power<2, 0>, Power<0, 2>, Friction<Sign>>;
using FiveTerms = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Friction<TanhSign>>;
using FiveSquareTerms = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Power<2, 0>>;

/// Least pivot of a column that still counts as determined: noiseless windows are short and smooth.
inline constexpr double kLeastPivot = 1e-14;

/// What the core sees of a system: deflections and forces, the masses, the step.
template <int Dof>
struct Measured {
  MotionRowsConfig<Dof> config;
  std::vector<MotionSample<Dof>> samples;
};

template <int Dof>
[[nodiscard]] Measured<Dof> measured(const sim::reference::Trajectory& truth,
                                     const std::vector<sim::reference::Real>& mass_kg) {
  Measured<Dof> out;
  out.config.step_s = truth.step_s;
  out.samples.resize(truth.deflection_m.front().size());
  for (std::size_t d = 0; d < static_cast<std::size_t>(Dof); ++d) {
    out.config.mass_kg[d] = static_cast<double>(mass_kg[d]);
    for (std::size_t n = 0; n < out.samples.size(); ++n) {
      out.samples[n].deflection_m[d] = truth.deflection_m[d][n];
      out.samples[n].force_n[d] = truth.force_n[d][n];
    }
  }
  return out;
}

/// Which rows count: those that the gate lets through (all of them, where the model has no kink),
/// or all, as the publication has it.
enum class Gate : std::uint8_t { kOn, kOff };

/// Streams the samples through the core's rows (`Rows` is MotionRows or CoarseRows) and calls
/// `use(row)` with each one that counts.
template <class Rows, class M, class Use>
void for_each_row(const Measured<M::kDof>& measured, const M& model, Use&& use,
                  Gate gate = Gate::kOn) {
  Rows rows = Rows::make(measured.config, model).value();
  MotionRow<M> row;
  for (const MotionSample<M::kDof>& sample : measured.samples) {
    if (rows.push(sample, row) && (row.usable || gate == Gate::kOff)) use(row);
  }
}

}  // namespace dampline::app
