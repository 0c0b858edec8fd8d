// SPDX-License-Identifier: MIT
#include "app/identify/frame_counts.hpp"

#include <fmt/format.h>

namespace dampline::app {

void describe_frames(const hal::SourceHealth& health, const AssemblerCounts& counts,
                     RunResult& result) {
  result.counts.insert(result.counts.end(), {{"frames", health.frames},
                                             {"frames_foreign", counts.foreign},
                                             {"frames_dropped", health.dropped},
                                             {"frames_reordered", health.reordered},
                                             {"lines_malformed", health.malformed},
                                             {"lines_ignored", health.ignored},
                                             {"incomplete", counts.incomplete},
                                             {"restarts", counts.restarts}});
  if (health.truncated)
    result.warnings.emplace_back(
        "The record was cut off in the middle of its last frame; what is before that frame was "
        "used.");
  if (health.malformed > 0)
    result.warnings.push_back(
        fmt::format("{} malformed or damaged frames were skipped.", health.malformed));
}

std::string explain_no_sample(const hal::SourceHealth& health, const AssemblerCounts& counts,
                              const std::array<ChannelConfig, kChannels>& channels) {
  std::string readings;
  for (std::size_t c = 0; c < kChannels; ++c)
    readings += fmt::format("{}0x{:X}: {}", c == 0 ? "" : ", ", channels[c].id,
                            counts.channels[c].readings);
  return fmt::format(
      "of {} frames ({} malformed ones skipped), {} had other identifiers than [input."
      "can] names; readings by identifier {}; {} instants lacked a channel",
      counts.frames, health.malformed, counts.foreign, readings, counts.incomplete);
}

}  // namespace dampline::app
