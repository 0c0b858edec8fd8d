// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "drivers/text/cursor.hpp"
#include "drivers/text/kind.hpp"
#include "drivers/text/line_reader.hpp"
#include "drivers/text/quote.hpp"
#include "drivers/text/whole_file.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

TEST(LineReader, ShowsWhatFollowsTheLastLine) {
  const test::TemporaryFile file{"one\ntwo\nthree"};
  auto reader = LineReader::open(file.path());
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ(reader.value().peek(), "one\ntwo\nthree");
  std::string_view line;
  ASSERT_EQ(reader.value().next(line), LineReader::Status::kLine);
  EXPECT_EQ(reader.value().peek(), "two\nthree");
  ASSERT_EQ(reader.value().next(line), LineReader::Status::kLine);
  EXPECT_EQ(line, "two");
}

TEST(Cursor, TakesWordsBetweenBlanks) {
  std::string_view rest = "  ab\t c ";
  EXPECT_EQ(take_word(rest), "ab");
  EXPECT_EQ(take_word(rest), "c");
  EXPECT_EQ(take_word(rest), "");
  EXPECT_EQ(take_word(rest), "");
}

TEST(Cursor, ReadsWholeNumbersOf32Bits) {
  EXPECT_EQ(read_whole_number("4294967295", 10), 4294967295U);
  EXPECT_EQ(read_whole_number("4294967296", 10), std::nullopt);
  EXPECT_EQ(read_whole_number("fF", 16), 255U);
  for (const char* none : {"", "12x", "-1", " 1", "0x1"})
    EXPECT_EQ(read_whole_number(none, 10), std::nullopt) << none;
}

TEST(Cursor, ReadsBillionthsWithoutRounding) {
  EXPECT_EQ(read_nano("12.345678"), 12'345'678'000);
  EXPECT_EQ(read_nano("0.1234567899"), 123'456'789);
  EXPECT_EQ(read_nano("7"), 7'000'000'000);
  EXPECT_EQ(read_nano("7."), 7'000'000'000);
  EXPECT_EQ(read_nano("9223372035.999999999"), 9'223'372'035'999'999'999);
  for (const char* none : {"", ".5", "9223372036", "-1", "1.2x", "1x", "1.2.3"})
    EXPECT_EQ(read_nano(none), std::nullopt) << none;
}

TEST(Cursor, TakesBytesAndPointsAtWhatIsNone) {
  CanFrame frame;
  frame.data.fill(9);
  std::string_view rest = "0A ff 7 x";
  EXPECT_EQ(take_bytes(rest, 3, 16, frame), nullptr);
  EXPECT_EQ(frame.length, 3);
  EXPECT_EQ(frame.data[1], 0xFF);
  EXPECT_EQ(frame.data[2], 7);
  EXPECT_EQ(frame.data[3], 0);
  EXPECT_EQ(rest, " x");
  const std::string_view line = "255 256";
  rest = line;
  EXPECT_EQ(take_bytes(rest, 2, 10, frame), line.data() + 4);
  EXPECT_EQ(frame.length, 1);
  std::string many;
  for (int i = 0; i < 65; ++i) many += "1 ";
  rest = many;
  EXPECT_EQ(take_bytes(rest, 64, 16, frame), nullptr);
  EXPECT_EQ(frame.length, 64);
  rest = many;
  EXPECT_NE(take_bytes(rest, 65, 16, frame), nullptr);
}

TEST(Cursor, KnowsTheLengthCodesOfCanFd) {
  constexpr std::array<int, 16> kLengths{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
  for (std::uint32_t code = 0; code < 16; ++code) EXPECT_EQ(length_of_code(code), kLengths[code]);
}

TEST(Quote, ShowsWhatPrintsAndTheBeginningOfWhatIsLong) {
  EXPECT_EQ(quote(""), "nothing");
  EXPECT_EQ(quote("a ~b"), "\"a ~b\"");
  EXPECT_EQ(quote("a\x1F\x7F\xC3"), "\"a\\x1F\\x7F\\xC3\"");
  EXPECT_EQ(quote(std::string(60, 'x')), fmt::format("\"{:x<60}\"", ""));
  EXPECT_EQ(quote(std::string(61, 'x')), fmt::format("\"{:x<60}...\"", ""));
}

TEST(Printable, LeavesLettersAndWritesTheRestAsBytes) {
  EXPECT_EQ(printable("a \xC3\xA4 \xE2\x82\xAC \xF0\x9F\x9A\x83~"),
            "a \xC3\xA4 \xE2\x82\xAC \xF0\x9F\x9A\x83~");
  EXPECT_EQ(printable("\n\x1B\x7F"), "\\x0A\\x1B\\x7F");
  EXPECT_EQ(printable("a\nb", true), "a\nb");
  EXPECT_EQ(printable("\xC2\x85"), "\\xC2\\x85") << "a C1 control";
  EXPECT_EQ(printable("\xC2\xA0"), "\xC2\xA0");
  EXPECT_EQ(printable("\xC0\xAF"), "\\xC0\\xAF") << "more bytes than needed";
  EXPECT_EQ(printable("\xE0\x9F\xBF"), "\\xE0\\x9F\\xBF");
  EXPECT_EQ(printable("\xE0\xA0\x80"), "\xE0\xA0\x80");
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xED\\xA0\\x80") << "a surrogate";
  EXPECT_EQ(printable("\xED\x9F\xBF"), "\xED\x9F\xBF");
  EXPECT_EQ(printable("\xF0\x8F\xBF\xBF"), "\\xF0\\x8F\\xBF\\xBF");
  EXPECT_EQ(printable("\xF0\x90\x80\x80"), "\xF0\x90\x80\x80");
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xF4\\x90\\x80\\x80") << "beyond U+10FFFF";
  EXPECT_EQ(printable("\xF4\x8F\xBF\xBF"), "\xF4\x8F\xBF\xBF");
  EXPECT_EQ(printable("\xF5\x80\x80\x80"), "\\xF5\\x80\\x80\\x80");
  EXPECT_EQ(printable("\xE2\x82"), "\\xE2\\x82") << "cut off";
  EXPECT_EQ(printable("\xE2(\xA1"), "\\xE2(\\xA1");
}

TEST(ListNames, CutsLongNamesAndManyOfThem) {
  EXPECT_EQ(list_names({}), "");
  EXPECT_EQ(list_names({"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(list_names({"a", "b", "c"}, 2), "a, b and 1 more");
  EXPECT_EQ(list_names({"a", "b", "c"}, 3), "a, b, c");
  EXPECT_FALSE(list_names(std::vector<std::string>(24, "a")).ends_with(" more"));
  EXPECT_TRUE(list_names(std::vector<std::string>(25, "a")).ends_with(" and 1 more"));
  EXPECT_EQ(list_names({std::string(61, 'x'), std::string(60, 'y')}),
            fmt::format("{:x<60}..., {:y<60}", "", ""));
}

TEST(NearestNames, AreThoseOfTheLeastEditsWithoutRegardToCase) {
  const std::vector<std::string> names{"force_n", "time", "Time_s", "velocity", "times", "x"};
  EXPECT_EQ(nearest_names("time_s", names.data(), names.size(), 3), "Time_s, times, time");
  EXPECT_EQ(nearest_names("TIME", names.data(), names.size(), 1), "time");
  EXPECT_EQ(nearest_names("a", names.data(), 0), "");
  EXPECT_EQ(nearest_names("xy", names.data(), names.size(), 1), "x");
}

TEST(WholeFile, IsReadUpToTheMostThatIsAllowed) {
  const std::string text(600'000, 'z');
  const test::TemporaryFile file{text};
  EXPECT_EQ(read_whole(file.path()).value(), text);
  EXPECT_EQ(read_whole(file.path(), text.size()).value(), text);
  EXPECT_THAT(read_whole(file.path(), text.size() - 1).error_text(),
              testing::HasSubstr("is larger than 599999 bytes"));
  EXPECT_THAT(read_whole("/nonexistent").error_text(),
              testing::HasSubstr("/nonexistent: cannot be read: No such file"));
  EXPECT_FALSE(read_whole("/tmp").ok());
  std::size_t parts = 0;
  const auto bytes = read_parts(file.path(), [&](std::span<const char>) { return ++parts < 2; });
  EXPECT_EQ(parts, 2U);
  EXPECT_EQ(bytes.value(), std::size_t{2} << 18U);
}

TEST(ForeignKind, IsKnownByItsFirstBytes) {
  using std::string_view_literals::operator""sv;
  for (const auto& [head, name] :
       {std::pair{"%PDF-1.4"sv, "a PDF document"sv},
        std::pair{"SQLite format 3\0"sv, "an SQLite database"sv},
        std::pair{"RIFF\0\0"sv, "a RIFF file (WAV)"sv},
        std::pair{"\x7F"
                  "ELF\2"sv,
                  "a program"sv},
        std::pair{"\x89PNG\r\n"sv, "a picture"sv},
        std::pair{"\xFF\xD8\xFF\xE0"sv, "a picture"sv},
        std::pair{"\xFF\xFEt\0"sv, "UTF-16 text"sv},
        std::pair{"\xFE\xFF\0t"sv, "UTF-16 text"sv},
        std::pair{"{\"a\": 1}"sv, "JSON"sv},
        std::pair{" \n[ 1, 2]"sv, "JSON"sv},
        std::pair{"{}"sv, "JSON"sv},
        std::pair{"["sv, "JSON"sv},
        std::pair{"[[1"sv, "JSON"sv},
        std::pair{"[-1.5 , 2"sv, "JSON"sv},
        std::pair{"\xEF\xBB\xBF{\"a\""sv, "JSON"sv},
        std::pair{"<!DOCTYPE html>"sv, "a web page"sv},
        std::pair{"<HTML>"sv, "a web page"sv},
        std::pair{"<?xml version"sv, "XML"sv},
        std::pair{"VERSION \"\"\nBO_ 1 A: 8 B\n SG_ x"sv, "a DBC file"sv},
        std::pair{"[car]\nname"sv, "a configuration"sv},
        std::pair{"# x\n[input.can]"sv, "a configuration"sv}}) {
    const auto kind = foreign_kind(head);
    ASSERT_TRUE(kind) << head;
    EXPECT_EQ(kind->name, name);
    EXPECT_FALSE(kind->way_out.empty());
  }
  for (const std::string_view head : {"time_s,force_n\n"sv, "[12:00:01] text"sv, "{x"sv, "[x"sv,
                                      ""sv, "\nBO_ 1"sv, "<htm"sv, "%PD"sv})
    EXPECT_FALSE(foreign_kind(head)) << head;
}

}  // namespace
}  // namespace dampline::drivers
