// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/sample/assembler.hpp"

namespace dampline {

/// Where every frame went: sent = processed + kernel_drops + gaps + excluded, without a rest.
/// What nobody saw follows from the counters within the frames: frames before the first and after
/// the last one that arrived are unknown, and how long a pause of more than kPauseTicks was follows
/// from time. Exact where each channel has a counter and an identifier of its own, and where the
/// kernel drops no other frames than theirs.
struct FrameLedger {
  std::uint64_t sent{0};
  std::uint64_t processed{0};     ///< became part of a sample
  std::uint64_t kernel_drops{0};  ///< arrived, but there was no room
  std::uint64_t gaps{0};          ///< missing from their channel's sequence, for no known reason
  std::uint64_t excluded{0};      ///< arrived and was not used; the sum of those below
  std::uint64_t error{0};
  std::uint64_t foreign{0};
  std::uint64_t repeated{0};
  std::uint64_t too_late{0};
  std::uint64_t out_of_step{0};
  std::uint64_t wrong_length{0};
  std::uint64_t not_data{0};
  std::uint64_t other_page{0};
  std::uint64_t without_partner{0};  ///< another channel's reading of that instant was missing
};

/// Call after flush(): before it, up to four frames of a channel without a counter are undecided.
[[nodiscard]] FrameLedger ledger_of(const AssemblerCounts& counts,
                                    std::uint64_t kernel_drops) noexcept;

}  // namespace dampline
