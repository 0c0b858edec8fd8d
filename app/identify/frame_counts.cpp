// SPDX-License-Identifier: MIT
#include "app/identify/frame_counts.hpp"

#include <fmt/format.h>

#include "dampline/sample/assembler.hpp"

namespace dampline::app {

void describe_frames(const hal::SourceHealth& health, const AssemblerCounts& counts,
                     RunResult& result) {
  const FrameLedger ledger = ledger_of(counts, health.dropped);
  result.counts.insert(result.counts.end(), {{"frames", health.frames},
                                             {"frames_sent", ledger.sent},
                                             {"frames_processed", ledger.processed},
                                             {"frames_dropped", ledger.kernel_drops},
                                             {"frames_missing", ledger.gaps},
                                             {"frames_excluded", ledger.excluded},
                                             {"frames_error", ledger.error},
                                             {"frames_foreign", ledger.foreign},
                                             {"frames_repeated", ledger.repeated},
                                             {"frames_late", ledger.too_late},
                                             {"frames_out_of_step", ledger.out_of_step},
                                             {"frames_wrong_length", ledger.wrong_length},
                                             {"frames_not_data", ledger.not_data},
                                             {"frames_other_page", ledger.other_page},
                                             {"frames_without_partner", ledger.without_partner},
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
