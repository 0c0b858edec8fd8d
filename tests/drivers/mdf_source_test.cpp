// SPDX-License-Identifier: MIT
// Files that tests/mdf4.py wrote, which are also the fuzzers' corpus (behind one byte of theirs).
// Debian has no other program that writes MDF4.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "drivers/mdf/layout.hpp"
#include "drivers/record/frames.hpp"
#include "drivers/record/rows.hpp"
#include "tests/drivers/file_frames.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::content_of;
using test::FileFrames;
using test::frames_of;
using test::TemporaryFile;
using testing::HasSubstr;

constexpr std::array kFrameFiles{"fixed", "sorted",   "records",   "unfinished",
                                 "list",  "deflated", "transposed"};
constexpr std::int64_t kStartNs = 1'600'000'000'000'000'000;

std::string mdf_written(const std::string& name) {
  return content_of(std::string{DAMPLINE_SOURCE_DIR} + "/tests/fuzz/corpus/mdf/" + name).substr(1);
}

/// Puts a number of 8 bytes at an offset behind the first block of a name.
std::string with_number(std::string bytes, const std::string& block, std::size_t offset,
                        std::uint64_t number) {
  std::memcpy(&bytes[bytes.find("##" + block) + offset], &number, sizeof number);
  return bytes;
}

TEST(MdfSource, ReadsEveryKindOfFrame) {
  for (const char* name : kFrameFiles) {
    const FileFrames out = frames_of(mdf_written(name));
    ASSERT_EQ(out.frames.size(), 5U) << name << out.error;
    EXPECT_EQ(out.reason, Errc::kEndOfStream);
    EXPECT_FALSE(out.health.truncated) << name;
    EXPECT_EQ(out.frames[0].time_ns, kStartNs);
    EXPECT_EQ(out.frames[0].id, 0x123U);
    EXPECT_EQ(out.frames[0].length, 3);
    EXPECT_EQ(out.frames[0].data[2], 3);
    EXPECT_TRUE(out.frames[1].extended);
    EXPECT_EQ(out.frames[1].id, 0x18EBFF00U);
    EXPECT_EQ(out.frames[1].interface_index, 1);
    EXPECT_TRUE(out.frames[2].remote);
    EXPECT_TRUE(out.frames[3].fd);
    EXPECT_EQ(out.frames[3].fd_flags, 1);
    EXPECT_EQ(out.frames[3].data[11], 11);
    EXPECT_TRUE(out.frames[4].error);
    EXPECT_EQ(out.frames[4].time_ns, kStartNs + 1'000'001'230) << name;
  }
}

TEST(MdfSource, CutOffAnywhereItGivesWhatIsThereOrSaysThatItIsDamaged) {
  for (const char* name : kFrameFiles) {
    const std::string whole = mdf_written(name);
    for (std::size_t size = 64; size < whole.size(); size += 7) {
      const FileFrames out = frames_of(whole.substr(0, size));
      const bool open_ended = std::string_view{name} == "unfinished";
      EXPECT_TRUE(out.reason == Errc::kMalformed || out.health.truncated || open_ended ||
                  out.frames.size() == 5)
          << name << size << out.error;
    }
  }
}

TEST(MdfSource, RefusesLinksThatLeadInACircle) {
  const std::string bytes = mdf_written("fixed");
  const std::uint64_t group = bytes.find("##CG");
  EXPECT_THAT(frames_of(with_number(bytes, "CG", 24, group)).error,
              HasSubstr("in a circle to this ##CG"));
  const std::string list = mdf_written("list");
  EXPECT_THAT(frames_of(with_number(list, "DL", 24, list.find("##DL"))).error,
              HasSubstr("in a circle"));
}

TEST(MdfSource, RefusesLinksAndLengthsOutsideTheFile) {
  const std::string bytes = mdf_written("fixed");
  for (const std::uint64_t wrong : {std::uint64_t{1}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    EXPECT_THAT(frames_of(with_number(bytes, "DG", 32, wrong)).error, HasSubstr("##CG"));
    EXPECT_THAT(frames_of(with_number(bytes, "DG", 40, wrong)).error,
                HasSubstr("expected a block of data"));
    EXPECT_THAT(frames_of(with_number(bytes, "CG", 16, wrong)).error, testing::Not(""));
  }
  const FileFrames longer = frames_of(with_number(bytes, "DT", 8, std::uint64_t{1} << 40));
  EXPECT_TRUE(longer.reason == Errc::kMalformed || longer.health.truncated);
}

TEST(MdfSource, NamesWhatItDoesNotRead) {
  std::string bytes = mdf_written("unfinished");
  bytes[60] = 0x10;
  EXPECT_THAT(frames_of(bytes).error, HasSubstr("was not finalised"));
  bytes = mdf_written("fixed");
  for (std::size_t at = bytes.find("##CN"); at != std::string::npos;
       at = bytes.find("##CN", at + 1))
    bytes[at + 24 + 64 + 2] = 1;  // unsigned, big-endian
  EXPECT_THAT(frames_of(bytes).error, HasSubstr("little-endian"));
}

TEST(MdfSource, DeflatedDataThatAreDamagedAreAnErrorWithTheirByte) {
  for (const char* name : {"deflated", "transposed"}) {
    std::string bytes = mdf_written(name);
    const std::size_t block = bytes.find("##DZ");
    for (std::size_t i = 0; i < 6; ++i) bytes[block + 48 + i] = '\xFF';
    EXPECT_THAT(frames_of(bytes).error, HasSubstr(std::to_string(block))) << name;
  }
}

TEST(MdfSource, HoldsFewerRecordsThanItSays) {
  const FileFrames out = frames_of(with_number(mdf_written("fixed"), "CG", 24 + 48 + 8, 99));
  EXPECT_EQ(out.frames.size(), 5U);
  EXPECT_TRUE(out.health.truncated);
}

// Frames, and not records, are what a source counts.
TEST(MdfSource, CountsItsFramesAndNamesItsClock) {
  const std::string bytes = mdf_written("fixed");
  EXPECT_EQ(frames_of(bytes).health.frames, 5U);
  const auto clock_of = [](const std::string& written) {
    const TemporaryFile file{written};
    return open_frames({.path = file.path()}).value()->clock();
  };
  constexpr std::size_t kStart = 24 + 6 * 8;  // in the header block
  EXPECT_EQ(clock_of(bytes), RecordClock::kUtc);
  std::string local = bytes;
  local[bytes.find("##HD") + kStart + 12] = 1;
  EXPECT_EQ(clock_of(local), RecordClock::kLocal);
  const std::string without = with_number(bytes, "HD", kStart, 0);
  EXPECT_EQ(clock_of(without), RecordClock::kRelative);
  EXPECT_EQ(frames_of(without).frames.at(4).time_ns, 1'000'001'230);
}

TEST(MdfSource, GivesOnlyTheInterfacesThatWereAskedFor) {
  const TemporaryFile file{mdf_written("fixed")};
  const FileFrames all = frames_of(open_frames({.path = file.path()}));
  ASSERT_EQ(all.interfaces.size(), 2U);
  for (const std::size_t i : {0U, 1U}) {
    const FileFrames some =
        frames_of(open_frames({.path = file.path(), .interfaces = {all.interfaces[i]}}));
    const auto count = std::count_if(all.frames.begin(), all.frames.end(),
                                     [&](const CanFrame& f) { return f.interface_index == i; });
    EXPECT_EQ(some.frames.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(some.health.ignored, 5U - some.frames.size());
  }
}

TEST(MdfSource, RefusesRecordIdentifiersOfOtherLengths) {
  constexpr std::size_t kIdBytes = 24 + 4 * 8;
  std::string bytes = mdf_written("fixed");
  for (const int id_bytes : {3, 5, 6, 7, 9, 16, 128}) {
    bytes[bytes.find("##DG") + kIdBytes] = static_cast<char>(id_bytes);
    EXPECT_THAT(frames_of(bytes).error,
                HasSubstr("identifiers of " + std::to_string(id_bytes) + " bytes"));
  }
  for (const int id_bytes : {1, 2, 4, 8}) {
    bytes[bytes.find("##DG") + kIdBytes] = static_cast<char>(id_bytes);
    EXPECT_THAT(frames_of(bytes).error, testing::Not(HasSubstr("identifiers of"))) << id_bytes;
  }
  bytes[bytes.find("##DG") + kIdBytes] = 0;
  EXPECT_THAT(frames_of(bytes).error, HasSubstr("without identifiers, expected one"));
}

/// A file whose data are stored in another way, behind all else.
class StoredAnew {
 public:
  explicit StoredAnew(const std::string& name) : bytes_{mdf_written(name)} {
    const std::size_t at = bytes_.find("##DT");
    std::uint64_t length = 0;
    std::memcpy(&length, &bytes_[at + 8], sizeof length);
    data_ = bytes_.substr(at + 24, length - 24);
  }
  [[nodiscard]] const std::string& data() const { return data_; }
  /// Appends a block; its address.
  std::uint64_t block(const std::string& name, const std::vector<std::uint64_t>& links,
                      const std::string& data) {
    bytes_.resize((bytes_.size() + 7) / 8 * 8);
    const std::uint64_t at = bytes_.size();
    bytes_ += "##" + name + std::string(4, '\0') + little(24 + 8 * links.size() + data.size()) +
              little(links.size());
    for (const std::uint64_t link : links) bytes_ += little(link);
    bytes_ += data;
    return at;
  }
  std::uint64_t list(const std::vector<std::uint64_t>& blocks, std::uint64_t next) {
    std::vector<std::uint64_t> links{next};
    links.insert(links.end(), blocks.begin(), blocks.end());
    return block("DL", links, std::string(4, '\0') + little(blocks.size()).substr(0, 4));
  }
  /// Deflated; with columns transposed before.
  std::uint64_t deflated(const std::string& data, std::size_t columns = 0) {
    std::string plain = data;
    const std::size_t rows = columns == 0 ? 0 : data.size() / columns;
    for (std::size_t i = 0; i < rows * columns; ++i)
      plain[i % columns * rows + i / columns] = data[i];
    uLongf size = ::compressBound(plain.size());
    std::string packed(size, '\0');
    ::compress(reinterpret_cast<Bytef*>(packed.data()), &size,
               reinterpret_cast<const Bytef*>(plain.data()), plain.size());
    packed.resize(size);
    const std::string head = std::string{"DT"} + static_cast<char>(columns > 0) + '\0' +
                             little(columns).substr(0, 4) + little(plain.size()) + little(size);
    return block("DZ", {}, head + packed);
  }
  [[nodiscard]] std::string with(std::uint64_t data) const {
    return with_number(bytes_, "DG", 24 + 2 * 8, data);
  }

 private:
  static std::string little(std::uint64_t number) {
    std::string out(8, '\0');
    std::memcpy(out.data(), &number, sizeof number);
    return out;
  }
  std::string bytes_;
  std::string data_;
};

void expect_the_frames(const std::string& bytes, const std::string& how) {
  const FileFrames expected = frames_of(mdf_written("fixed"));
  const FileFrames out = frames_of(bytes);
  ASSERT_EQ(out.frames.size(), expected.frames.size()) << how << ": " << out.error;
  for (std::size_t i = 0; i < out.frames.size(); ++i) {
    EXPECT_EQ(out.frames[i].data, expected.frames[i].data) << how << i;
    EXPECT_EQ(out.frames[i].time_ns, expected.frames[i].time_ns) << how << i;
  }
  EXPECT_FALSE(out.health.truncated) << how;
}

TEST(MdfSource, GivesTheSameFramesHoweverTheirRecordsAreStored) {
  const std::string data = StoredAnew{"fixed"}.data();
  for (const std::size_t columns : {std::size_t{0}, std::size_t{1}, std::size_t{2}, std::size_t{7},
                                    data.size() - 1, data.size(), data.size() + 1}) {
    StoredAnew file{"fixed"};
    expect_the_frames(file.with(file.deflated(data, columns)),
                      "columns " + std::to_string(columns));
  }
  for (const std::size_t first : {std::size_t{0}, std::size_t{1}, std::size_t{30}, data.size()}) {
    StoredAnew file{"fixed"};
    const std::uint64_t one = file.block("DT", {}, data.substr(0, first));
    const std::uint64_t two = file.deflated(data.substr(first), 3);
    expect_the_frames(file.with(file.list({one, 0, two}, 0)), "a list with a free place");
    const std::uint64_t second = file.list({two}, 0);
    const std::uint64_t lists = file.list({one}, second);
    expect_the_frames(file.with(lists), "two lists");
    expect_the_frames(file.with(file.block("HL", {lists}, std::string(8, '\0'))), "a header list");
  }
}

TEST(MdfSource, RefusesListsThatSayMoreThanTheyHave) {
  StoredAnew file{"fixed"};
  const std::uint64_t data = file.block("DT", {}, file.data());
  const std::string three{"\0\0\0\0\3\0\0\0", 8};
  EXPECT_THAT(frames_of(file.with(file.block("DL", {0, data, data}, three))).error,
              HasSubstr("fewer than it says"));
  EXPECT_THAT(frames_of(file.with(file.block("DL", {0, data}, "\0"))).error,
              HasSubstr("expected a list of data blocks"));
  EXPECT_THAT(frames_of(file.with(file.block("HL", {0}, three))).error,
              HasSubstr("expected a list of data blocks"));
}

// "list" has its bytes of data in blocks of signal data.
TEST(MdfSource, DamagedSignalDataAreAnError) {
  std::string bytes = mdf_written("list");
  for (std::size_t at = bytes.find("##SD"); at != std::string::npos;
       at = bytes.find("##SD", at + 1))
    bytes[at + 2] = 'X';
  const FileFrames out = frames_of(bytes);
  EXPECT_EQ(out.reason, Errc::kMalformed);
  EXPECT_THAT(out.error, HasSubstr("expected data (DT, DV, SD, DZ)"));
  EXPECT_THAT(frames_of(mdf_written("fixed").substr(0, 80)).error, HasSubstr("block ##HD"));
}

MdfChannel channel_at(std::uint8_t bit, std::uint32_t bits, std::uint8_t type) {
  MdfChannel out;
  out.byte_offset = 1;
  out.bit_offset = bit;
  out.bit_count = bits;
  out.data_type = type;
  return out;
}

// ASAM MDF 4.1, channels: the value begins at a bit of a byte, its lowest bit first.
TEST(MdfChannel, TakesItsBitsOutOfARecord) {
  const std::array<char, 10> record{'\x5A', '\xC3', '\x96', '\x0F', '\xE1',
                                    '\x78', '\x2D', '\xB4', '\x99', '\x66'};
  const auto bit_of = [&](std::size_t i) {
    return static_cast<unsigned char>(record[1 + i / 8]) >> i % 8 & 1U;
  };
  for (unsigned bit = 0; bit < 8; ++bit) {
    for (unsigned bits = 1; bits + bit <= 64; ++bits) {
      std::uint64_t expected = 0;
      for (unsigned i = 0; i < bits; ++i) expected |= std::uint64_t{bit_of(bit + i)} << i;
      MdfChannel channel = channel_at(static_cast<std::uint8_t>(bit), bits, MdfChannel::kUnsigned);
      ASSERT_TRUE(channel.is_number(10));
      ASSERT_EQ(channel.bits(record), expected) << bit << " " << bits;
      ASSERT_EQ(channel.number(record), static_cast<double>(expected)) << bit << " " << bits;
      channel.data_type = MdfChannel::kSigned;
      const bool negative = bit_of(bit + bits - 1) != 0;
      const auto number = static_cast<std::int64_t>(
          negative && bits < 64 ? expected | ~std::uint64_t{0} << bits : expected);
      channel.offset = 10.0;
      channel.factor = 0.5;
      ASSERT_EQ(channel.number(record), 10.0 + 0.5 * static_cast<double>(number))
          << bit << " " << bits;
    }
  }
}

TEST(MdfChannel, TakesRealNumbers) {
  std::array<char, 9> record{};
  MdfChannel channel = channel_at(0, 64, MdfChannel::kReal);
  channel.offset = 1.0;
  channel.factor = 2.0;
  const double number = -3.25;
  std::memcpy(record.data() + 1, &number, sizeof number);
  EXPECT_EQ(channel.number(record), -5.5);
  channel.bit_count = 32;
  const float shorter = 0.75F;
  std::memcpy(record.data() + 1, &shorter, sizeof shorter);
  EXPECT_EQ(channel.number(record), 2.5);
}

TEST(MdfChannel, IsANumberWithinItsRecordOnly) {
  constexpr auto kUnsigned = MdfChannel::kUnsigned;
  constexpr auto kReal = MdfChannel::kReal;
  EXPECT_TRUE(channel_at(0, 64, kUnsigned).is_number(9));
  EXPECT_FALSE(channel_at(0, 64, kUnsigned).is_number(8));
  EXPECT_TRUE(channel_at(7, 1, kUnsigned).is_number(2));
  EXPECT_FALSE(channel_at(7, 2, kUnsigned).is_number(2));
  EXPECT_FALSE(channel_at(0, 0, kUnsigned).is_number(9));
  EXPECT_FALSE(channel_at(8, 1, kUnsigned).is_number(9));
  EXPECT_FALSE(channel_at(1, 64, kUnsigned).is_number(99)) << "nine bytes";
  EXPECT_TRUE(channel_at(0, 32, kReal).is_number(5));
  EXPECT_TRUE(channel_at(0, 64, kReal).is_number(9));
  EXPECT_FALSE(channel_at(0, 16, kReal).is_number(9));
  EXPECT_FALSE(channel_at(1, 32, kReal).is_number(9));
  EXPECT_FALSE(channel_at(0, 64, 5).is_number(9)) << "big-endian";
  MdfChannel counted = channel_at(0, 8, kUnsigned);
  counted.type = MdfChannel::Type::kVirtualMaster;
  EXPECT_FALSE(counted.is_number(9));
}

TEST(MdfReader, ReadsSignalsAsATable) {
  const TemporaryFile file{mdf_written("signals")};
  EXPECT_EQ(detect_format(file.path()).value(), RecordFormat::kMdf4Rows);
  auto rows = open_rows({.path = file.path(), .required = {"time_s", "force_n", "deflection_m"}});
  ASSERT_TRUE(rows.ok()) << rows.error_text();
  EXPECT_EQ(rows.value()->units(), (std::vector<std::string>{"s", "N", "m"}));
  std::array<double, 18> out{};
  ASSERT_EQ(rows.value()->read(out).value(), 6U);
  EXPECT_DOUBLE_EQ(out[3], 0.1);
  EXPECT_DOUBLE_EQ(out[4], 2.0);
  EXPECT_DOUBLE_EQ(out[5], 1e-3);
  EXPECT_TRUE(std::isnan(out[11])) << "marked as invalid";
  EXPECT_DOUBLE_EQ(out[17], 5e-3);
  EXPECT_EQ(rows.value()->read(out).error(), Errc::kEndOfStream);
}

/// Time, force and deflection of a file, row by row.
std::vector<std::array<double, 3>> signal_rows(const std::string& bytes) {
  const TemporaryFile file{bytes};
  auto rows = open_rows({.path = file.path(), .required = {"time_s", "force_n", "deflection_m"}});
  std::vector<std::array<double, 3>> out;
  EXPECT_TRUE(rows.ok()) << rows.error_text();
  std::array<double, 3> row{};
  while (rows.ok() && rows.value()->read(row).ok()) out.push_back(row);
  return out;
}

TEST(MdfReader, TellsWhenItBegan) {
  const auto start_of = [](const std::string& bytes) {
    const TemporaryFile file{bytes};
    return open_rows({.path = file.path(), .required = {"time_s"}}).value()->start_utc_ns();
  };
  const std::string bytes = mdf_written("signals");
  constexpr std::size_t kStart = 24 + 6 * 8;
  EXPECT_EQ(start_of(with_number(bytes, "HD", kStart, 77)), 77);
  EXPECT_FALSE(start_of(with_number(bytes, "HD", kStart, 0)));
  std::string local = with_number(bytes, "HD", kStart, 77);
  local[bytes.find("##HD") + kStart + 12] = 1;
  EXPECT_FALSE(start_of(local)) << "somebody's clock";
}

// MDF 4.2: data of values only; which of them are invalid stands elsewhere.
TEST(MdfReader, ReadsDataOfValuesOnly) {
  StoredAnew file{"signals"};
  constexpr std::size_t kValues = 2 * 8 + 4;
  std::string values;
  for (std::size_t at = 0; at < file.data().size(); at += kValues + 1)
    values += file.data().substr(at, kValues);
  const auto rows = signal_rows(file.with(file.block("DV", {}, values)));
  const auto before = signal_rows(mdf_written("signals"));
  ASSERT_EQ(rows.size(), before.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i][0], before[i][0]);
    EXPECT_EQ(rows[i][1], before[i][1]);
    EXPECT_EQ(rows[i][2], std::isnan(before[i][2]) ? 0.0 : before[i][2]);
  }
}

TEST(MdfReader, AnInvalidationBitBehindTheRecordIsNone) {
  std::string bytes = mdf_written("signals");
  constexpr std::size_t kFlags = 24 + 8 * 8 + 12;  // in a channel's block
  for (std::size_t at = bytes.find("##CN"); at != std::string::npos;
       at = bytes.find("##CN", at + 1))
    if (bytes[at + kFlags] == 2) bytes[at + kFlags + 4] = 8;
  EXPECT_EQ(signal_rows(bytes).at(3)[2], 0.0);
  EXPECT_TRUE(std::isnan(signal_rows(mdf_written("signals")).at(3)[2]));
}

}  // namespace
}  // namespace dampline::drivers
