// SPDX-License-Identifier: MIT
// What is left of a black box that was damaged: exactly what was not hit.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "drivers/blackbox/file_reader.hpp"
#include "drivers/blackbox/format.hpp"
#include "tests/blackbox.hpp"

namespace dampline::drivers {
namespace {

using test::BoxContent;
using test::BoxFolder;
using test::bytes_of;
using test::read_box;
using test::write_bytes;

constexpr std::uint64_t kRecords = 20;

/// A small black box of one file, and where each of its records begins.
class SmallBox {
 public:
  SmallBox() {
    test::write_box(test::box_config(folder_.path()), 0, kRecords);
    bytes_ = bytes_of(folder_.file(1));
    for (std::size_t at = kRecordsAt; at < bytes_.size();) {
      begins_.push_back(at);
      at += kRecordHead + static_cast<std::uint8_t>(bytes_[at + kRecordLengthAt]) + kRecordTail;
    }
    begins_.push_back(bytes_.size());
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  [[nodiscard]] BoxContent with(const std::string& bytes) const {
    write_bytes(folder_.file(1), bytes);
    return read_box(folder_.path());
  }
  /// Numbers of the records that no byte of [from, to) belongs to.
  [[nodiscard]] std::vector<std::uint64_t> beside(std::size_t from, std::size_t to) const {
    std::vector<std::uint64_t> numbers;
    for (std::size_t i = 0; i + 1 < begins_.size(); ++i)
      if (begins_[i + 1] <= from || begins_[i] >= to) numbers.push_back(i);
    return numbers;
  }
  [[nodiscard]] const std::vector<std::size_t>& begins() const { return begins_; }
  [[nodiscard]] const BoxFolder& folder() const { return folder_; }

 private:
  BoxFolder folder_;
  std::string bytes_;
  std::vector<std::size_t> begins_;
};

// What a reader's buffer held before lies behind the end of a file that is longer.
TEST(BlackboxDamage, ATornTailIsNotReadOnIntoWhatTheBufferHeldBefore) {
  constexpr std::uint64_t kMany = 8'000;
  const BoxFolder whole;
  test::write_box(test::box_config(whole.path()), 0, kMany);
  const std::string bytes = bytes_of(whole.file(1));
  const BoxFolder torn;
  std::filesystem::create_directories(torn.path());
  for (std::size_t cut = 1; cut <= 120; ++cut) {
    write_bytes(torn.file(1), bytes.substr(0, bytes.size() - cut));
    const std::vector<std::uint64_t> numbers = read_box(torn.path()).numbers();
    ASSERT_EQ(numbers, test::range(0, numbers.size())) << cut;
    ASSERT_GE(numbers.size(), kMany - 6) << cut;
  }
}

TEST(BlackboxDamage, ATailOfOneByteIsNotSearchedBeyondIt) {
  const SmallBox box;
  const std::size_t last = box.begins()[kRecords - 1];
  const std::string until_last = box.bytes().substr(0, last);
  const std::filesystem::path file = box.folder().file(1);
  BlackboxFileReader reader;
  // The last record stays in the buffer, where a search for its mark must not come to it.
  write_bytes(file, until_last + "??" + box.bytes().substr(last));
  ASSERT_EQ(reader.open(file.c_str()), BlackboxFileReader::Opened::kOpen);
  write_bytes(file, until_last + "?");
  ASSERT_EQ(reader.open(file.c_str()), BlackboxFileReader::Opened::kOpen);
  BlackboxRecord record;
  std::uint64_t count = 0;
  while (reader.next(record) == BlackboxFileReader::Status::kRecord) ++count;
  EXPECT_EQ(count, kRecords - 1);
  EXPECT_TRUE(reader.torn());
}

TEST(BlackboxDamage, NoneIsSeenInAWholeOne) {
  const SmallBox box;
  ASSERT_EQ(box.begins().size(), kRecords + 1);
  const BoxContent content = box.with(box.bytes());
  EXPECT_EQ(content.numbers(), test::range(0, kRecords));
  EXPECT_TRUE(content.all_true());
  EXPECT_EQ(content.end, Errc::kEndOfStream);
  EXPECT_EQ(content.health.malformed + content.health.dropped, 0U);
  EXPECT_FALSE(content.health.truncated);
}

TEST(BlackboxDamage, EveryFlippedBitLosesExactlyTheRecordThatItHits) {
  const SmallBox box;
  std::string bytes = box.bytes();
#ifdef DAMPLINE_SANITIZED
  constexpr std::size_t kStep = 5;  // of every byte one bit or two, and each of the eight in turn
#else
  constexpr std::size_t kStep = 1;
#endif
  for (std::size_t bit = 0; bit < 8 * bytes.size(); bit += kStep) {
    const auto mask = static_cast<char>(1U << bit % 8);
    const std::size_t at = bit / 8;
    bytes[at] = static_cast<char>(bytes[at] ^ mask);
    const BoxContent content = box.with(bytes);
    bytes[at] = static_cast<char>(bytes[at] ^ mask);
    const auto expected = box.beside(at, at + 1);
    ASSERT_EQ(content.numbers(), expected) << "bit " << bit;
    ASSERT_TRUE(content.all_true()) << "bit " << bit;
    const bool hit = expected.size() < kRecords;
    const bool last = hit && at >= box.begins()[kRecords - 1];
    ASSERT_EQ(content.health.malformed, hit && !last ? 1U : 0U) << "bit " << bit;
    ASSERT_EQ(content.health.dropped, hit && !last ? 1U : 0U) << "bit " << bit;
    ASSERT_EQ(content.health.truncated, last) << "bit " << bit;
  }
}

TEST(BlackboxDamage, EveryTruncationLosesExactlyWhatIsCutOff) {
  const SmallBox box;
  for (std::size_t size = 0; size < box.bytes().size(); ++size) {
    const BoxContent content = box.with(box.bytes().substr(0, size));
    if (size < kHeaderBytes) {
      ASSERT_FALSE(content.opened) << size;
      ASSERT_NE(content.error.find("is cut off in its header"), std::string::npos);
      continue;
    }
    const auto expected = box.beside(size, box.bytes().size());
    ASSERT_EQ(content.numbers(), expected) << size;
    ASSERT_TRUE(content.all_true()) << size;
    const bool at_record = std::ranges::count(box.begins(), size) == 1;
    ASSERT_EQ(content.health.truncated, !at_record) << size;
    ASSERT_EQ(content.health.malformed, 0U) << size;
  }
}

// Of equal bytes in a row nobody can tell which one is missing: the last, then, and where its
// record is the next one, the one before is whole.
TEST(BlackboxDamage, EveryMissingByteLosesExactlyItsRecord) {
  const SmallBox box;
  for (std::size_t at = kRecordsAt; at < box.bytes().size(); ++at) {
    std::string bytes = box.bytes();
    const std::size_t missing = std::min(bytes.find_first_not_of(bytes[at], at), bytes.size()) - 1;
    bytes.erase(at, 1);
    const BoxContent content = box.with(bytes);
    ASSERT_EQ(content.numbers(), box.beside(missing, missing + 1)) << at;
    ASSERT_TRUE(content.all_true()) << at;
  }
}

// A checksum may end in a zero, and a hole that begins there leaves its record as it was.
TEST(BlackboxDamage, EveryHoleOfASectorLosesExactlyTheRecordsInIt) {
  const SmallBox box;
  for (std::size_t at = 0; at < box.bytes().size(); ++at) {
    std::string bytes = box.bytes();
    const std::size_t end = std::min(at + 512, bytes.size());
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(at),
              bytes.begin() + static_cast<std::ptrdiff_t>(end), '\0');
    const std::size_t hit = std::min(box.bytes().find_first_not_of('\0', at), end);
    const BoxContent content = box.with(bytes);
    ASSERT_TRUE(content.opened) << at;
    ASSERT_EQ(content.numbers(), box.beside(hit, end)) << at;
    ASSERT_TRUE(content.all_true()) << at;
  }
}

// Power cut: the file is as long as the last size that reached the disk, and behind what was synced
// stands anything: zeros, garbage, or an old block, here one with records of another file and one
// with records of this file.
TEST(BlackboxDamage, PowerCutsAtEveryByteLoseNothingThatWasSyncedAndInventNothing) {
  const SmallBox box;
  const SmallBox other;
  std::mt19937 random{3};
  for (std::size_t cut = box.begins()[kRecords - 6]; cut <= box.bytes().size(); ++cut) {
    const std::string kept = box.bytes().substr(0, cut);
    std::string garbage(600, '\0');
    for (char& byte : garbage) byte = static_cast<char>(random());
    for (const std::string& tail :
         {std::string(600, '\0'), std::string(600, '\xff'), garbage,
          other.bytes().substr(kRecordsAt), box.bytes().substr(kRecordsAt, 200),
          std::string(5000, static_cast<char>(0xDB))}) {
      const std::string bytes = kept + tail;
      const BoxContent content = box.with(bytes);
      // By chance the tail may begin with the very bytes that were cut off.
      const auto same = std::ranges::mismatch(bytes, box.bytes()).in1 - bytes.begin();
      const auto expected = box.beside(static_cast<std::size_t>(same), box.bytes().size());
      ASSERT_EQ(content.numbers(), expected) << cut;
      ASSERT_TRUE(content.all_true()) << cut;
      ASSERT_TRUE(content.health.truncated) << cut;
    }
  }
}

TEST(BlackboxDamage, TheNextStartGoesOnBehindATornEndInANewFile) {
  const SmallBox box;
  for (std::size_t size = 0; size <= box.bytes().size(); size += 7) {
    const std::string torn = box.bytes().substr(0, size);
    write_bytes(box.folder().file(1), torn);
    test::write_box(test::box_config(box.folder().path()), 1000, 3);
    ASSERT_EQ(bytes_of(box.folder().file(1)), torn);  // left as it is
    const BoxContent content = read_box(box.folder().path());
    auto expected = box.beside(size, box.bytes().size());
    if (size < kHeaderBytes) expected.clear();
    for (const std::uint64_t number : test::range(1000, 3)) expected.push_back(number);
    ASSERT_EQ(content.numbers(), expected) << size;
    ASSERT_EQ(content.health.dropped, 0U) << size;  // whoever was killed could not count
    ASSERT_FALSE(content.health.truncated) << size;
    std::filesystem::remove(box.folder().file(2));
  }
}

TEST(BlackboxDamage, AFileWithoutAHeaderLosesOnlyItself) {
  BoxFolder folder;
  auto config = test::box_config(folder.path());
  const auto writer = test::open_box(config);
  for (std::uint64_t i = 0; i < 30; ++i) {
    writer->write(test::numbered_frame(i));
    if (i % 10 == 9) writer->close();
  }
  std::string bytes = bytes_of(folder.file(2));
  std::fill_n(bytes.begin(), kRecordsAt, '\0');
  write_bytes(folder.file(2), bytes);
  const BoxContent content = read_box(folder.path());
  auto expected = test::range(0, 10);
  for (const std::uint64_t number : test::range(20, 10)) expected.push_back(number);
  EXPECT_EQ(content.numbers(), expected);
  EXPECT_EQ(content.health.dropped, 10U);
  EXPECT_EQ(content.health.malformed, 1U);
  EXPECT_EQ(content.findings.unreadable_files, 1U);
}

TEST(BlackboxDamage, ACopyOfAnEarlierBlockIsNoRecord) {
  const SmallBox box;
  const std::size_t begin = box.begins()[3];
  const std::string block = box.bytes().substr(begin, box.begins()[6] - begin);
  std::string bytes = box.bytes();
  bytes.insert(box.begins()[10], block);
  const BoxContent content = box.with(bytes);
  EXPECT_EQ(content.numbers(), test::range(0, kRecords));
  EXPECT_EQ(content.health.malformed, 1U);
}

}  // namespace
}  // namespace dampline::drivers
