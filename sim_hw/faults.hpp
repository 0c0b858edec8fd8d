// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "sim_hw/simulation.hpp"
#include "sim_hw/transport.hpp"

namespace dampline::sim {

/// What `add_fault_text` understands, one per line with its parameters and their defaults.
inline constexpr std::string_view kFaultHelp =
    "loss:fraction=0.05 (of the frames) | "
    "swap:fraction=0 and time_s=-1 (frames that arrive after the next of their message) | "
    "clipping:channel=wheelset1,range_mps2=3 (the sensor's full scale; needs its own DBC) | "
    "soft_clipping:channel=wheelset1,limit_mps2=3 (below full scale) | "
    "stuck:channel=wheelset1,start_s=100,end_s=130";

/// Adds a sensor or transport fault from text, NAME or NAME:parameter=value,...
/// Returns what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> add_fault_text(SimulationConfig& config,
                                                        TransportConfig& transport,
                                                        std::string_view text);

}  // namespace dampline::sim
