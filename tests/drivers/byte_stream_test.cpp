// SPDX-License-Identifier: MIT
// Compressed by the programs that people use: gzip and zstd.
#include "drivers/bytes/byte_stream.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

#include "drivers/bytes/spool.hpp"
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
    EXPECT_EQ(read.count > 0, read.status == ByteStream::Status::kBytes);
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
  const AllBytes all = read_all(TemporaryFile{packed}.path());
  EXPECT_EQ(all.bytes, text);
  EXPECT_FALSE(all.cut_off);
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
  EXPECT_THAT(all.error, HasSubstr(file.path() + ": its compressed data are damaged before byte " +
                                   std::to_string(packed.size())));
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

/// Both ends of a pipe, and the path of the one to read from.
struct OpenPipe {
  std::array<int, 2> ends{};
  OpenPipe() { EXPECT_EQ(::pipe(ends.data()), 0); }
  OpenPipe(const OpenPipe&) = delete;
  OpenPipe& operator=(const OpenPipe&) = delete;
  ~OpenPipe() {
    close_writer();
    ::close(ends[0]);
  }
  void close_writer() {
    if (ends[1] >= 0) ::close(ends[1]);
    ends[1] = -1;
  }
  void write(std::string_view bytes) const {
    EXPECT_EQ(::write(ends[1], bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  }
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(ends[0]); }
};

/// What a stream gives of so many bytes that are put into its pipe 32 KiB at a time.
std::size_t pass_through(ByteStream& stream, const OpenPipe& pipe, std::size_t bytes) {
  const std::string piece(std::size_t{32} * 1024, 'p');
  std::array<char, 65536> part{};
  std::size_t count = 0;
  for (std::size_t put = 0; put < bytes;) {
    const std::size_t more = std::min(piece.size(), bytes - put);
    pipe.write(std::string_view{piece}.substr(0, more));
    for (put += more; count < put;) count += stream.read(part).count;
  }
  return count;
}

TEST(ByteStream, KeepsTheFirst8MiBOfAPipe) {
  EXPECT_EQ(ByteStream::kKept, 8U << 20U);
  for (const std::size_t more : {0U, 1U}) {
    OpenPipe pipe;
    {
      auto stream = ByteStream::open(pipe.path());
      pass_through(stream.value(), pipe, ByteStream::kKept + more);
    }
    pipe.close_writer();
    if (more == 0) {
      EXPECT_EQ(read_all(pipe.path()).bytes.size(), ByteStream::kKept);
    } else {
      EXPECT_THAT(ByteStream::open(pipe.path()).error_text(), HasSubstr("was read already"));
    }
  }
}

TEST(ByteStream, SumsUpWhatPassedThroughAPipe) {
  OpenPipe pipe;
  pipe.write("abc");
  auto stream = ByteStream::open(pipe.path());
  std::array<char, 100> part{};
  EXPECT_EQ(stream.value().read(part).count, 3U);
  EXPECT_FALSE(ByteStream::passed_through(pipe.path())) << "not to its end";
  pipe.close_writer();
  EXPECT_EQ(stream.value().read(part).status, ByteStream::Status::kEnd);
  const auto passed = ByteStream::passed_through(pipe.path());
  ASSERT_TRUE(passed);
  EXPECT_EQ(passed->bytes, 3U);
  // FIPS 180-4, the first example.
  EXPECT_EQ(passed->sha256, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(read_all(pipe.path()).bytes, "abc");
  EXPECT_EQ(ByteStream::passed_through(pipe.path())->bytes, 3U) << "once, though given twice";
  EXPECT_FALSE(ByteStream::passed_through(TemporaryFile{"abc"}.path()));
  EXPECT_FALSE(ByteStream::passed_through("/nonexistent"));
}

/// Standard input is something else for the time of a test.
class OtherInput {
 public:
  explicit OtherInput(const std::string& path)
      : before_{::dup(STDIN_FILENO)}, file_{::open(path.c_str(), O_RDONLY)} {
    EXPECT_EQ(::dup2(file_, STDIN_FILENO), STDIN_FILENO);
  }
  ~OtherInput() {
    ::dup2(before_, STDIN_FILENO);
    ::close(before_);
    ::close(file_);
  }
  OtherInput(const OtherInput&) = delete;
  OtherInput& operator=(const OtherInput&) = delete;

 private:
  int before_;
  int file_;
};

TEST(ByteStream, TellsOnePipeFromAnother) {
  OpenPipe one;
  OpenPipe two;
  one.write("abc");
  two.write("defg");
  one.close_writer();
  two.close_writer();
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(read_all(one.path()).bytes, "abc");
    EXPECT_EQ(ByteStream::passed_through(two.path()).has_value(), again > 0);
    EXPECT_EQ(read_all(two.path()).bytes, "defg");
  }
  EXPECT_EQ(ByteStream::passed_through(one.path())->bytes, 3U);
  EXPECT_EQ(ByteStream::passed_through(two.path())->bytes, 4U);
}

TEST(ByteStream, WhatIsShorterThanAMarkIsReadAsItIs) {
  for (const std::string_view bytes : {"", "x", "\x1F", "\x1F\x8B", "\x28\xB5\x2F", "abc"}) {
    const AllBytes all = read_all(TemporaryFile{bytes}.path());
    EXPECT_EQ(all.bytes, bytes);
    EXPECT_EQ(all.status, ByteStream::Status::kEnd);
  }
  EXPECT_EQ(ByteStream::open(TemporaryFile{"x"}.path()).value().share_read(), 0.0);
}

TEST(ByteStream, ADeviceThatIsNoTerminalIsNoPipe) {
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(read_all("/dev/null").status, ByteStream::Status::kEnd);
    EXPECT_FALSE(ByteStream::passed_through("/dev/null"));
  }
}

TEST(ByteStream, OfDamagedDataInAPipeThereIsNothingToWaitFor) {
  std::string packed = made_by("gzip", log_text(30));
  if (packed.empty()) GTEST_SKIP() << "gzip is not installed";
  packed[packed.size() / 2] ^= 0x55;
  OpenPipe pipe;
  pipe.write(packed);
  auto stream = ByteStream::open(pipe.path());
  std::array<char, 5000> part{};
  auto read = stream.value().read(part);
  while (read.status == ByteStream::Status::kBytes) read = stream.value().read(part);
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(read.status, ByteStream::Status::kError);
    EXPECT_EQ(read.count, 0U);
    EXPECT_EQ(stream.value().error(), Errc::kMalformed);
    EXPECT_TRUE(stream.value().wait(std::chrono::nanoseconds{0}));
    read = stream.value().read(part);
  }
}

std::size_t open_files() {
  const std::filesystem::directory_iterator files{"/proc/self/fd"};
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

TEST(ByteStream, LeavesNoFileOpen) {
  const TemporaryFile file{log_text(100)};
  const std::size_t before = open_files();
  {
    const OtherInput input{file.path()};
    auto one = ByteStream::open(file.path());
    const ByteStream moved{std::move(one.value())};
    EXPECT_EQ(read_all("-").bytes, read_all(file.path()).bytes);
    EXPECT_EQ(read_all("/").status, ByteStream::Status::kError);
    EXPECT_EQ(open_files(), before + 3) << "two of the other input, and one";
  }
  EXPECT_EQ(open_files(), before);
}

TEST(Spool, CopiesStandardInputFromWhereTheShellHasIt) {
  const std::string text = log_text(100);
  const TemporaryFile file{text};
  const OtherInput input{file.path()};
  ASSERT_EQ(::lseek(STDIN_FILENO, 43, SEEK_SET), 43);
  EXPECT_EQ(test::content_of(spooled("-").value()), text.substr(43));
  EXPECT_EQ(spooled_before("-"), "-");
}

TEST(Spool, WaitsForTheEndOfAPipe) {
  OpenPipe pipe;
  pipe.write("abc");
  std::thread writer{[&] {
    std::this_thread::sleep_for(std::chrono::milliseconds{30});
    pipe.write("def");
    pipe.close_writer();
  }};
  const std::string copy = spooled(pipe.path()).value();
  writer.join();
  EXPECT_EQ(test::content_of(copy), "abcdef");
}

// A pipe may give single bytes, and what they are is known only with the fourth.
TEST(ByteStream, KnowsCompressedDataThatComeByteByByte) {
  const std::string text = log_text(3);
  const std::string packed = made_by("gzip", text);
  if (packed.empty()) GTEST_SKIP() << "gzip is not installed";
  OpenPipe pipe;
  auto stream = ByteStream::open(pipe.path());
  std::string given;
  std::array<char, 4> part{};
  for (const char byte : packed) {
    pipe.write({&byte, 1});
    for (auto read = stream.value().read(part); read.count > 0; read = stream.value().read(part))
      given.append(part.data(), read.count);
  }
  EXPECT_EQ(given, text);
  OpenPipe other;
  auto plain = ByteStream::open(other.path());
  other.write("\x1F");
  EXPECT_EQ(plain.value().read(part).status, ByteStream::Status::kNothingYet);
  other.write("x");
  EXPECT_EQ(plain.value().read(part).count, 2U) << "what begins like it and goes on otherwise";
  EXPECT_EQ(part[0], '\x1F');
  other.close_writer();
  EXPECT_EQ(plain.value().read(part).status, ByteStream::Status::kEnd);
}

TEST(ByteStream, WaitsForAPipeOnly) {
  using namespace std::chrono_literals;
  OpenPipe pipe;
  auto stream = ByteStream::open(pipe.path());
  EXPECT_FALSE(stream.value().wait(0ns));
  EXPECT_FALSE(stream.value().wait(1ms));
  pipe.write("abc");
  EXPECT_TRUE(stream.value().wait(1h));
  std::array<char, 100> part{};
  EXPECT_EQ(stream.value().read(part).count, 3U);
  EXPECT_FALSE(stream.value().wait(0ns));
  auto again = ByteStream::open(pipe.path());
  EXPECT_TRUE(again.value().wait(0ns)) << "what it gave is kept";
  pipe.close_writer();
  EXPECT_TRUE(stream.value().wait(1h)) << "its end is something";
  auto file = ByteStream::open(TemporaryFile{"abc"}.path());
  EXPECT_TRUE(file.value().wait(0ns));
}

TEST(ByteStream, StandardInputBeginsWhereTheShellHasItAndStaysThere) {
  const std::string text = log_text(100);
  const TemporaryFile file{text};
  const OtherInput input{file.path()};
  ASSERT_EQ(::lseek(STDIN_FILENO, 43, SEEK_SET), 43);
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(read_all("-").bytes, text.substr(43));
    EXPECT_EQ(::lseek(STDIN_FILENO, 0, SEEK_CUR), 43);
  }
  EXPECT_EQ(ByteStream::open("-").value().name(), "standard input");
}

TEST(ByteStream, TellsTheShareOfAFileThatWasRead) {
  const TemporaryFile file{std::string(1000, 'x')};
  auto stream = ByteStream::open(file.path());
  std::array<char, 250> part{};
  EXPECT_EQ(stream.value().share_read(), 0.0);
  std::size_t count = 0;
  for (auto read = stream.value().read(part); read.count > 0; read = stream.value().read(part)) {
    count += read.count;
    EXPECT_DOUBLE_EQ(stream.value().share_read().value(), static_cast<double>(count) / 1000.0);
  }
  EXPECT_EQ(stream.value().share_read(), 1.0);
  const OtherInput input{file.path()};
  ASSERT_EQ(::lseek(STDIN_FILENO, 500, SEEK_SET), 500);
  auto half = ByteStream::open("-");
  for (count = 0; count < 250;) count += half.value().read(part).count;
  EXPECT_DOUBLE_EQ(half.value().share_read().value(), static_cast<double>(count) / 500.0);
  auto growing = ByteStream::open(file.path());
  std::ofstream{file.path(), std::ios::app} << std::string(1000, 'y');
  while (growing.value().read(part).count > 0) {
  }
  EXPECT_EQ(growing.value().share_read(), 1.0) << "all that it was, and more";
  EXPECT_FALSE(ByteStream::open(TemporaryFile{""}.path()).value().share_read());
  const OpenPipe pipe;
  EXPECT_FALSE(ByteStream::open(pipe.path()).value().share_read());
}

TEST(ByteStream, TheEndIsTheEndWhateverFailedBefore) {
  const TemporaryFile file{"abc"};
  auto stream = ByteStream::open(file.path());
  std::array<char, 100> part{};
  EXPECT_EQ(stream.value().read(part).count, 3U);
  for (const int error : {EAGAIN, EINTR}) {
    errno = error;  // of another call
    EXPECT_EQ(stream.value().read(part).status, ByteStream::Status::kEnd);
  }
}

// The first page of a program's memory is a file that opens, and cannot be read.
TEST(ByteStream, SaysWhyAFileCannotBeRead) {
  const AllBytes all = read_all("/proc/self/mem");
  EXPECT_EQ(all.status, ByteStream::Status::kError);
  EXPECT_THAT(all.error, HasSubstr("/proc/self/mem: cannot be read: Input/output error"));
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
