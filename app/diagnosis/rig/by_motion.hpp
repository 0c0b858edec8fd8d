// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/joint.hpp"

namespace dampline::app::rig {

/// What a model leaves of the motion of a part of the records, its figures where they leave least.
struct Screened {
  bool ok{false};        ///< it can be moved, and was
  bool followed{false};  ///< no more is left than the deflection's noise
  double nmse{0.0};      ///< held out
};
/// Precondition: the model has columns, a fit, and all that the records' force passes.
[[nodiscard]] Screened screen_by_motion(std::vector<Series> records, const Scale& scale,
                                        Model model);

/// Refines a driven mass's law by its own motion: the coefficients and places by which the measured
/// force moves the mass as it was measured (law::shoot). The equations' result is the start and the
/// check: where both agree within their deviations, that with the smaller deviations stays,
/// otherwise that which leaves less of the motion. Where more is left than the deflection's noise,
/// other forms of the same effects are tried. Writes model.free_run, and what is kept into the
/// model and the joint.
void refine_by_motion(std::vector<Series>& records, const Scale& scale, Model& model, Joint& joint);

}  // namespace dampline::app::rig
