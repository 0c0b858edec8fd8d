// SPDX-License-Identifier: MIT
#include "drivers/blackbox/format.hpp"

#include <algorithm>
#include <cstring>

#include "drivers/checksum/crc32c.hpp"

namespace dampline::drivers {
namespace {

// As PNG's: a transfer as text, or with 7 bits, is recognised.
constexpr std::array<std::uint8_t, 8> kFileMagic{0x89, 'D', 'B', 'B', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t kVersionAt = 8;
constexpr std::size_t kRecordsAtAt = 10;
constexpr std::size_t kFileNumberAt = 12;
constexpr std::size_t kRunIdAt = 16;
constexpr std::size_t kFirstSequenceAt = 24;
constexpr std::size_t kCreatedAt = 32;
constexpr std::size_t kMissingBeforeAt = 40;
constexpr std::size_t kInterfaceCountAt = 48;
constexpr std::size_t kInterfacesAt = 64;
constexpr std::size_t kHeaderChecksumAt = kHeaderBytes - 4;
static_assert(kInterfacesAt + kMostInterfaces * (kLongestName + 1) <= kHeaderChecksumAt);

constexpr std::size_t kFrameHead = 6;
constexpr std::size_t kEventBytes = 10;

constexpr unsigned kFdBit = 1U;
constexpr std::size_t kMostFd = 64;
constexpr std::size_t kMostClassic = 8;

/// Head and checksum around a payload that is already in its place.
std::size_t seal(std::uint8_t type, std::size_t payload, std::uint32_t number, std::int64_t time_ns,
                 std::uint32_t seed, std::uint8_t* out) noexcept {
  out[0] = kRecordMagic[0];
  out[1] = kRecordMagic[1];
  out[kRecordTypeAt] = type;
  out[kRecordLengthAt] = static_cast<std::uint8_t>(payload);
  put_little_endian(out + 4, number);
  put_little_endian(out + 8, time_ns);
  const std::size_t covered = kRecordHead + payload;
  put_little_endian(out + covered, crc32c({out, covered}, seed));
  return covered + kRecordTail;
}

std::uint32_t identifier_word(const CanFrame& frame) noexcept {
  return (frame.id & kExtendedMask) | (frame.extended ? kExtendedFlag : 0U) |
         (frame.remote ? kRemoteFlag : 0U) | (frame.error ? kErrorFlag : 0U);
}

}  // namespace

std::uint32_t BlackboxHeader::checksum_seed() const noexcept {
  std::array<std::uint8_t, 12> identity{};
  put_little_endian(identity.data(), run_id);
  put_little_endian(identity.data() + 8, file_number);
  return crc32c(identity);
}

void encode_header(const BlackboxHeader& header, std::span<std::uint8_t, kRecordsAt> out) noexcept {
  std::ranges::fill(out, std::uint8_t{0});
  std::uint8_t* const at = out.data();
  std::ranges::copy(kFileMagic, at);
  put_little_endian(at + kVersionAt, header.version);
  put_little_endian(at + kRecordsAtAt, static_cast<std::uint16_t>(kRecordsAt));
  put_little_endian(at + kFileNumberAt, header.file_number);
  put_little_endian(at + kRunIdAt, header.run_id);
  put_little_endian(at + kFirstSequenceAt, header.first_sequence);
  put_little_endian(at + kCreatedAt, header.created_ns);
  put_little_endian(at + kMissingBeforeAt, header.missing_before);
  at[kInterfaceCountAt] = header.interface_count;
  std::memcpy(at + kInterfacesAt, header.interfaces.data(), sizeof(header.interfaces));
  put_little_endian(at + kHeaderChecksumAt, crc32c({at, kHeaderChecksumAt}));
  std::memcpy(at + kSecondHeaderAt, at, kHeaderBytes);
}

HeaderFault decode_header(std::span<const std::uint8_t, kHeaderBytes> bytes,
                          BlackboxHeader& header) noexcept {
  const std::uint8_t* const at = bytes.data();
  if (!std::ranges::equal(bytes.first<kFileMagic.size()>(), kFileMagic))
    return HeaderFault::kNoHeader;
  if (get_little_endian<std::uint32_t>(at + kHeaderChecksumAt) !=
      crc32c(bytes.first<kHeaderChecksumAt>()))
    return HeaderFault::kDamaged;
  header.version = get_little_endian<std::uint16_t>(at + kVersionAt);
  if (header.version != kBlackboxVersion) return HeaderFault::kOtherVersion;
  header.file_number = get_little_endian<std::uint32_t>(at + kFileNumberAt);
  header.run_id = get_little_endian<std::uint64_t>(at + kRunIdAt);
  header.first_sequence = get_little_endian<std::uint64_t>(at + kFirstSequenceAt);
  header.created_ns = get_little_endian<std::int64_t>(at + kCreatedAt);
  header.missing_before = get_little_endian<std::uint64_t>(at + kMissingBeforeAt);
  header.interface_count = std::min(at[kInterfaceCountAt], std::uint8_t{kMostInterfaces});
  std::memcpy(header.interfaces.data(), at + kInterfacesAt, sizeof(header.interfaces));
  for (auto& name : header.interfaces) name.back() = '\0';
  return HeaderFault::kNone;
}

std::size_t encode_frame(const CanFrame& frame, std::uint32_t number, std::uint32_t seed,
                         std::uint8_t* out) noexcept {
  const std::size_t length = std::min<std::size_t>(frame.length, frame.fd ? kMostFd : kMostClassic);
  const std::size_t data = frame.remote ? 0 : length;
  const unsigned high = frame.remote ? static_cast<unsigned>(length) : frame.fd_flags;
  std::uint8_t* const payload = out + kRecordHead;
  put_little_endian(payload, identifier_word(frame));
  payload[4] = static_cast<std::uint8_t>((frame.fd ? kFdBit : 0U) |
                                         static_cast<unsigned>(frame.time_source) << 1U |
                                         (high & 0xFU) << 4U);
  payload[5] = frame.interface_index;
  std::memcpy(payload + kFrameHead, frame.data.data(), data);
  return seal(kFrameRecord, kFrameHead + data, number, frame.time_ns, seed, out);
}

std::size_t encode_event(const hal::Event& event, std::uint32_t number, std::uint32_t seed,
                         std::uint8_t* out) noexcept {
  std::uint8_t* const payload = out + kRecordHead;
  payload[0] = static_cast<std::uint8_t>(event.kind);
  payload[1] = event.line;
  put_little_endian(payload + 2, event.value);
  return seal(kEventRecord, kEventBytes, number, event.time_ns, seed, out);
}

bool decode_record(std::span<const std::uint8_t> bytes, std::uint32_t seed,
                   BlackboxRecord& record) noexcept {
  if (bytes.size() < kRecordHead + kRecordTail) return false;
  const std::uint8_t* const at = bytes.data();
  if (at[0] != kRecordMagic[0] || at[1] != kRecordMagic[1]) return false;
  const std::size_t covered = kRecordHead + at[kRecordLengthAt];
  if (bytes.size() < covered + kRecordTail) return false;
  if (get_little_endian<std::uint32_t>(at + covered) != crc32c({at, covered}, seed)) return false;
  record.type = at[kRecordTypeAt];
  record.number = get_little_endian<std::uint32_t>(at + 4);
  record.time_ns = get_little_endian<std::int64_t>(at + 8);
  record.payload = bytes.subspan(kRecordHead, at[kRecordLengthAt]);
  return true;
}

bool decode_frame(const BlackboxRecord& record, CanFrame& frame) noexcept {
  const std::size_t size = record.payload.size();
  if (record.type != kFrameRecord || size < kFrameHead) return false;
  const std::uint8_t* const at = record.payload.data();
  const auto word = get_little_endian<std::uint32_t>(at);
  const unsigned flags = at[4];
  frame = CanFrame{};
  frame.time_ns = record.time_ns;
  frame.id = word & kExtendedMask;
  frame.extended = (word & kExtendedFlag) != 0;
  frame.remote = (word & kRemoteFlag) != 0;
  frame.error = (word & kErrorFlag) != 0;
  frame.fd = (flags & kFdBit) != 0;
  frame.time_source = static_cast<TimeSource>(flags >> 1U & 3U);
  frame.interface_index = at[5];
  const std::size_t data = size - kFrameHead;
  if (data > (frame.fd ? kMostFd : kMostClassic)) return false;
  if (frame.time_source > TimeSource::kHardware) return false;
  frame.length = static_cast<std::uint8_t>(frame.remote ? flags >> 4U : data);
  if (frame.fd && !frame.remote) frame.fd_flags = static_cast<std::uint8_t>(flags >> 4U);
  std::memcpy(frame.data.data(), at + kFrameHead, data);
  return true;
}

bool decode_event(const BlackboxRecord& record, hal::Event& event) noexcept {
  if (record.type != kEventRecord || record.payload.size() != kEventBytes) return false;
  const std::uint8_t* const at = record.payload.data();
  event = {record.time_ns, static_cast<hal::EventKind>(at[0]), at[1],
           get_little_endian<std::int64_t>(at + 2)};
  return true;
}

}  // namespace dampline::drivers
