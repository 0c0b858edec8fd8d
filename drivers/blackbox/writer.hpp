// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "drivers/blackbox/format.hpp"
#include "drivers/blackbox/output_file.hpp"
#include "drivers/blackbox/shelf.hpp"
#include "drivers/outcome.hpp"
#include "hal/record_sink.hpp"

namespace dampline::drivers {

struct BlackboxConfig {
  std::filesystem::path directory;                       ///< made when it is not there
  std::vector<std::string> interfaces;                   ///< their names, by interface_index
  std::uint64_t rotate_bytes{std::uint64_t{64} << 20U};  ///< no file is larger
  std::int64_t rotate_ns{3'600'000'000'000};             ///< nor written to for longer
  std::uint64_t keep_bytes{0};                           ///< of all files; 0: for ever
  std::int64_t keep_ns{0};                               ///< age of a file; 0: for ever
  std::int64_t sync_interval_ns{1'000'000'000};          ///< at most so much is lost
  /// Left free on the file system: the oldest files go where keep_bytes lets them, then it stops.
  std::uint64_t reserve_free_bytes{0};
  std::int64_t retry_ns{5'000'000'000};  ///< between attempts to go on
};

/// Frames and events into files of a directory (firmware_core/docs/blackbox_format.md).
///
/// Every record has a sequence number, whether or not it can be written, so that whoever reads the
/// files sees how many are missing. What is in memory goes to the kernel at every tick() and to the
/// disk at every sync interval. A write or sync that fails is the end of its file. After one that a
/// new file may cure, a new one is begun at once; without space, or when that fails too, recording
/// stops and is tried again every `retry_ns`. When it goes on, the new file begins with
/// kRecordingStopped and kRecordingResumed, whose value is the number of records that were lost;
/// those of a failed sync count among them, though they may be readable. A file that follows a
/// complete one begins with kFileRotated. A directory that is removed under the writer is made
/// again. One writer a directory: a lock file sees to it. Not for two threads at once.
class BlackboxWriter final : public hal::RecordSink {
 public:
  static Outcome<std::unique_ptr<BlackboxWriter>> open(const BlackboxConfig& config);
  BlackboxWriter(const BlackboxWriter&) = delete;
  BlackboxWriter& operator=(const BlackboxWriter&) = delete;
  ~BlackboxWriter() override;

  /// The number that the next record takes.
  [[nodiscard]] std::uint64_t next_sequence() const noexcept { return next_sequence_; }

 private:
  /// Of the directory and of the lock file; -1: none.
  struct Handles {
    int directory{-1};
    int lock{-1};
    Handles() = default;
    Handles(Handles&& other) noexcept;
    Handles& operator=(Handles&& other) noexcept;
    Handles(const Handles&) = delete;
    Handles& operator=(const Handles&) = delete;
    ~Handles();
  };
  static Outcome<Handles> take_directory(const std::filesystem::path& directory);

  BlackboxWriter(BlackboxConfig config, Handles handles, BlackboxShelf shelf,
                 const BlackboxHeader& header);
  void do_write(const CanFrame& frame) noexcept override;
  void do_write(const hal::Event& event) noexcept override;
  void do_tick(std::int64_t monotonic_ns) noexcept override;
  void do_rotate() noexcept override;
  void do_close() noexcept override;
  [[nodiscard]] hal::RecordHealth do_health() const noexcept override { return health_; }

  template <class Record>
  void add(const Record& record) noexcept;
  template <class Record>
  void put(const Record& record) noexcept;
  [[nodiscard]] bool make_ready() noexcept;
  [[nodiscard]] bool begin_file() noexcept;
  void finish_file() noexcept;
  void fail(int error, bool sync_failed) noexcept;
  void stop(int error, std::uint64_t lost) noexcept;
  void lose(std::uint64_t records) noexcept;
  [[nodiscard]] bool resume() noexcept;
  void flush() noexcept;
  void sync() noexcept;
  void take_counts() noexcept;
  void remove_old_files() noexcept;
  void keep_reserve() noexcept;
  [[nodiscard]] bool has_space(std::uint64_t beyond_reserve) const noexcept;
  [[nodiscard]] bool directory_gone() const noexcept;
  [[nodiscard]] bool make_directory_again() noexcept;

  BlackboxConfig config_;
  Handles handles_;
  BlackboxShelf shelf_;
  BlackboxHeader header_;  // of the file that is open, or was
  BlackboxOutput output_;
  hal::RecordHealth health_{};
  std::uint32_t next_number_;
  std::uint64_t next_sequence_;
  std::uint64_t written_end_;  // behind the last record that a file has
  std::int64_t newest_ns_{0};  // run time of the newest record
  std::int64_t now_ns_{0};     // monotonic, of the tick before
  bool ticked_{false};
  std::int64_t began_ns_{0};    // monotonic; the current file
  std::int64_t synced_ns_{0};   // monotonic
  bool rotated_{false};         // the file before was ended because it was complete
  std::int64_t stopped_ns_{0};  // run time
  int stopped_errno_{0};
  std::int64_t retry_at_ns_{0};
  std::uint64_t lost_since_stop_{0};
};

}  // namespace dampline::drivers
