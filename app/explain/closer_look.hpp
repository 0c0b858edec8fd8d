// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "app/explain/explain_truck.hpp"
#include "app/explain/frame_noise.hpp"
#include "app/explain/truck_pass.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::app {

/// Reads an explained record again, up to three times, where a first reading is coarse: grids are
/// drawn together around the lengths, speeds and frequencies that were found, and a late channel is
/// set right by what its column said (to first order, which is up to 30 % short) until nothing is
/// left of it but what a twin shows that is not late. `first`: the pass that was explained;
/// `noise`: of the same samples. What explains no better stays as it was.
void look_closer(const Config& config, const ExplainOptions& options, const TruckPass& first,
                 const FrameNoise& noise, effect::Explainer& explainer, Explained& out);

}  // namespace dampline::app
