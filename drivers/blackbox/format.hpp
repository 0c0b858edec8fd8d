// SPDX-License-Identifier: MIT
// The black box's bytes: firmware_core/docs/blackbox_format.md.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "dampline/can_frame.hpp"
#include "drivers/record/identifier.hpp"
#include "hal/event.hpp"

namespace dampline::drivers {

template <class T>
inline void put_little_endian(std::uint8_t* at, T value) noexcept {
  const auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < sizeof(T); ++i) at[i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

template <class T>
[[nodiscard]] inline T get_little_endian(const std::uint8_t* at) noexcept {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) bits |= static_cast<std::uint64_t>(at[i]) << (8 * i);
  return static_cast<T>(bits);
}

inline constexpr std::uint16_t kBlackboxVersion = 1;
inline constexpr std::size_t kHeaderBytes = 512;
/// The header stands twice, so far apart that a lost sector cannot take both.
inline constexpr std::size_t kSecondHeaderAt = 1024;
inline constexpr std::size_t kRecordsAt = 1536;
inline constexpr std::size_t kMostInterfaces = 27;
inline constexpr std::size_t kRecordHead = 16;
inline constexpr std::size_t kRecordTail = 4;
/// What a payload can have by its length field; what we write is shorter.
inline constexpr std::size_t kLongestPayload = 255;
inline constexpr std::size_t kLongestRecord = kRecordHead + kLongestPayload + kRecordTail;
inline constexpr std::array<std::uint8_t, 2> kRecordMagic{0xDB, 0x1E};
inline constexpr std::size_t kRecordTypeAt = 2;
inline constexpr std::size_t kRecordLengthAt = 3;
inline constexpr std::uint8_t kFrameRecord = 1;
inline constexpr std::uint8_t kEventRecord = 2;

/// What a file says of itself.
struct BlackboxHeader {
  std::uint16_t version{kBlackboxVersion};
  std::uint32_t file_number{0};
  std::uint64_t run_id{0};          ///< random, one for each start of a writer
  std::uint64_t first_sequence{0};  ///< of the record with number 0
  std::int64_t created_ns{0};       ///< run time
  std::uint64_t missing_before{0};  ///< records between the file before and this one, not written
  std::uint8_t interface_count{0};
  std::array<std::array<char, kLongestName + 1>, kMostInterfaces> interfaces{};

  [[nodiscard]] std::string_view interface_name(std::size_t index) const noexcept {
    return interfaces[index].data();
  }
  /// Where the checksum of this file's records begins: no record of another file fits.
  [[nodiscard]] std::uint32_t checksum_seed() const noexcept;
};

enum class HeaderFault : std::uint8_t { kNone, kNoHeader, kDamaged, kOtherVersion };

/// Writes both copies and the zeros between and behind them.
void encode_header(const BlackboxHeader& header, std::span<std::uint8_t, kRecordsAt> out) noexcept;
/// Reads one copy. With kOtherVersion `header.version` is set.
[[nodiscard]] HeaderFault decode_header(std::span<const std::uint8_t, kHeaderBytes> bytes,
                                        BlackboxHeader& header) noexcept;

/// A record as it lies in a file.
struct BlackboxRecord {
  std::uint8_t type{0};
  std::uint32_t number{0};  ///< in its file; sequence = first_sequence + number
  std::int64_t time_ns{0};
  std::span<const std::uint8_t> payload{};

  [[nodiscard]] std::size_t bytes() const noexcept {
    return kRecordHead + payload.size() + kRecordTail;
  }
};

/// Both write one record and return its length, at most kLongestRecord.
std::size_t encode_frame(const CanFrame& frame, std::uint32_t number, std::uint32_t seed,
                         std::uint8_t* out) noexcept;
std::size_t encode_event(const hal::Event& event, std::uint32_t number, std::uint32_t seed,
                         std::uint8_t* out) noexcept;

/// A whole, undamaged record of this file at the beginning of `bytes`. The payload is a view.
[[nodiscard]] bool decode_record(std::span<const std::uint8_t> bytes, std::uint32_t seed,
                                 BlackboxRecord& record) noexcept;
/// False when the record is of another type, or of a form that this version does not know.
[[nodiscard]] bool decode_frame(const BlackboxRecord& record, CanFrame& frame) noexcept;
[[nodiscard]] bool decode_event(const BlackboxRecord& record, hal::Event& event) noexcept;

}  // namespace dampline::drivers
