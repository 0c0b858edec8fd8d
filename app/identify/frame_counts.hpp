// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <string>

#include "app/run/result.hpp"
#include "dampline/sample/assembler.hpp"
#include "hal/frame_source.hpp"

namespace dampline::app {

/// Adds what became of the frames: frames_sent = frames_processed + frames_dropped +
/// frames_missing + frames_excluded, and the parts of the last; warnings where input was cut off or
/// skipped.
void describe_frames(const hal::SourceHealth& health, const AssemblerCounts& counts,
                     RunResult& result);

/// For an error message when not one sample came: what there was instead.
[[nodiscard]] std::string explain_no_sample(const hal::SourceHealth& health,
                                            const AssemblerCounts& counts,
                                            const std::array<ChannelConfig, kChannels>& channels);

}  // namespace dampline::app
