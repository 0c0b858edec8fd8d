// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/blackbox/format.hpp"

namespace dampline::drivers {

/// The records of one black box file after the other, through one fixed buffer. What is damaged is
/// passed over up to the next whole record. Allocates only when it is made.
class BlackboxFileReader {
 public:
  enum class Opened : std::uint8_t {
    kOpen,
    kGone,          ///< no such file
    kCutOff,        ///< shorter than its headers: its writer was stopped at the very beginning
    kNoHeader,      ///< neither copy of the header is there, or whole
    kOtherVersion,  ///< header().version says which
    kError,         ///< error_number() says why
  };
  enum class Status : std::uint8_t { kRecord, kEnd, kError };

  BlackboxFileReader() : buffer_(kBuffer) {}
  BlackboxFileReader(const BlackboxFileReader&) = delete;
  BlackboxFileReader& operator=(const BlackboxFileReader&) = delete;
  ~BlackboxFileReader() { close(); }

  Opened open(const char* path) noexcept;
  /// The payload is good until the next call.
  Status next(BlackboxRecord& record) noexcept;
  /// Goes on at the first whole record of the last `bytes`, without looking at what is before.
  void skip_to_tail(std::uint64_t bytes) noexcept;
  void close() noexcept;

  [[nodiscard]] const BlackboxHeader& header() const noexcept { return header_; }
  [[nodiscard]] int error_number() const noexcept { return error_number_; }
  /// Of this file: stretches without a whole record, with whole ones behind them.
  [[nodiscard]] std::uint64_t damaged_stretches() const noexcept { return damaged_; }
  /// After kEnd: what stands at the end of the file is no whole record.
  [[nodiscard]] bool torn() const noexcept { return torn_; }
  /// Of the byte after the record delivered last.
  [[nodiscard]] std::uint64_t offset() const noexcept { return offset_ - (end_ - begin_); }

 private:
  static constexpr std::size_t kBuffer = std::size_t{256} * 1024;
  Opened read_header() noexcept;
  [[nodiscard]] bool fill() noexcept;
  void take(const BlackboxRecord& record) noexcept;
  void skip_to_magic() noexcept;
  [[nodiscard]] std::span<const std::uint8_t> available() const noexcept {
    return {buffer_.data() + begin_, end_ - begin_};
  }

  int file_{-1};
  int error_number_{0};
  BlackboxHeader header_{};
  std::uint32_t seed_{0};
  std::uint64_t next_number_{0};  // the least that the next record may have
  std::uint64_t damaged_{0};
  bool in_damage_{false};
  bool torn_{false};
  bool at_end_{false};
  std::uint64_t offset_{0};  // in the file, of the end of the buffer
  std::size_t begin_{0};
  std::size_t end_{0};
  std::vector<std::uint8_t> buffer_;
};

}  // namespace dampline::drivers
