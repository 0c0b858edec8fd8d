// SPDX-License-Identifier: MIT
#include "dampline/effect/explainer.hpp"

namespace dampline::effect {

void Explainer::restate(Explanation& e) noexcept {
  Model model = e.base_model;
  double before = fitter_.fit(model).held_out_nmse;
  e.base_restated_nmse = before;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    Step& step = e.step[i];
    if (step.chosen.count == 0) continue;  // no column, so no other error
    model = model.with(e.model.effect[e.base_count + i]);
    const double after = fitter_.fit(model).held_out_nmse;
    step.held_out_nmse_before = before;
    step.held_out_nmse_after = after;
    for (std::size_t r = 0; r < step.runner_up_count; ++r)
      step.runner_up[r].held_out_nmse = (1.0 - step.runner_up[r].gain) * before;
    before = after;
  }
}

}  // namespace dampline::effect
