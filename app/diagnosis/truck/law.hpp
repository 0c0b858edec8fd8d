// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/run/result.hpp"
#include "dampline/effect/conclusion.hpp"

namespace dampline::app {

/// The damping force in steady sliding, undeflected, over velocities to `reach_mps` on either side:
/// as the base and the final model have it, its jump at zero as wide as the velocity's error.
[[nodiscard]] std::vector<LawRow> truck_law(const effect::Explanation& explanation,
                                            double moving_mass_kg, double reach_mps);

/// Forces of the final law in the place of those of `curve`, at its velocities.
void put_law(const effect::Explanation& explanation, std::vector<CurveRow>& curve);

/// The viscous part of a base that has one, in the final model.
[[nodiscard]] Estimate final_viscous(const effect::Explanation& explanation);

/// Parameters of the final model as the first part of the record gives them, again and again:
/// friction, spring, and those of the effects that are coefficients. `store`: the sums that the
/// explanation is of.
[[nodiscard]] Convergence convergence_of(const effect::Explanation& explanation,
                                         const effect::GramStore& store, double duration_s);

}  // namespace dampline::app
