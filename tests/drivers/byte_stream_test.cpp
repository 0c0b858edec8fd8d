// SPDX-License-Identifier: MIT
// Compressed by the programs that people use: gzip and zstd.
#include "drivers/bytes/byte_stream.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "drivers/record/format.hpp"
#include "drivers/record/frames.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::TemporaryFile;
using testing::HasSubstr;

std::string log_text(int frames) {
  std::string text;
  for (int i = 0; i < frames; ++i)
    text += fmt::format("(1600000000.{:06}) can0 310#{:08X}\n", i * 10,
                        static_cast<unsigned>(i) * 2654435761U);
  return text;
}

struct AllBytes {
  std::string bytes;
  ByteStream::Status status{};
  bool cut_off{false};
  std::string error;
};
AllBytes read_all(const std::string& path) {
  auto stream = ByteStream::open(path);
  AllBytes out;
  if (!stream) return {{}, ByteStream::Status::kError, false, stream.error_text()};
  std::array<char, 5000> part{};
  for (auto read = stream.value().read(part);; read = stream.value().read(part)) {
    out.bytes.append(part.data(), read.count);
    out.status = read.status;
    if (read.status == ByteStream::Status::kNothingYet || read.status == ByteStream::Status::kBytes)
      continue;
    out.cut_off = stream.value().is_cut_off();
    if (read.status == ByteStream::Status::kError) out.error = stream.value().error_text();
    return out;
  }
}

/// What a program makes of a text; skips the test where there is none such.
std::string made_by(const std::string& program, const std::string& text) {
  const TemporaryFile plain{text};
  const std::string path = plain.path() + ".packed";
  const int code = std::system((program + " -c '" + plain.path() + "' > '" + path + "'").c_str());
  std::ifstream stream{path, std::ios::binary};
  std::string out{std::istreambuf_iterator<char>{stream}, {}};
  std::filesystem::remove(path);
  return code == 0 ? out : std::string{};
}

class Compressed : public testing::TestWithParam<const char*> {};

TEST_P(Compressed, BytesAreThoseThatWereCompressed) {
  const std::string text = log_text(20000);
  const std::string packed = made_by(GetParam(), text);
  if (packed.empty()) GTEST_SKIP() << GetParam() << " is not installed";
  EXPECT_LT(packed.size(), text.size() / 2);
  EXPECT_EQ(read_all(TemporaryFile{packed}.path()).bytes, text);
  const TemporaryFile twice{packed + packed};
  EXPECT_EQ(read_all(twice.path()).bytes, text + text) << "members one behind the other";
}

TEST_P(Compressed, CutOffTheyGiveWhatThereIsAndSaySo) {
  const std::string text = log_text(3000);
  const std::string packed = made_by(GetParam(), text);
  if (packed.empty()) GTEST_SKIP() << GetParam() << " is not installed";
  for (std::size_t size = 5; size < packed.size(); size += packed.size() / 50) {
    const TemporaryFile file{packed.substr(0, size)};
    const AllBytes all = read_all(file.path());
    EXPECT_EQ(all.status, ByteStream::Status::kEnd) << size;
    EXPECT_TRUE(all.cut_off) << size;
    EXPECT_TRUE(text.starts_with(all.bytes)) << size;
  }
}

TEST_P(Compressed, DamageIsAnErrorThatNamesTheFile) {
  std::string packed = made_by(GetParam(), log_text(3000));
  if (packed.empty()) GTEST_SKIP() << GetParam() << " is not installed";
  for (std::size_t i = packed.size() / 2; i < packed.size() / 2 + 40; ++i) packed[i] = 'x';
  const TemporaryFile file{packed};
  const AllBytes all = read_all(file.path());
  EXPECT_EQ(all.status, ByteStream::Status::kError);
  EXPECT_THAT(all.error, HasSubstr(file.path() + ": its compressed data are damaged"));
}

TEST_P(Compressed, FramesAreReadFromThem) {
  const std::string text = log_text(20000);
  std::string packed = made_by(GetParam(), text);
  if (packed.empty()) GTEST_SKIP() << GetParam() << " is not installed";
  const TemporaryFile file{packed.substr(0, packed.size() - 20)};
  EXPECT_EQ(detect_format(file.path()).value(), RecordFormat::kCandump);
  auto source = open_frames({.path = file.path()});
  std::array<CanFrame, 64> frames;
  std::size_t count = 0;
  for (auto read = source.value()->read(frames); read; read = source.value()->read(frames))
    count += read.value();
  EXPECT_GT(count, 1000U);
  EXPECT_LT(count, 20000U);
  EXPECT_EQ(source.value()->health().frames, count);
  EXPECT_TRUE(source.value()->health().truncated);
}

INSTANTIATE_TEST_SUITE_P(By, Compressed, testing::Values("gzip", "zstd"));

TEST(ByteStream, APipeIsReadAgainFromItsBeginningUntilTooMuchHasPassed) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::pipe(ends.data()), 0);
  const std::string path = "/proc/self/fd/" + std::to_string(ends[0]);
  const std::string text = log_text(100);
  ASSERT_EQ(::write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  EXPECT_EQ(detect_format(path).value(), RecordFormat::kCandump);
  EXPECT_EQ(detect_format(path).value(), RecordFormat::kCandump) << "and a second time";
  ::close(ends[1]);
  EXPECT_EQ(read_all(path).bytes, text);
  EXPECT_EQ(read_all(path).bytes, text);
  ::close(ends[0]);
}

TEST(ByteStream, SaysWhatCannotBeOpened) {
  EXPECT_THAT(ByteStream::open("/nonexistent").error_text(), HasSubstr("/nonexistent: cannot be"));
  EXPECT_THAT(ByteStream::open("/").error_text(), HasSubstr("directory"));
}

TEST(Format, IsKnownByContent) {
  const auto of = [](std::string_view text) { return format_of(text); };
  EXPECT_EQ(of(""), RecordFormat::kEmpty);
  EXPECT_EQ(of("\xEF\xBB\xBF(1600000000.000000) can0 123#00\n"), RecordFormat::kCandump);
  EXPECT_EQ(of("noise\n(1600000000.000000)   can0 123##100\n"), RecordFormat::kCandump);
  EXPECT_EQ(of(" (000.000000)  can0  123   [2]  11 22\n"), RecordFormat::kCandumpScreen);
  EXPECT_EQ(of("  can0  RX - -  123   [2]  11 22\n"), RecordFormat::kCandumpScreen);
  EXPECT_EQ(of("date Sun Sep 13 12:26:40.000 2020\nbase hex  timestamps absolute\n"),
            RecordFormat::kAsc);
  EXPECT_EQ(of(";$FILEVERSION=1.1\n"), RecordFormat::kTrc);
  EXPECT_EQ(of("LOGG\x90"), RecordFormat::kBlf);
  EXPECT_EQ(of("MDF     4.10    "), RecordFormat::kMdf4);
  EXPECT_EQ(of("MDF     3.30    "), RecordFormat::kMdf3);
  EXPECT_EQ(of("time_s,force_n\n0.1,2\n"), RecordFormat::kTable);
  EXPECT_EQ(of("x [mm],Force A [N] y\n1 2\n"), RecordFormat::kTable)
      << "a unit in brackets is no length";
  EXPECT_EQ(of(std::string_view{"a\0b", 3}), RecordFormat::kUnknown);
  EXPECT_FALSE(way_out_of(RecordFormat::kMdf3).empty());
  EXPECT_TRUE(way_out_of(RecordFormat::kMdf4).empty());
}

}  // namespace
}  // namespace dampline::drivers
