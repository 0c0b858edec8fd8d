// SPDX-License-Identifier: MIT
// Files that tests/mdf4.py wrote, which are also the fuzzers' corpus (behind one byte of theirs).
// Debian has no other program that writes MDF4.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

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

}  // namespace
}  // namespace dampline::drivers
