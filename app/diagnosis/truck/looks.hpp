// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/pass.hpp"
#include "dampline/effect/explainer.hpp"
#include "dampline/motion/frame_noise.hpp"

namespace dampline::app {

/// Reads an explained record again, up to three times, where a first reading is coarse: grids are
/// drawn together around the lengths, speeds and frequencies that were found, and a late channel is
/// set right by what its column said (to first order, which is up to 30 % short) until nothing is
/// left of it but what a surrogate shows that is not late. `first`: the pass that was explained;
/// `noise`: of the same samples. What explains no better stays as it was.
void look_closer(const Config& config, const ExplainOptions& options, const TruckPass& first,
                 const FrameNoise& noise, effect::Explainer& explainer, Explained& out);

/// Reads a record once more, now that it is explained: what is left, sample by sample, and the
/// surrogate, which tells how much of that no effect can take away. Fills the explanation's floor
/// and conclusion, evidence and signature. `first`: the pass that was explained; `noise`: of the
/// same samples; `search`: sees what is left, too. False: the surrogate shows the first effect as
/// well, which is needless then, and the record is to be explained anew without it.
[[nodiscard]] bool look_again(const Config& config, const ExplainOptions& options,
                              const TruckPass& first, const FrameNoise& noise,
                              effect::Explainer& explainer, Explained& out,
                              OtherTruckSearch& search);

/// Whether a source can be read twice.
[[nodiscard]] bool can_read_again(const std::string& path);

}  // namespace dampline::app
