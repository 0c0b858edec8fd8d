// SPDX-License-Identifier: MIT
// What a recording is, by its first bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string>
#include <thread>

#include "drivers/record/format.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A pipe whose reading end has a path.
class PathPipe {
 public:
  PathPipe() { EXPECT_EQ(::pipe(ends_.data()), 0); }
  ~PathPipe() {
    ::close(ends_[0]);
    ::close(ends_[1]);
  }
  PathPipe(const PathPipe&) = delete;
  PathPipe& operator=(const PathPipe&) = delete;
  [[nodiscard]] std::string path() const { return "/proc/self/fd/" + std::to_string(ends_[0]); }
  void write(std::string_view text) const {
    EXPECT_EQ(::write(ends_[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

 private:
  std::array<int, 2> ends_{};
};

constexpr std::array kFrameFormats{RecordFormat::kCandump, RecordFormat::kCandumpScreen,
                                   RecordFormat::kAsc,     RecordFormat::kTrc,
                                   RecordFormat::kBlf,     RecordFormat::kMdf4};
constexpr std::array kRowFormats{RecordFormat::kTable, RecordFormat::kNpy,
                                 RecordFormat::kNpz,   RecordFormat::kMat,
                                 RecordFormat::kHdf5,  RecordFormat::kMdf4Rows};
constexpr std::array kNotRead{RecordFormat::kMdf3, RecordFormat::kOtherZip, RecordFormat::kOldExcel,
                              RecordFormat::kTdms, RecordFormat::kPcap,     RecordFormat::kParquet,
                              RecordFormat::kXz,   RecordFormat::kBzip2};

TEST(RecordFormats, HoldFramesOrRowsOrHaveAWayOut) {
  for (const RecordFormat format : kFrameFormats) {
    EXPECT_TRUE(holds_frames(format)) << name_of(format);
    EXPECT_FALSE(holds_rows(format)) << name_of(format);
    EXPECT_THAT(way_out_of(format), IsEmpty()) << name_of(format);
  }
  for (const RecordFormat format : kRowFormats) {
    EXPECT_TRUE(holds_rows(format)) << name_of(format);
    EXPECT_FALSE(holds_frames(format)) << name_of(format);
    EXPECT_THAT(way_out_of(format), IsEmpty()) << name_of(format);
  }
  for (const RecordFormat format : kNotRead) {
    EXPECT_FALSE(holds_frames(format) || holds_rows(format)) << name_of(format);
    EXPECT_THAT(way_out_of(format), Not(IsEmpty())) << name_of(format);
  }
  for (const RecordFormat format : {RecordFormat::kEmpty, RecordFormat::kUnknown})
    EXPECT_FALSE(holds_frames(format) || holds_rows(format)) << name_of(format);
}

TEST(RecordFormats, AreKnownByTheirMarks) {
  using namespace std::string_view_literals;
  for (const auto& [mark, format] : {std::pair{"UnFinMF 4.10"sv, RecordFormat::kMdf4},
                                     {"\x93NUMPY\x01"sv, RecordFormat::kNpy},
                                     {"\x89HDF\r\n\x1A\n"sv, RecordFormat::kHdf5},
                                     {"MATLAB 5.0 MAT-file, Platform"sv, RecordFormat::kMat},
                                     {"MATLAB 7.3 MAT-file, Platform"sv, RecordFormat::kHdf5},
                                     {"\xD0\xCF\x11\xE0\xA1"sv, RecordFormat::kOldExcel},
                                     {"TDSm\x0E"sv, RecordFormat::kTdms},
                                     {"\x0A\x0D\x0D\x0A\x1C"sv, RecordFormat::kPcap},
                                     {"\xD4\xC3\xB2\xA1\x02"sv, RecordFormat::kPcap},
                                     {"\xA1\xB2\xC3\xD4\x00"sv, RecordFormat::kPcap},
                                     {"\x4D\x3C\xB2\xA1\x02"sv, RecordFormat::kPcap},
                                     {"PAR1\x15"sv, RecordFormat::kParquet},
                                     {"\xFD\x37zXZ\x00"sv, RecordFormat::kXz},
                                     {"BZh91AY"sv, RecordFormat::kBzip2}})
    EXPECT_EQ(format_of(mark), format) << name_of(format);
}

TEST(RecordFormats, FindHdf5BehindItsUserBlock) {
  const std::string mark = "\x89HDF\r\n\x1A\n";
  EXPECT_EQ(format_of(std::string(512, '\0') + mark), RecordFormat::kHdf5);
  EXPECT_EQ(format_of(std::string(511, '\0') + mark), RecordFormat::kUnknown);
  EXPECT_EQ(format_of(std::string(513, '\0') + mark), RecordFormat::kUnknown);
  EXPECT_EQ(format_of(std::string(512, 'x')), RecordFormat::kTable);
}

// APPNOTE.TXT 4.3.7: the length of the first name stands at byte 26, low byte first.
TEST(RecordFormats, TellNumPysZipFilesByTheirFirstName) {
  const auto zip = [](const std::string& name, const std::string& behind) {
    std::string head = "PK\x03\x04" + std::string(22, '\0');
    head += static_cast<char>(name.size() % 256);
    head += static_cast<char>(name.size() / 256);
    return head + std::string(2, '\0') + name + behind;
  };
  EXPECT_EQ(format_of(zip("force_n.npy", "\x93NUMPY")), RecordFormat::kNpz);
  EXPECT_EQ(format_of(zip(std::string(700, 'n') + ".npy", "\x93NUMPY")), RecordFormat::kNpz);
  EXPECT_EQ(format_of(zip("sheet.xml", ".npy")), RecordFormat::kOtherZip);
  EXPECT_EQ(format_of(zip("", ".npy")), RecordFormat::kOtherZip);
  EXPECT_EQ(format_of("PK\x03\x04.npy"), RecordFormat::kOtherZip);
}

TEST(RecordFormats, KnowACandumpLogByAnyIdentifier) {
  for (const char* id : {"000", "09AFaf", "1FFFFFFF", "7ff", "F"})
    EXPECT_EQ(format_of("(1.0) can0 " + std::string{id} + "#00\n"), RecordFormat::kCandump) << id;
  for (const char* line :
       {"(1.0) can0 #00", "(1.0) can0 1234567890#00", "(1.0 can0 123#00", "(1.0) can0 123",
        "1.0) can0 123#00", "(1.0) can0 12G#00", "(1.0) can0 12/#00", "(1.0) can0 12:#00",
        "(1.0) can0 12@#00", "(1.0) can0 12`#00", "(1.0) can0 12g#00", "(1.0) can0 123456789#00"})
    EXPECT_EQ(format_of(line), RecordFormat::kTable) << line;
}

TEST(RecordFormats, KnowWhatCandumpPrints) {
  for (const char* line :
       {"can0 123 [8] 11", "  can0  123   [08]  11", "\tcan0 RX B E 123 [12] 11",
        " (000.000000)  can0  123   [0]\r", "(2020-09-13 12:26:40.1) can0 F [1] 11"})
    EXPECT_EQ(format_of(std::string{line} + "\n"), RecordFormat::kCandumpScreen) << line;
  for (const char* line :
       {"123 [8] 11", "can0 123 [] 11", "can0 123 [128] 11", "can0 123 [N] 11", "can0 123 (8) 11",
        "can0 123 [8 11", "can0 12G [8] 11", "can0 123456789 [8] 11", "(000.0 can0 123 [8] 11",
        "a b c d e 123 [8] 11", "can0 123 8] 11", "can0"})
    EXPECT_EQ(format_of(std::string{line} + "\n"), RecordFormat::kTable) << line;
}

TEST(RecordFormats, KnowTextOfOtherPrograms) {
  for (const char* line : {"date Tue Nov 14", "base hex  timestamps", "base dec  timestamps",
                           "Begin Triggerblock Tue", "Begin TriggerBlock Tue"})
    EXPECT_EQ(format_of(line), RecordFormat::kAsc) << line;
  EXPECT_EQ(format_of(";   Start time: 01.01.2020\n"), RecordFormat::kTrc);
  EXPECT_EQ(format_of("   Start time: 01.01.2020\n"), RecordFormat::kTable);
  EXPECT_EQ(format_of("; a comment\n"), RecordFormat::kTable);
}

TEST(RecordFormats, LookAtTheFirst200Lines) {
  const auto after = [](int lines) {
    std::string text;
    for (int i = 0; i < lines; ++i) text += "noise\n";
    return text + "(1.0) can0 123#00\n";
  };
  EXPECT_EQ(format_of(after(199)), RecordFormat::kCandump);
  EXPECT_EQ(format_of(after(200)), RecordFormat::kTable);
}

TEST(RecordFormats, LookAtTheFirst64KiB) {
  std::string text;
  while (text.size() < 200'000) text += "line " + std::to_string(text.size()) + "\n";
  EXPECT_EQ(read_head(test::TemporaryFile{text}.path()).value(), text.substr(0, 65536));
  EXPECT_EQ(read_head(test::TemporaryFile{text.substr(0, 50'000)}.path()).value(),
            text.substr(0, 50'000));
  EXPECT_EQ(detect_format(test::TemporaryFile{""}.path()).value(), RecordFormat::kEmpty);
  EXPECT_THAT(detect_format("/nonexistent/log").error_text(), HasSubstr("/nonexistent/log"));
}

// Ten pipes, so that a pause at each would be seen on a busy computer, too.
TEST(RecordFormats, OfAPipeAreKnownWithItsFirstFrame) {
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 10; ++i) {
    const PathPipe pipe;
    pipe.write("(1600000000.000000) can0 123#00\n(16000");
    EXPECT_EQ(detect_format(pipe.path()).value(), RecordFormat::kCandump);
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds{2});
}

TEST(RecordFormats, OfAPipeWaitForTheFirstLine) {
  const PathPipe pipe;
  pipe.write("(1600000000.0");
  std::thread later{[&] {
    std::this_thread::sleep_for(std::chrono::milliseconds{450});
    pipe.write("00000) can0 123#00\n");
  }};
  EXPECT_EQ(detect_format(pipe.path()).value(), RecordFormat::kCandump);
  later.join();
}

TEST(RecordFormats, OfAPipeAreATableWhereNoMoreComes) {
  const PathPipe pipe;
  pipe.write("time_s,force_n\n0.1,2\n0.2");
  EXPECT_EQ(detect_format(pipe.path()).value(), RecordFormat::kTable);
  EXPECT_EQ(read_head(pipe.path()).value(), "time_s,force_n\n0.1,2\n0.2") << "and all is there";
}

}  // namespace
}  // namespace dampline::drivers
