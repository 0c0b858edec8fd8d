// SPDX-License-Identifier: MIT
#pragma once
#include <sys/types.h>

#include <array>
#include <cstdint>
#include <string>

#include "dampline/sample/assembler.hpp"
#include "hal/frame_source.hpp"

namespace dampline::bus {

/// What a reader knows at its end.
struct ReaderReport {
  FrameLedger ledger{};
  AssemblerCounts counts{};
  hal::SourceHealth health{};
  std::array<std::uint64_t, 32> events{};  ///< by number of hal::EventKind
  std::uint64_t time_went_back{0};         ///< frames earlier than the one before
  std::int64_t longest_gap_ns{0};          ///< between two frames, by their times
};

struct ReaderConfig {
  std::string interface {};
  int receive_buffer_bytes{8 * 1024 * 1024};
  bool filters{true};  ///< in the kernel, for the three sensors
};

/// The driver and the assembler in a process of their own, so that it can be stopped.
class Reader {
 public:
  explicit Reader(const ReaderConfig& config);
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader();
  [[nodiscard]] pid_t pid() const noexcept { return pid_; }
  /// Lets it read what is still there, then ends it.
  [[nodiscard]] ReaderReport finish();

 private:
  pid_t pid_{-1};
  int to_reader_{-1};
  int from_reader_{-1};
};

}  // namespace dampline::bus
