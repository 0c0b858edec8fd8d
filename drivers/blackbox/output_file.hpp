// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "drivers/blackbox/format.hpp"

namespace dampline::drivers {

inline constexpr int kFileMode = 0644;

/// How many records, by what they hold, and their length.
struct RecordCount {
  std::uint64_t frames{0};
  std::uint64_t events{0};
  std::uint64_t bytes{0};
  [[nodiscard]] std::uint64_t all() const noexcept { return frames + events; }
};

/// The black box file that is being written. Calls give an errno, 0 for success; after a call that
/// failed only abandon() is left.
class BlackboxOutput {
 public:
  BlackboxOutput();
  BlackboxOutput(const BlackboxOutput&) = delete;
  BlackboxOutput& operator=(const BlackboxOutput&) = delete;
  ~BlackboxOutput();

  /// Makes the file, which must not exist, and brings its headers and its name to the disk.
  /// When this fails there is no such file.
  [[nodiscard]] int begin(int directory, const BlackboxHeader& header) noexcept;
  [[nodiscard]] bool is_open() const noexcept { return file_ >= 0; }
  [[nodiscard]] bool has_room() const noexcept { return used_ + kLongestRecord <= buffer_.size(); }
  /// Precondition: has_room().
  void append(const CanFrame& frame) noexcept;
  void append(const hal::Event& event) noexcept;
  /// Hands the buffer to the kernel.
  [[nodiscard]] int flush() noexcept;
  /// flush(), and to the disk.
  [[nodiscard]] int sync() noexcept;
  /// After success of sync(), so that nothing can be lost any more.
  void end() noexcept;
  /// After `error`: cuts the file back to its last whole record, tries to save what was written
  /// unless it was the saving that failed, and closes it. Gives how many records may be lost. A
  /// file without a record is removed.
  std::uint64_t abandon(int directory, bool sync_failed) noexcept;

  [[nodiscard]] std::uint32_t number() const noexcept { return header_.file_number; }
  /// Records begun, with those in the buffer.
  [[nodiscard]] std::uint32_t records() const noexcept { return records_; }
  /// Whole records that the kernel has.
  [[nodiscard]] std::uint32_t whole_records() const noexcept { return whole_; }
  /// With what is in the buffer.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return written_ + used_; }
  [[nodiscard]] bool dirty() const noexcept { return unsynced_ + buffered_.all() > 0; }
  /// Handed to the kernel since the last call.
  [[nodiscard]] RecordCount take_written() noexcept;

 private:
  static constexpr std::size_t kBuffer = std::size_t{64} * 1024;
  [[nodiscard]] int write_all(const std::uint8_t* data, std::size_t bytes,
                              std::size_t& done) const noexcept;
  void count_whole(std::size_t done) noexcept;
  void close() noexcept;

  int file_{-1};
  BlackboxHeader header_{};
  std::uint32_t seed_{0};
  std::uint32_t records_{0};
  std::uint32_t whole_{0};
  std::uint64_t written_{0};   // bytes in the file: headers and whole records
  std::uint64_t unsynced_{0};  // records in the file that were not synced
  RecordCount buffered_{};
  RecordCount new_written_{};
  std::size_t used_{0};
  std::vector<std::uint8_t> buffer_;
};

}  // namespace dampline::drivers
