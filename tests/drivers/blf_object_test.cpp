// SPDX-License-Identifier: MIT
// Objects byte by byte, as python-can's reader has the format.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <array>
#include <cstring>
#include <limits>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "drivers/blf/object.hpp"
#include "drivers/blf/source.hpp"
#include "tests/drivers/file_frames.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::FileFrames;
using test::frames_of;
using test::TemporaryFile;
using testing::HasSubstr;

template <class Number>
void put_number(std::string& bytes, std::size_t at, Number number) {
  if (bytes.size() < at + sizeof number) bytes.resize(at + sizeof number);
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

struct Object {
  std::uint32_t type{1};
  std::string body;
  std::uint64_t stamp{0};
  std::uint32_t flags{2};  // 1: of ten microseconds, 2: of nanoseconds
  std::uint16_t version{1};
};
std::string bytes_of(const Object& object) {
  const std::size_t header = object.version == 1 ? 32 : 40;
  std::string out = "LOBJ";
  put_number(out, 4, static_cast<std::uint16_t>(header));
  put_number(out, 6, object.version);
  put_number(out, 8, static_cast<std::uint32_t>(header + object.body.size()));
  put_number(out, 12, object.type);
  put_number(out, 16, object.flags);
  put_number(out, 24, object.stamp);
  out.resize(header);
  return out + object.body;
}

/// CAN_MESSAGE: channel, flags, length, identifier, eight bytes.
std::string can_message(std::uint32_t id, std::uint8_t length = 8, std::uint8_t flags = 0,
                        std::uint16_t channel = 1) {
  std::string body;
  put_number(body, 0, channel);
  put_number(body, 2, flags);
  put_number(body, 3, length);
  put_number(body, 4, id);
  for (std::size_t i = 0; i < 8; ++i)
    put_number(body, 8 + i, static_cast<std::uint8_t>(0x11 * (i + 1)));
  return body;
}
std::string with_data(std::string body, std::size_t from, std::uint8_t bytes) {
  body.resize(from);
  for (std::size_t i = 0; i < bytes; ++i) body += static_cast<char>(i + 1);
  return body;
}
/// CAN_FD_MESSAGE: channel, flags, dlc, identifier, length of the frame, arbitration bits, FD
/// flags, valid bytes, then 64 of them.
std::string fd_message(std::uint32_t id, std::uint8_t bytes, std::uint8_t fd_flags,
                       std::uint8_t flags = 0) {
  std::string body;
  put_number(body, 0, std::uint16_t{3});
  put_number(body, 2, flags);
  put_number(body, 4, id);
  put_number(body, 13, fd_flags);
  put_number(body, 14, bytes);
  return with_data(body, 20, bytes);
}
/// CAN_FD_MESSAGE_64: channel, dlc, valid bytes, transmissions, identifier, length, flags.
std::string fd_message_64(std::uint32_t id, std::uint8_t bytes, std::uint32_t flags) {
  std::string body;
  put_number(body, 0, std::uint8_t{200});
  put_number(body, 2, bytes);
  put_number(body, 4, id);
  put_number(body, 12, flags);
  return with_data(body, 40, bytes);
}

struct ReadObject {
  BlfKind kind{};
  CanFrame frame;
  std::uint32_t channel{77};
};
ReadObject read_object(const std::string& bytes) {
  ReadObject out;
  out.frame.id = 5;  // what another frame left behind
  out.frame.fd = out.frame.remote = out.frame.error = out.frame.extended = true;
  out.frame.data.fill(0xEE);
  out.kind = read_blf_object(bytes, out.frame, out.channel);
  return out;
}

TEST(BlfObject, ReadsClassicMessages) {
  for (const std::uint32_t type : {1U, 86U}) {
    for (const std::uint16_t version : {std::uint16_t{1}, std::uint16_t{2}}) {
      const ReadObject out =
          read_object(bytes_of({type, can_message(0x123, 3), 1'500'000'007, 2, version}));
      ASSERT_EQ(out.kind, BlfKind::kFrame);
      EXPECT_EQ(out.channel, 1U);
      EXPECT_EQ(out.frame.time_ns, 1'500'000'007);
      EXPECT_EQ(out.frame.id, 0x123U);
      EXPECT_EQ(out.frame.length, 3);
      EXPECT_EQ(out.frame.data[2], 0x33);
      EXPECT_EQ(out.frame.data[3], 0) << "nothing of the frame before";
      EXPECT_FALSE(out.frame.extended || out.frame.fd || out.frame.remote || out.frame.error);
    }
  }
  const ReadObject wide = read_object(bytes_of({1, can_message(0x80000000U | 0x18EBFF00U)}));
  EXPECT_TRUE(wide.frame.extended);
  EXPECT_EQ(wide.frame.id, 0x18EBFF00U);
  const ReadObject remote = read_object(bytes_of({1, can_message(0x7FF, 4, 0x80)}));
  EXPECT_TRUE(remote.frame.remote);
  EXPECT_EQ(remote.frame.length, 4);
  EXPECT_EQ(remote.frame.data[0], 0);
  EXPECT_EQ(read_object(bytes_of({1, can_message(1, 15)})).frame.length, 8)
      << "eight bytes at most";
}

TEST(BlfObject, ReadsCanFd) {
  const ReadObject out = read_object(bytes_of({100, fd_message(0x321, 12, 0x1 | 0x2)}));
  ASSERT_EQ(out.kind, BlfKind::kFrame);
  EXPECT_EQ(out.channel, 3U);
  EXPECT_EQ(out.frame.id, 0x321U);
  EXPECT_TRUE(out.frame.fd);
  EXPECT_EQ(out.frame.fd_flags, 1);
  EXPECT_EQ(out.frame.length, 12);
  EXPECT_EQ(out.frame.data[11], 12);
  EXPECT_EQ(read_object(bytes_of({100, fd_message(1, 8, 0x1 | 0x4)})).frame.fd_flags, 2);
  EXPECT_EQ(read_object(bytes_of({100, fd_message(1, 8, 0x6)})).frame.fd_flags, 0) << "no FD frame";
  EXPECT_FALSE(read_object(bytes_of({100, fd_message(1, 8, 0x6)})).frame.fd);
  EXPECT_TRUE(read_object(bytes_of({100, fd_message(1, 0, 0, 0x80)})).frame.remote);
  const ReadObject full =
      read_object(bytes_of({101, fd_message_64(0x80000001U, 64, 0x1000 | 0x2000)}));
  ASSERT_EQ(full.kind, BlfKind::kFrame);
  EXPECT_EQ(full.channel, 200U);
  EXPECT_TRUE(full.frame.extended && full.frame.fd);
  EXPECT_EQ(full.frame.id, 1U);
  EXPECT_EQ(full.frame.length, 64);
  EXPECT_EQ(full.frame.data[63], 64);
  EXPECT_EQ(full.frame.fd_flags, 1);
  EXPECT_EQ(read_object(bytes_of({101, fd_message_64(1, 1, 0x1000 | 0x4000)})).frame.fd_flags, 2);
  EXPECT_TRUE(read_object(bytes_of({101, fd_message_64(1, 0, 0x10)})).frame.remote);
  EXPECT_FALSE(read_object(bytes_of({101, fd_message_64(1, 0, 0)})).frame.remote);
  EXPECT_FALSE(read_object(bytes_of({101, fd_message_64(1, 0, 0x2000)})).frame.fd);
}

TEST(BlfObject, IsBadWhereItIsTooShortForItsType) {
  const std::string error(2, '\x02');
  for (const auto& [type, body] :
       {std::pair{1U, can_message(1)}, std::pair{100U, fd_message(1, 12, 1)},
        std::pair{101U, fd_message_64(1, 12, 0x1000)}, std::pair{73U, error}}) {
    EXPECT_EQ(read_object(bytes_of({type, body})).kind, BlfKind::kFrame) << type;
    for (std::size_t length = 0; length < body.size(); ++length)
      EXPECT_EQ(read_object(bytes_of({type, body.substr(0, length)})).kind, BlfKind::kBad)
          << type << " of " << length;
    EXPECT_EQ(read_object(bytes_of({type, ""}).substr(0, 31)).kind, BlfKind::kBad) << "its header";
    EXPECT_EQ(read_object(bytes_of({type, body, 0, 2, 3})).kind, BlfKind::kOther)
        << "another version";
    EXPECT_EQ(read_object(bytes_of({type, body, 0, 2, 0})).kind, BlfKind::kOther);
  }
  EXPECT_EQ(read_object(bytes_of({100, fd_message(1, 65, 1)})).kind, BlfKind::kBad)
      << "64 bytes at most";
  EXPECT_TRUE(read_object(bytes_of({73, error})).frame.error);
  EXPECT_EQ(read_object(bytes_of({73, error})).channel, 0x0202U);
  for (const std::uint32_t type : {0U, 2U, 10U, 72U, 85U, 99U, 102U})
    EXPECT_EQ(read_object(bytes_of({type, can_message(1)})).kind, BlfKind::kOther) << type;
}

TEST(BlfObject, CountsTimeInTensOfMicrosecondsOrNanoseconds) {
  const auto at = [](std::uint64_t stamp, std::uint32_t flags) {
    return read_object(bytes_of({1, can_message(1), stamp, flags}));
  };
  EXPECT_EQ(at(123, 1).frame.time_ns, 1'230'000);
  EXPECT_EQ(at(123, 2).frame.time_ns, 123);
  constexpr auto kMost = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / 2;
  EXPECT_EQ(at(kMost, 2).kind, BlfKind::kFrame);
  EXPECT_EQ(at(kMost + 1, 2).kind, BlfKind::kBad);
  EXPECT_EQ(at(kMost / 10000, 1).kind, BlfKind::kFrame);
  EXPECT_EQ(at(kMost / 10000 + 1, 1).kind, BlfKind::kBad);
}

TEST(BlfBase, IsSixteenBytesFromLobjOn) {
  std::string bytes = bytes_of({10, "x"});
  ASSERT_TRUE(read_blf_base(bytes));
  EXPECT_EQ(read_blf_base(bytes)->size, 33U);
  EXPECT_EQ(read_blf_base(bytes)->type, 10U);
  put_number(bytes, 8, std::uint32_t{16});
  EXPECT_TRUE(read_blf_base(bytes));
  put_number(bytes, 8, std::uint32_t{15});
  EXPECT_FALSE(read_blf_base(bytes));
  bytes[3] = 'K';
  EXPECT_FALSE(read_blf_base(bytes));
}

/// SYSTEMTIME: year, month, day of the week, day, hour, minute, second, millisecond.
using Fields = std::array<std::uint16_t, 8>;
std::int64_t system_time(const Fields& fields) {
  std::string bytes;
  for (std::size_t i = 0; i < 8; ++i) put_number(bytes, 2 * i, fields[i]);
  return read_system_time(bytes);
}

TEST(BlfSystemTime, IsADateAndATimeOfDay) {
  EXPECT_EQ(system_time({2020, 9, 0, 13, 12, 26, 40, 123}), 1'600'000'000'123'000'000);
  EXPECT_EQ(system_time({1980, 1, 2, 1, 0, 0, 0, 0}), 315'532'800'000'000'000);
  EXPECT_EQ(system_time({2016, 12, 6, 31, 23, 59, 60, 999}), 1'483'228'800'999'000'000);
  EXPECT_NE(system_time({2200, 12, 0, 31, 0, 0, 0, 0}), 0);
  for (const Fields& none :
       {Fields{1979, 12, 0, 31, 0, 0, 0, 0}, Fields{2201, 1, 0, 1, 0, 0, 0, 0},
        Fields{2020, 0, 0, 1, 0, 0, 0, 0}, Fields{2020, 13, 0, 1, 0, 0, 0, 0},
        Fields{2023, 2, 0, 29, 0, 0, 0, 0}, Fields{2020, 9, 0, 0, 0, 0, 0, 0},
        Fields{2020, 9, 0, 13, 24, 0, 0, 0}, Fields{2020, 9, 0, 13, 0, 60, 0, 0},
        Fields{2020, 9, 0, 13, 0, 0, 61, 0}, Fields{2020, 9, 0, 13, 0, 0, 0, 1000}})
    EXPECT_EQ(system_time(none), 0);
}

std::string blf_header(std::uint32_t size = 144) {
  std::string out = "LOGG";
  put_number(out, 4, size);
  const Fields start{2020, 9, 0, 13, 12, 26, 40, 0};
  for (std::size_t i = 0; i < 8; ++i) put_number(out, 40 + 2 * i, start[i]);
  out.resize(size);
  return out;
}
std::string plain_container(const std::string& content) {
  std::string out = "LOBJ";
  put_number(out, 4, std::uint16_t{16});
  put_number(out, 6, std::uint16_t{1});
  put_number(out, 8, static_cast<std::uint32_t>(32 + content.size()));
  put_number(out, 12, std::uint32_t{10});
  put_number(out, 24, static_cast<std::uint32_t>(content.size()));
  out.resize(32);
  out += content;
  return out + std::string(content.size() % 4, '\0');  // as Vector's tools pad it
}

FileFrames blf_file(const std::string& bytes, const std::vector<std::string>& interfaces = {},
                    bool skip = false) {
  const TemporaryFile file{bytes};
  return frames_of(
      BlfSource::open({.path = file.path(), .skip_bad_lines = skip, .interfaces = interfaces}));
}
std::string frame_at(std::uint64_t time_ns, std::uint16_t channel = 1) {
  return bytes_of({1, can_message(0x100, 8, 0, channel), time_ns});
}

TEST(BlfFile, JoinsObjectsAcrossContainersWithTheStartOfTheMeasurement) {
  std::string content;
  for (std::uint64_t i = 0; i < 50; ++i) content += frame_at(1000 * i);
  for (const std::size_t cut :
       {std::size_t{1}, std::size_t{15}, std::size_t{16}, std::size_t{33}, std::size_t{1000}}) {
    const std::string file = blf_header() + plain_container(content.substr(0, cut)) +
                             plain_container(content.substr(cut));
    const FileFrames out = blf_file(file);
    ASSERT_EQ(out.frames.size(), 50U) << cut << out.error;
    EXPECT_EQ(out.reason, Errc::kEndOfStream);
    EXPECT_EQ(out.frames[49].time_ns, 1'600'000'000'000'049'000);
    EXPECT_FALSE(out.health.truncated);
    EXPECT_EQ(out.health.malformed, 0U);
  }
  const FileFrames bare = blf_file(blf_header(72) + frame_at(5) + frame_at(6));
  EXPECT_EQ(bare.frames.size(), 2U) << "without containers" << bare.error;
  EXPECT_EQ(blf_file(blf_header(72)).reason, Errc::kEndOfStream);
  EXPECT_THAT(blf_file(blf_header(72).substr(0, 71)).error, HasSubstr("ends within its header"));
}

TEST(BlfFile, PassesOverOtherObjectsOfAnySizeAndEightBytesOfPadding) {
  const std::string large = bytes_of({65, std::string(300'000, 'x')});
  const FileFrames out =
      blf_file(blf_header() + plain_container(frame_at(1) + large + frame_at(2)));
  EXPECT_EQ(out.frames.size(), 2U) << out.error;
  EXPECT_EQ(out.health.ignored, 1U);
  EXPECT_FALSE(out.health.truncated);
  for (const auto& [padding, good] : {std::pair{8U, true}, std::pair{9U, false}}) {
    const std::string zeros(padding, '\0');
    const FileFrames between =
        blf_file(blf_header() + plain_container(frame_at(1) + zeros + frame_at(2)));
    EXPECT_EQ(between.frames.size(), good ? 2U : 1U) << padding;
    EXPECT_EQ(between.reason, good ? Errc::kEndOfStream : Errc::kMalformed);
    const FileFrames outside = blf_file(blf_header() + zeros + plain_container(frame_at(1)));
    EXPECT_EQ(outside.frames.size(), good ? 1U : 0U) << padding;
  }
}

// 193 bytes, of which 192 are looked at.
TEST(BlfFile, IsWholeWhereItsLastObjectIs) {
  const std::string last = bytes_of({65, std::string(161, 'x')});
  EXPECT_FALSE(blf_file(blf_header() + plain_container(frame_at(1) + last)).health.truncated);
  const FileFrames cut =
      blf_file(blf_header() + plain_container((frame_at(1) + last).substr(0, 48 + 192)));
  EXPECT_EQ(cut.frames.size(), 1U);
  EXPECT_EQ(cut.reason, Errc::kEndOfStream);
  EXPECT_TRUE(cut.health.truncated) << "its container is whole, it is not";
}

TEST(BlfFile, ReadsObjectsWithoutAContainerBehindThoseInOne) {
  const std::string zlib =
      test::content_of(std::string{DAMPLINE_SOURCE_DIR} + "/tests/fuzz/corpus/blf/zlib").substr(1);
  ASSERT_EQ(blf_file(zlib).frames.size(), 5U);
  const FileFrames out = blf_file(zlib + frame_at(100'000'000'000));
  EXPECT_EQ(out.frames.size(), 6U) << out.error;
  EXPECT_EQ(out.reason, Errc::kEndOfStream);
}

// What is no object counts once, however often it looks like one.
TEST(BlfFile, CountsEachPlaceWithoutAnObject) {
  std::string broken;
  for (int i = 0; i < 10; ++i) broken += "LOBJ" + std::string(20, '\0') + "xx";
  std::string content;
  for (std::uint64_t i = 0; i < 3; ++i) content += frame_at(i) + (i < 2 ? broken : "");
  const FileFrames out = blf_file(blf_header() + plain_container(content), {}, true);
  EXPECT_EQ(out.frames.size(), 3U);
  EXPECT_EQ(out.health.malformed, 2U);
}

TEST(BlfFile, DeliversTheChannelsThatWereAskedFor) {
  const std::string file =
      blf_header() + plain_container(frame_at(1, 1) + frame_at(2, 2) + frame_at(3, 300));
  const FileFrames out = blf_file(file, {"can2", "can300"});
  ASSERT_EQ(out.frames.size(), 2U);
  EXPECT_EQ(out.frames[0].time_ns % 1000, 2);
  EXPECT_EQ(out.health.ignored, 1U);
  EXPECT_EQ(out.health.frames, 2U);
}

TEST(BlfFile, NamesTheContainerWhereTimeGoesBack) {
  constexpr std::uint64_t kSecond = 1'000'000'000;
  const std::string head = blf_header() + plain_container(frame_at(5 * kSecond));
  const std::string file = head + plain_container(frame_at(4 * kSecond + 1) +
                                                  frame_at(4 * kSecond) + frame_at(6 * kSecond));
  const FileFrames out = blf_file(file);
  EXPECT_EQ(out.frames.size(), 2U) << "by less than a second it is held";
  EXPECT_EQ(out.reason, Errc::kMalformed);
  EXPECT_THAT(out.error, HasSubstr(fmt::format("in the container at byte {}: found a time that "
                                               "goes back by a second or more",
                                               head.size())));
  const FileFrames skipped = blf_file(file, {}, true);
  EXPECT_EQ(skipped.frames.size(), 3U);
  EXPECT_EQ(skipped.health.malformed, 1U);
  EXPECT_EQ(skipped.health.reordered, 1U);
}

TEST(BlfFile, OfAnUnknownCompressionIsDamaged) {
  std::string container = plain_container(frame_at(1));
  put_number(container, 16, std::uint16_t{3});
  const std::string file = blf_header() + container + plain_container(frame_at(2));
  EXPECT_THAT(blf_file(file).error, HasSubstr("the container at byte 144 is damaged"));
  const FileFrames skipped = blf_file(file, {}, true);
  EXPECT_EQ(skipped.frames.size(), 1U);
  EXPECT_EQ(skipped.health.malformed, 1U);
}

/// With zlib's data, and some bytes behind them.
std::string zlib_container(const std::string& content, const std::string& behind = "") {
  uLongf size = ::compressBound(content.size());
  std::string packed(size, '\0');
  EXPECT_EQ(::compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                       reinterpret_cast<const Bytef*>(content.data()), content.size()),
            Z_OK);
  packed.resize(size);
  std::string container = plain_container(packed + behind);
  put_number(container, 16, std::uint16_t{2});
  put_number(container, 24, static_cast<std::uint32_t>(content.size()));
  return container;
}

TEST(BlfFile, InflatesEachContainerByItself) {
  std::string content;
  for (std::uint64_t i = 0; i < 50; ++i) content += frame_at(1000 * i);
  for (const std::string& behind : {std::string{}, std::string{"x"}, std::string(1000, 'x')}) {
    const FileFrames out =
        blf_file(blf_header() + zlib_container(content.substr(0, 1234), behind) +
                 plain_container(content.substr(1234, 100)) + zlib_container(content.substr(1334)));
    ASSERT_EQ(out.frames.size(), 50U) << out.error;
    for (std::size_t i = 0; i < 50; ++i)
      ASSERT_EQ(out.frames[i].time_ns % 1'000'000, static_cast<std::int64_t>(1000 * i));
    EXPECT_EQ(out.health.malformed, 0U);
    EXPECT_FALSE(out.health.truncated);
  }
}

// The object that reaches into it is lost with it.
TEST(BlfFile, GoesOnBehindADamagedContainer) {
  std::string damaged = plain_container(std::string(100, 'x'));
  put_number(damaged, 16, std::uint16_t{3});
  const std::string large = bytes_of({65, std::string(300'000, 'x')});
  for (const std::string& half : {frame_at(2).substr(0, 20), frame_at(2).substr(0, 47),
                                  large.substr(0, 1000), large.substr(0, 200'000)}) {
    const FileFrames out = blf_file(
        blf_header() + plain_container(frame_at(1) + half) + damaged + plain_container(frame_at(3)),
        {}, true);
    ASSERT_EQ(out.frames.size(), 2U) << half.size() << out.error;
    EXPECT_EQ(out.frames[1].time_ns % 1000, 3);
    EXPECT_EQ(out.frames[1].data[7], 0x88);
    EXPECT_EQ(out.health.malformed, 1U);
    EXPECT_EQ(out.reason, Errc::kEndOfStream);
  }
}

}  // namespace
}  // namespace dampline::drivers
