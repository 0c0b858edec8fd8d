// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/joint.hpp"
#include "app/law/free_run.hpp"

namespace dampline::app::rig {

/// A model of a driven mass as a law that can be moved; nothing where it has no mass, or parts that
/// a free run does not have: changes over time, lateness, modes, a bank of elements.
[[nodiscard]] std::optional<law::Law> law_of(const Model& model, const Scale& scale);

/// Refines a driven mass's law by its own motion: the coefficients and places by which the measured
/// force moves the mass as it was measured (law::shoot). The equations' result is the start and the
/// check: where both agree within their deviations, that with the smaller deviations stays,
/// otherwise that which leaves less of the motion. Where more is left than the deflection's noise,
/// other forms of the same effects are tried. Writes model.free_run, and what is kept into the
/// model and the joint.
void refine_by_motion(std::vector<Series>& records, const Scale& scale, Model& model, Joint& joint);

}  // namespace dampline::app::rig
