// SPDX-License-Identifier: MIT
#pragma once
#include "app/config/config.hpp"
#include "app/diagnosis/truck/explain.hpp"
#include "app/record/feed.hpp"
#include "dampline/motion/frame_noise.hpp"

namespace dampline::app {

/// Names a low pass of the sensors that is not as declared: of all, where that explains more than
/// effects do; of the frame, where that is late by as much as its leaps' spectrum tells; of
/// wheelsets, where that explains more than their being late. What it looks like otherwise, to the
/// guards too, is named no more. `noise`: of the record's samples. Reads the record some times more
/// where something was found. Throws RunError.
void look_for_low_pass(const Config& config, const SourceOptions& source, const FrameNoise& noise,
                       Explained& out);

/// The frame's alone, which needs no further reading.
void look_for_frame_low_pass(const Config& config, const FrameNoise& noise, Explained& out);

}  // namespace dampline::app
