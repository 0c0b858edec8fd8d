// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "app/explain/explain_truck.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::app {

/// What the base model holds and which effects may be added to it.
[[nodiscard]] effect::ExplainerConfig explainer_config(const Config& config);

/// Explains the sums of a record, of which out.identified tells the faults: where these forbid it,
/// no effect is named. False: the record is too short.
[[nodiscard]] bool judge_sums(const Config& config, const effect::Diagnosis& diagnosis,
                              effect::Explainer& explainer, Explained& out);

}  // namespace dampline::app
