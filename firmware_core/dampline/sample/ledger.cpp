// SPDX-License-Identifier: MIT
#include "dampline/sample/ledger.hpp"

namespace dampline {

FrameLedger ledger_of(const AssemblerCounts& counts, std::uint64_t kernel_drops) noexcept {
  FrameLedger ledger;
  ledger.kernel_drops = kernel_drops;
  ledger.processed = kChannels * counts.samples;
  ledger.error = counts.error;
  ledger.foreign = counts.foreign;
  std::uint64_t readings = 0;
  std::uint64_t missing = 0;           // places in the sequences that hold no reading
  std::uint64_t known = kernel_drops;  // of them, those whose frame arrived or was dropped
  for (const ChannelCounts& channel : counts.channels) {
    readings += channel.readings;
    missing += channel.lost + channel.paused - (channel.late - channel.too_late);
    known += channel.out_of_step + channel.wrong_length + channel.misjudged;
    ledger.repeated += channel.repeated;
    ledger.too_late += channel.too_late;
    ledger.out_of_step += channel.out_of_step;
    ledger.wrong_length += channel.wrong_length;
    ledger.not_data += channel.not_data;
    ledger.other_page += channel.other_page;
  }
  ledger.gaps = missing > known ? missing - known : 0;
  ledger.without_partner = readings - ledger.processed;
  ledger.excluded = ledger.error + ledger.foreign + ledger.repeated + ledger.too_late +
                    ledger.out_of_step + ledger.wrong_length + ledger.not_data + ledger.other_page +
                    ledger.without_partner;
  ledger.sent = ledger.processed + ledger.kernel_drops + ledger.gaps + ledger.excluded;
  return ledger;
}

}  // namespace dampline
