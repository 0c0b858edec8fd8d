// SPDX-License-Identifier: MIT
#include "dampline/effect/explainer.hpp"

namespace dampline::effect {

void Explainer::restate(Explanation& e) noexcept {
  Model model = e.base_model;
  double before = fitter_.fit(model).held_out_nmse;
  e.base_restated_nmse = before;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    Step& step = e.step[i];
    const Candidate& added = e.model.effect[e.base_count + i];
    step.restated_before = step.held_out_nmse_before;
    step.restated_after = step.held_out_nmse_after;
    if (added.count == 0) continue;  // no column, so no other error
    model = model.with(added);
    step.restated_before = before;
    step.restated_after = before = fitter_.fit(model).held_out_nmse;
  }
}

}  // namespace dampline::effect
