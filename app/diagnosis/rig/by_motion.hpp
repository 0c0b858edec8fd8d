// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/joint.hpp"

namespace dampline::app::rig {

/// Whether the force has white noise that moves the mass visibly, where its spectrum is quietest.
[[nodiscard]] bool is_force_noisy(const std::vector<Series>& records);

/// What a model leaves of the motion of a part of the records, its figures where they leave least.
struct Screened {
  bool ok{false};        ///< it can be moved, and was
  bool followed{false};  ///< hardly more is left than noise
  bool is_noise{false};  ///< no more is
  bool compared{false};  ///< with all other forms of the same effects, where there are any
  double nmse{0.0};      ///< held out
  double samples{0.0};
  Model model;  ///< in the form, with the figures, that leave least
};
/// Other forms of the same effects are tried too where less than `forms_below` is left.
/// Precondition: the model has columns, a fit, and all that the records' force passes.
[[nodiscard]] Screened screen_by_motion(std::vector<Series> records, const Scale& scale,
                                        Model model, double forms_below);

/// Refines a driven mass's law by its own motion: the coefficients and places by which the measured
/// force moves the mass as it was measured (law::shoot). The equations' result is the start and the
/// check: where both agree within their deviations, that with the smaller deviations stays,
/// otherwise that which leaves less of the motion. Other forms of the same effects are tried,
/// unless `screened` has compared those of the same columns. Writes model.free_run, and what is
/// kept into the model and the joint.
void refine_by_motion(std::vector<Series>& records, const Scale& scale, const Screened& screened,
                      Model& model, Joint& joint);

}  // namespace dampline::app::rig
