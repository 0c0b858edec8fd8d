// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <vector>

#include "drivers/blackbox/format.hpp"
#include "drivers/blackbox/shelf.hpp"
#include "drivers/checksum/crc32c.hpp"
#include "tests/blackbox.hpp"

namespace dampline::drivers {
namespace {

using Bytes = std::vector<std::uint8_t>;

BlackboxHeader some_header() {
  BlackboxHeader header;
  header.file_number = 0x01020304;
  header.run_id = 0x1122334455667788ULL;
  header.first_sequence = 77;
  header.created_ns = -5;
  header.missing_before = 6;
  header.interface_count = 1;
  std::ranges::copy(std::string_view{"can0"}, header.interfaces[0].begin());
  return header;
}

Bytes encoded(const CanFrame& frame, std::uint32_t number = 1, std::uint32_t seed = 0) {
  Bytes bytes(kLongestRecord);
  bytes.resize(encode_frame(frame, number, seed, bytes.data()));
  return bytes;
}

CanFrame read_back(const CanFrame& frame) {
  const Bytes bytes = encoded(frame);
  BlackboxRecord record;
  CanFrame read;
  EXPECT_TRUE(decode_record(bytes, 0, record));
  EXPECT_TRUE(decode_frame(record, read));
  return read;
}

// The bytes, by hand: whoever changes them must raise the version.
TEST(BlackboxFormat, IsTheDocumentedOne) {
  CanFrame frame;
  frame.time_ns = 0x0102030405060708;
  frame.id = 0x310;
  frame.length = 3;
  frame.data = {0xA, 0xB, 0xC};
  frame.interface_index = 2;
  frame.time_source = TimeSource::kSoftware;
  Bytes expected{0xDB, 0x1E, 1, 9,    0x44, 0x33, 0x22, 0x11, 8, 7,   6,   5,  4,
                 3,    2,    1, 0x10, 3,    0,    0,    0x02, 2, 0xA, 0xB, 0xC};
  const std::uint32_t crc = crc32c(expected, 0x55AA55AA);
  for (unsigned i = 0; i < 4; ++i) expected.push_back(static_cast<std::uint8_t>(crc >> (8 * i)));
  EXPECT_EQ(encoded(frame, 0x11223344, 0x55AA55AA), expected);
}

TEST(BlackboxFormat, TheHeaderIsTheDocumentedOne) {
  Bytes expected(512);
  const auto put = [&](std::size_t at, const Bytes& bytes) {
    std::ranges::copy(bytes, expected.begin() + static_cast<std::ptrdiff_t>(at));
  };
  put(0, {0x89, 'D', 'B', 'B', '\r', '\n', 0x1A, '\n', 1, 0, 0x00, 0x06, 4, 3, 2, 1});
  put(16, {0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 77, 0, 0, 0, 0, 0, 0, 0});
  put(32, {0xFB, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 6});
  put(48, {1});
  put(64, {'c', 'a', 'n', '0'});
  const std::uint32_t crc = crc32c(std::span{expected}.first(508));
  for (unsigned i = 0; i < 4; ++i) expected[508 + i] = static_cast<std::uint8_t>(crc >> (8 * i));
  expected.resize(1536);
  std::ranges::copy(std::span{expected}.first(512), expected.begin() + 1024);
  Bytes written(kRecordsAt, 0xEE);
  encode_header(some_header(), std::span<std::uint8_t, kRecordsAt>{written});
  EXPECT_EQ(written, expected);
  const std::uint32_t seed =
      crc32c(Bytes{0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 4, 3, 2, 1});
  EXPECT_EQ(some_header().checksum_seed(), seed) << "run number and file number";
}

TEST(BlackboxFormat, KeepsEveryFieldOfAFrame) {
  for (std::uint64_t i = 0; i < 200; ++i)
    ASSERT_TRUE(test::same(read_back(test::numbered_frame(i)), test::numbered_frame(i))) << i;
  CanFrame remote = test::numbered_frame(0);
  remote.remote = true;
  remote.data = {};
  EXPECT_TRUE(test::same(read_back(remote), remote));
  CanFrame error = test::numbered_frame(0);
  error.error = true;
  error.id = 0x1FFFFFFF;
  EXPECT_TRUE(test::same(read_back(error), error));
  CanFrame longest = test::numbered_frame(4);
  longest.length = 64;
  longest.data.fill(0xDB);
  EXPECT_TRUE(test::same(read_back(longest), longest));
  EXPECT_LE(encoded(longest).size(), kLongestRecord);
}

TEST(BlackboxFormat, KeepsEveryFieldOfAnEvent) {
  Bytes bytes(kLongestRecord);
  const hal::Event event{-1, hal::EventKind::kClockStep, 200, -3'600'000'000'000};
  bytes.resize(encode_event(event, 5, 9, bytes.data()));
  EXPECT_EQ(bytes.size(), 30U);
  BlackboxRecord record;
  hal::Event read;
  CanFrame frame;
  ASSERT_TRUE(decode_record(bytes, 9, record));
  EXPECT_EQ(record.number, 5U);
  EXPECT_FALSE(decode_frame(record, frame));
  ASSERT_TRUE(decode_event(record, read));
  EXPECT_EQ(read.time_ns, event.time_ns);
  EXPECT_EQ(read.kind, event.kind);
  EXPECT_EQ(read.line, event.line);
  EXPECT_EQ(read.value, event.value);
}

TEST(BlackboxFormat, TakesNoRecordOfAnotherFile) {
  const BlackboxHeader header = some_header();
  BlackboxHeader other_number = header;
  ++other_number.file_number;
  BlackboxHeader other_run = header;
  other_run.run_id ^= 1U;
  const Bytes bytes = encoded(test::numbered_frame(1), 1, header.checksum_seed());
  BlackboxRecord record;
  EXPECT_TRUE(decode_record(bytes, header.checksum_seed(), record));
  EXPECT_FALSE(decode_record(bytes, other_number.checksum_seed(), record));
  EXPECT_FALSE(decode_record(bytes, other_run.checksum_seed(), record));
}

TEST(BlackboxFormat, TakesNoPartOfARecord) {
  const Bytes bytes = encoded(test::numbered_frame(1));
  BlackboxRecord record;
  for (std::size_t length = 0; length < bytes.size(); ++length)
    EXPECT_FALSE(decode_record(std::span{bytes}.first(length), 0, record)) << length;
}

TEST(BlackboxFormat, RefusesARecordThatIsWholeButNoFrame) {
  CanFrame classic = test::numbered_frame(0);
  classic.fd = true;
  classic.length = 12;
  Bytes bytes = encoded(classic);
  BlackboxRecord record;
  ASSERT_TRUE(decode_record(bytes, 0, record));
  bytes[kRecordHead + 4] = 0;  // 12 bytes, and not CAN FD
  CanFrame read;
  EXPECT_FALSE(decode_frame(record, read));
}

TEST(BlackboxFormat, KeepsTheHeaderTwice) {
  std::array<std::uint8_t, kRecordsAt> bytes{};
  encode_header(some_header(), bytes);
  const std::span<const std::uint8_t, kRecordsAt> all{bytes};
  for (const auto copy :
       {all.first<kHeaderBytes>(), all.subspan<kSecondHeaderAt, kHeaderBytes>()}) {
    BlackboxHeader read;
    ASSERT_EQ(decode_header(copy, read), HeaderFault::kNone);
    EXPECT_EQ(read.file_number, 0x01020304U);
    EXPECT_EQ(read.run_id, 0x1122334455667788ULL);
    EXPECT_EQ(read.first_sequence, 77U);
    EXPECT_EQ(read.created_ns, -5);
    EXPECT_EQ(read.missing_before, 6U);
    EXPECT_EQ(read.interface_count, 1);
    EXPECT_EQ(read.interface_name(0), "can0");
  }
}

TEST(BlackboxFormat, SeesEveryFlippedBitOfAHeader) {
  std::array<std::uint8_t, kRecordsAt> bytes{};
  encode_header(some_header(), bytes);
  const auto first = std::span<const std::uint8_t, kRecordsAt>{bytes}.first<kHeaderBytes>();
  for (std::size_t bit = 0; bit < 8 * kHeaderBytes; ++bit) {
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    BlackboxHeader read;
    const HeaderFault fault = decode_header(first, read);
    EXPECT_TRUE(fault == HeaderFault::kNoHeader || fault == HeaderFault::kDamaged) << bit;
    bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
  }
}

TEST(BlackboxFileNames, SortByTheirNumbers) {
  EXPECT_EQ(blackbox_file_name(1), "blackbox-000001.dbb");
  EXPECT_EQ(blackbox_file_name(1234567), "blackbox-1234567.dbb");
  for (const std::uint32_t number : {0U, 1U, 999999U, 1000000U, 4294967295U})
    EXPECT_EQ(blackbox_file_number(blackbox_file_name(number)), number);
  for (const char* other :
       {"blackbox-1.dbb", "blackbox-0000001.dbb", "blackbox-00000x.dbb", "blackbox-000001.dbb~",
        "xblackbox-000001.dbb", "blackbox-.dbb", "blackbox-99999999999.dbb", ""})
    EXPECT_FALSE(blackbox_file_number(other)) << other;
}

}  // namespace
}  // namespace dampline::drivers
