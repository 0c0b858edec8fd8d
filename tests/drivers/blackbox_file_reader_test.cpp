// SPDX-License-Identifier: MIT
// One file of a black box, record by record.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cerrno>
#include <optional>

#include "drivers/blackbox/file_reader.hpp"
#include "tests/blackbox.hpp"

namespace dampline::drivers {
namespace {

using Status = BlackboxFileReader::Status;
using Opened = BlackboxFileReader::Opened;
using test::BoxFolder;

/// Where each record of a whole file begins, and behind them its end.
std::vector<std::uint64_t> record_places(const std::string& bytes) {
  std::vector<std::uint64_t> places{kRecordsAt};
  while (places.back() < bytes.size())
    places.push_back(places.back() + kRecordHead + kRecordTail +
                     static_cast<std::uint8_t>(bytes[places.back() + kRecordLengthAt]));
  return places;
}

std::optional<std::uint32_t> next_number(BlackboxFileReader& reader) {
  BlackboxRecord record;
  if (reader.next(record) != Status::kRecord) return std::nullopt;
  return record.number;
}

std::uint32_t count_of(BlackboxFileReader& reader) {
  std::uint32_t count = 0;
  while (next_number(reader)) ++count;
  return count;
}

TEST(BlackboxFileReader, TellsTheByteBehindEveryRecord) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 20000);  // more than it reads at once
  const auto places = record_places(test::bytes_of(folder.file(1)));
  ASSERT_EQ(places.size(), 20001U);
  BlackboxFileReader reader;
  ASSERT_EQ(reader.open(folder.file(1).c_str()), Opened::kOpen);
  EXPECT_EQ(reader.offset(), kRecordsAt);
  for (std::uint32_t i = 0; i < 20000; ++i) {
    ASSERT_EQ(next_number(reader), i);
    ASSERT_EQ(reader.offset(), places[i + 1]) << i;
  }
  EXPECT_FALSE(next_number(reader));
  EXPECT_FALSE(reader.torn());
}

TEST(BlackboxFileReader, TheTailBeginsWithTheFirstWholeRecordOfTheLastBytes) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 20);
  const auto places = record_places(test::bytes_of(folder.file(1)));
  const std::uint64_t size = places.back();
  BlackboxFileReader reader;
  for (std::uint64_t bytes = 0; bytes < size + 10; ++bytes) {
    ASSERT_EQ(reader.open(folder.file(1).c_str()), Opened::kOpen);
    reader.skip_to_tail(bytes);
    const std::uint64_t from = bytes < size ? size - bytes : 0;
    const auto first = std::ranges::lower_bound(places, from) - places.begin();
    ASSERT_EQ(count_of(reader), 20 - first) << bytes;
    ASSERT_EQ(reader.offset(), size) << bytes;
  }
}

// A reader takes one file after the other, and what it read before is still in its memory.
TEST(BlackboxFileReader, TakesNothingFromTheFileBefore) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 20);
  const std::uint64_t size = std::filesystem::file_size(folder.file(1));
  BlackboxFileReader reader;
  ASSERT_EQ(reader.open(folder.file(1).c_str()), Opened::kOpen);
  ASSERT_EQ(count_of(reader), 20U);
  for (std::uint64_t cut = 1; cut <= kRecordHead + kRecordTail; ++cut) {
    std::filesystem::resize_file(folder.file(1), size - cut);
    ASSERT_EQ(reader.open(folder.file(1).c_str()), Opened::kOpen);
    ASSERT_EQ(reader.offset(), kRecordsAt) << cut;
    ASSERT_EQ(count_of(reader), 19U) << cut;
    ASSERT_TRUE(reader.torn()) << cut;
    ASSERT_EQ(reader.damaged_stretches(), 0U) << cut;
  }
  std::filesystem::resize_file(folder.file(1), size - kRecordHead - kRecordTail - 1);
  ASSERT_EQ(reader.open(folder.file(1).c_str()), Opened::kOpen);
  EXPECT_FALSE(reader.torn()) << "nothing of it is read yet";
  test::write_bytes(folder.file(1), test::bytes_of(folder.file(1)).substr(0, kHeaderBytes - 1));
  EXPECT_EQ(reader.open(folder.file(1).c_str()), Opened::kCutOff);
  EXPECT_FALSE(next_number(reader));
}

TEST(BlackboxFileReader, ClosesAFileThatGotTheNumberOfTheStandardInput) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 20);
  const int kept = ::fcntl(0, F_DUPFD_CLOEXEC, 3);
  ASSERT_GE(kept, 0);
  ::close(0);
  BlackboxFileReader reader;
  const Opened opened = reader.open(folder.file(1).c_str());
  const bool was_open = ::fcntl(0, F_GETFD) >= 0;
  reader.close();
  const bool is_open = ::fcntl(0, F_GETFD) >= 0;
  ::dup2(kept, 0);
  ::close(kept);
  EXPECT_EQ(opened, Opened::kOpen);
  EXPECT_TRUE(was_open);
  EXPECT_FALSE(is_open);
}

TEST(BlackboxFileReader, CountsDamagedStretchesOfOneFile) {
  const BoxFolder folder;
  test::write_box(test::box_config(folder.path()), 0, 20);
  std::string bytes = test::bytes_of(folder.file(1));
  const auto places = record_places(bytes);
  for (const std::size_t hit : {2U, 3U, 9U}) bytes[places[hit] + kRecordHead] ^= 1;
  test::write_bytes(folder.file(1), bytes);
  BlackboxFileReader reader;
  for (int again = 0; again < 2; ++again) {
    ASSERT_EQ(reader.open(folder.file(1).c_str()), Opened::kOpen);
    EXPECT_EQ(count_of(reader), 17U);
    EXPECT_EQ(reader.damaged_stretches(), 2U) << "two neighbours are one";
    EXPECT_FALSE(reader.torn());
  }
}

TEST(BlackboxFileReader, SaysWhyAFileCannotBeRead) {
  const BoxFolder folder;
  BlackboxFileReader reader;
  EXPECT_EQ(reader.open(folder.file(1).c_str()), Opened::kGone);
  EXPECT_EQ(reader.error_number(), ENOENT);
  std::filesystem::create_directories(folder.path());
  EXPECT_EQ(reader.open(folder.path().c_str()), Opened::kError);
  EXPECT_EQ(reader.error_number(), EISDIR);
  BlackboxRecord record;
  EXPECT_EQ(reader.next(record), Status::kEnd);
}

}  // namespace
}  // namespace dampline::drivers
