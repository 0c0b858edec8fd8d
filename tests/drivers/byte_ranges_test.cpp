// SPDX-License-Identifier: MIT
// Bytes through fixed buffers: all of them, once each, in their order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <array>
#include <cerrno>
#include <random>
#include <string>

#include "drivers/bytes/byte_reader.hpp"
#include "drivers/bytes/file_range.hpp"
#include "drivers/bytes/spool.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::content_of;
using test::TemporaryFile;
using testing::HasSubstr;
using testing::Not;

std::string chance_bytes(std::size_t count) {
  std::mt19937 random{5};
  std::string bytes(count, '\0');
  for (char& byte : bytes) byte = static_cast<char>(random());
  bytes.front() = 'x';  // else it might be taken for compressed
  return bytes;
}

std::string text_of(std::span<const char> bytes) { return {bytes.begin(), bytes.end()}; }

TEST(ByteReader, GivesEveryByteOnceWhateverIsAskedFor) {
  const std::string bytes = chance_bytes(20'000);
  const TemporaryFile file{bytes};
  std::mt19937 random{6};
  for (const std::size_t capacity : {8U, 20U, 100U, 50'000U}) {
    ByteReader reader{std::move(ByteStream::open(file.path()).value()), capacity};
    std::string given;
    while (given.size() < bytes.size()) {
      const std::size_t count =
          std::min({1 + random() % (capacity - 4), bytes.size() - given.size()});
      ASSERT_EQ(reader.need(count), ByteReader::Status::kBytes) << capacity;
      ASSERT_GE(reader.bytes().size(), count);
      ASSERT_EQ(reader.offset(), given.size());
      given += text_of(reader.bytes().first(count));
      reader.drop(count);
    }
    EXPECT_EQ(given, bytes) << capacity;
    EXPECT_EQ(reader.need(1), ByteReader::Status::kEnd);
  }
}

TEST(ByteReader, KeepsWhatIsLeftBeforeTheEnd) {
  const TemporaryFile file{"abcdefghij"};
  ByteReader reader{std::move(ByteStream::open(file.path()).value()), 20};
  ASSERT_EQ(reader.need(8), ByteReader::Status::kBytes);
  reader.drop(8);
  EXPECT_EQ(reader.need(3), ByteReader::Status::kEnd);
  EXPECT_EQ(text_of(reader.bytes()), "ij");
  EXPECT_EQ(reader.need(2), ByteReader::Status::kBytes);
}

TEST(RandomFile, IsReadAnywhereUpToItsEnd) {
  const std::string bytes = chance_bytes(100'000);
  const TemporaryFile file{bytes};
  const auto opened = RandomFile::open(file.path());
  ASSERT_TRUE(opened.ok()) << opened.error_text();
  const RandomFile& random_file = *opened.value();
  EXPECT_EQ(random_file.size(), bytes.size());
  std::array<char, 1000> part{};
  for (const std::size_t offset :
       {0U, 1U, 98'999U, 99'000U, 99'001U, 99'999U, 100'000U, 200'000U}) {
    const std::string expected = offset < bytes.size() ? bytes.substr(offset, part.size()) : "";
    EXPECT_EQ(random_file.read(offset, part), expected.size()) << offset;
    EXPECT_EQ(text_of(std::span{part}.first(expected.size())), expected) << offset;
  }
  std::filesystem::resize_file(file.path(), 50'000);
  errno = EINTR;  // of another call
  EXPECT_EQ(random_file.read(49'900, part), 100U) << "cut off meanwhile";
  EXPECT_EQ(RandomFile::open(TemporaryFile{""}.path()).value()->size(), 0U);
  EXPECT_THAT(RandomFile::open("/nonexistent").error_text(),
              HasSubstr("/nonexistent: cannot be opened: No such file"));
}

/// All that a range gives, some bytes at a time.
std::string all_of(FileRange& range, std::size_t most) {
  std::mt19937 random{7};
  std::string all;
  for (;;) {
    const std::size_t count = 1 + random() % most;
    const auto part = range.look(count);
    EXPECT_LE(part.size(), count);
    all += text_of(part);
    range.drop(part.size());
    if (part.size() < count) return all;
  }
}

// Longer than its buffer, so that it is filled many times.
TEST(FileRange, GivesTheBytesOfItsStretch) {
  const std::string bytes = chance_bytes(1'000'000);
  const TemporaryFile file{bytes};
  const auto opened = RandomFile::open(file.path()).value();
  for (const std::size_t most : {std::size_t{3000}, FileRange::kLongest}) {
    for (const auto& [begin, count] : {std::pair{0U, 1'000'000U},
                                       {12'345U, 700'001U},
                                       {5U, 1U},
                                       {999'999U, 1U},
                                       {400'000U, 0U},
                                       {900'000U, 200'000U}}) {
      FileRange range{opened, begin, count};
      EXPECT_EQ(all_of(range, most), bytes.substr(begin, count)) << begin;
    }
  }
  FileRange twice{opened, 100, 1000};
  EXPECT_EQ(text_of(twice.look(10)), bytes.substr(100, 10));
  EXPECT_EQ(text_of(twice.look(20)), bytes.substr(100, 20)) << "looking takes nothing";
  twice.drop(15);
  EXPECT_EQ(text_of(twice.look(5000)), bytes.substr(115, 985));
}

TEST(FileRange, InflatesAStretch) {
  const std::string bytes = chance_bytes(300'000) + std::string(500'000, 'n');
  std::string packed(::compressBound(bytes.size()), '\0');
  auto size = static_cast<uLongf>(packed.size());
  ASSERT_EQ(::compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                       reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()),
            Z_OK);
  packed.resize(size);
  const TemporaryFile file{"before" + packed + "behind"};
  const auto opened = RandomFile::open(file.path()).value();
  for (const std::size_t most : {std::size_t{3000}, FileRange::kLongest}) {
    FileRange range{opened, 6, size, make_zlib()};
    EXPECT_EQ(all_of(range, most), bytes);
    FileRange cut{opened, 6, size / 2, make_zlib()};
    const std::string part = all_of(cut, most);
    EXPECT_FALSE(part.empty());
    EXPECT_TRUE(part.size() < bytes.size() && bytes.starts_with(part));
  }
  FileRange damaged{opened, 0, size, make_zlib()};
  EXPECT_TRUE(damaged.look(10).empty());
}

/// Of bytes as gzip makes them.
std::string gzipped(const std::string& bytes) {
  const TemporaryFile packed{""};
  const gzFile file = ::gzopen(packed.path().c_str(), "wb");
  EXPECT_EQ(::gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size())),
            static_cast<int>(bytes.size()));
  ::gzclose(file);
  return content_of(packed.path());
}

TEST(Spool, CopiesWhatCannotBeReadAnywhere) {
  const std::string bytes = chance_bytes(200'000);
  const TemporaryFile plain{bytes};
  EXPECT_EQ(spooled(plain.path()).value(), plain.path()) << "a file as it is";
  EXPECT_EQ(spooled_before(plain.path()), plain.path());
  const TemporaryFile packed{gzipped(bytes)};
  const std::string copy = spooled(packed.path()).value();
  EXPECT_NE(copy, packed.path());
  EXPECT_EQ(content_of(copy), bytes) << "decompressed";
  EXPECT_THAT(spooled("/nonexistent").error_text(), HasSubstr("/nonexistent: cannot be opened"));
  EXPECT_EQ(spooled_before("/nonexistent"), "/nonexistent");
  std::string damaged = gzipped(bytes);
  damaged[damaged.size() - 6] ^= 1;  // in its checksum
  const TemporaryFile bad{damaged};
  EXPECT_THAT(spooled(bad.path()).error_text(), HasSubstr(bad.path() + ": its compressed data"));
}

TEST(Spool, CopiesAPipeOnce) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const std::string path = "/proc/self/fd/" + std::to_string(ends[0]);
  const std::string bytes = chance_bytes(50'000);
  ASSERT_EQ(::write(ends[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  ::close(ends[1]);
  EXPECT_EQ(spooled_before(path), path);
  const std::string copy = spooled(path).value();
  EXPECT_EQ(content_of(copy), bytes);
  EXPECT_EQ(spooled(path).value(), copy);
  EXPECT_EQ(spooled_before(path), copy);
  ::close(ends[0]);
}

}  // namespace
}  // namespace dampline::drivers
