// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "app/explain/explain_truck.hpp"
#include "app/explain/frame_noise.hpp"
#include "app/explain/truck_pass.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::app {

/// Reads a record once more, now that it is explained: what is left, sample by sample, and the
/// twin, which tells how much of that no effect can take away. Fills the explanation's floor and
/// conclusion, evidence and signature. `first`: the pass that was explained; `noise`: of the same
/// samples.
void look_again(const Config& config, const ExplainOptions& options, const TruckPass& first,
                const FrameNoise& noise, effect::Explainer& explainer, Explained& out);

/// Whether a source can be read twice.
[[nodiscard]] bool can_read_again(const std::string& path);

}  // namespace dampline::app
