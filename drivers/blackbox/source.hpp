// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/blackbox/file_reader.hpp"
#include "drivers/candump/interface_table.hpp"
#include "drivers/outcome.hpp"
#include "hal/frame_source.hpp"

namespace dampline::drivers {

struct BlackboxSourceConfig {
  std::filesystem::path path;           ///< a directory, or one file
  std::vector<std::string> interfaces;  ///< only frames of these; empty: all
};

/// What a black box had to say beside its frames. Monotone counters.
struct BlackboxFindings {
  std::uint64_t files{0};              ///< read
  std::uint64_t unreadable_files{0};   ///< without a header, or gone meanwhile
  std::uint64_t damaged_stretches{0};  ///< in the middle of files
  std::uint64_t torn_ends{0};          ///< files that end in a part of a record: power was cut
  std::uint64_t missing{0};            ///< records whose numbers are missing
  std::uint64_t unknown{0};            ///< whole records of a kind that this version does not know
  std::uint64_t frames{0};
  std::uint64_t events{0};
  std::uint64_t runs_moved{0};  ///< see BlackboxSource
  std::int64_t first_ns{0};     ///< of the first frame
  std::int64_t newest_ns{0};    ///< of the newest
  [[nodiscard]] bool any_frame() const noexcept { return frames > 0; }
};

/// A black box as a source of frames and events, in the order in which they were written. Damage is
/// passed over to the next whole record. read() ends at every event, so that events come through
/// next_event() in their place among the frames; one that is not taken before the next read() is
/// forgotten. Neither waits nor allocates.
///
/// health(): dropped are the frames that the kernel dropped (kFramesDropped), those that never
/// reached the writer (kRecordsLost) and the records whose numbers are missing; malformed are the
/// damaged stretches and the unreadable files; truncated: the last file ends in a part of a record;
/// ignored are frames of interfaces that were not asked for, and records of unknown kinds. What the
/// live run counted is restored from the events.
///
/// A run that began, by the clock, before the one before had ended is moved to that end and counted
/// in runs_moved; a time that goes back within a run is held and counted as reordered. Times of
/// events are moved likewise, but not held: those of different threads may be a little out of
/// order.
class BlackboxSource final : public hal::FrameSource {
 public:
  static Outcome<std::unique_ptr<BlackboxSource>> open(const BlackboxSourceConfig& config);

  /// Why read() returned kIo: file, offset and reason.
  [[nodiscard]] const std::string& error_text() const noexcept { return error_; }
  /// Those of every file, from the beginning.
  [[nodiscard]] const InterfaceTable& interfaces() const noexcept { return interfaces_; }
  [[nodiscard]] const BlackboxFindings& findings() const noexcept { return findings_; }
  /// Of the files, oldest first.
  [[nodiscard]] const std::vector<std::string>& paths() const noexcept { return paths_; }

 private:
  BlackboxSource(const BlackboxSourceConfig& config, std::vector<std::string> paths);
  [[nodiscard]] Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override;
  [[nodiscard]] Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override {
    return true;
  }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override { return health_; }
  [[nodiscard]] bool do_next_event(hal::Event& out) noexcept override;

  enum class Step : std::uint8_t { kFrame, kEvent, kNothing, kStop };
  [[nodiscard]] Outcome<std::uint64_t> look_at_files();
  Step step(CanFrame& frame) noexcept;
  Step next_file() noexcept;
  void end_file() noexcept;
  Step take(const BlackboxRecord& record, CanFrame& frame) noexcept;
  Step take_frame(CanFrame& frame) noexcept;
  Step take_event(hal::Event event) noexcept;
  void restore(const hal::Event& event) noexcept;
  void expect(std::uint64_t sequence) noexcept;
  void use_header(const BlackboxHeader& header) noexcept;
  [[nodiscard]] bool wanted(std::string_view interface) const noexcept;
  void place(std::int64_t& time_ns) noexcept;
  Step stop(Errc reason, std::string text) noexcept;

  std::vector<std::string> paths_;
  std::size_t next_path_{0};
  std::vector<std::string> wanted_;
  InterfaceTable interfaces_;
  std::array<std::uint8_t, 256> index_of_{};  // of the current file's interfaces in the table
  std::array<bool, 256> is_wanted_{};
  BlackboxFileReader reader_;
  bool reading_{false};
  hal::Event event_{};  // read, and not taken yet
  bool has_event_{false};
  std::uint64_t run_id_{0};
  bool any_file_{false};
  bool any_time_{false};
  bool placed_{false};         // the current run's first record was seen
  std::int64_t moved_ns_{0};   // added to the times of the current run
  std::int64_t newest_ns_{0};  // of frames and events, as delivered
  std::uint64_t next_sequence_{0};
  bool stopped_{false};
  Errc reason_{Errc::kEndOfStream};
  hal::SourceHealth health_{};
  BlackboxFindings findings_{};
  std::string error_;
};

}  // namespace dampline::drivers
