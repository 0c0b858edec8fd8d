// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <string>
#include <string_view>

#include "sim_hw/simulation.hpp"

namespace dampline::sim {

/// Text grows here; whoever owns it empties it into a file.
using TextBuffer = fmt::memory_buffer;

inline constexpr std::string_view kSampleHeader =
    "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
inline constexpr std::string_view kExtrasHeader =
    "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2,frame_end_accel_mps2,"
    "far_frame_accel_mps2\n";
/// One row of the canonical CSV, with the extra sensors or without.
void append_csv(TextBuffer& text, const SimulatedSample& sample, bool extras = false);

/// The parameters of the run as comment lines, then the header of the truth columns.
[[nodiscard]] std::string truth_header(const SimulationConfig& config);
/// One row of truth: as the sensors' filter shows it, then as it is at the instant.
void append_truth(TextBuffer& text, const SimulatedSample& sample);

}  // namespace dampline::sim
