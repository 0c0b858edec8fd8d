// SPDX-License-Identifier: MIT
// Arrays byte by byte, by NumPy Enhancement Proposal 1 and PKWARE's APPNOTE.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "drivers/npy/header.hpp"
#include "drivers/record/rows.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::drivers {
namespace {

using test::TemporaryFile;
using testing::ElementsAre;
using testing::HasSubstr;

template <class Number>
std::string stored(Number number, bool big_endian = false) {
  std::string out(sizeof number, '\0');
  std::memcpy(out.data(), &number, sizeof number);
  if (big_endian) std::reverse(out.begin(), out.end());
  return out;
}

/// `type`: what stands behind 'descr', in quotes or brackets.
std::string array_of(const std::string& type, const std::string& shape, const std::string& data,
                     bool by_column = false, int version = 1) {
  const std::string text = fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}\n",
                                       type, by_column ? "True" : "False", shape);
  std::string out = "\x93NUMPY" + std::string{static_cast<char>(version), '\0'};
  out += version == 1 ? stored(static_cast<std::uint16_t>(text.size()))
                      : stored(static_cast<std::uint32_t>(text.size()));
  return out + text + data;
}

std::string doubles(const std::vector<double>& numbers, bool big_endian = false) {
  std::string out;
  for (const double number : numbers) out += stored(number, big_endian);
  return out;
}

struct ReadRows {
  std::vector<std::string> header;
  std::vector<std::vector<double>> rows;
  std::string error;
  hal::RowHealth health{};
};
/// Every column of a file, by the names in its header.
ReadRows read_rows(const std::string& bytes) {
  const TemporaryFile file{bytes, ".npy"};
  ReadRows out;
  const auto header = header_of(file.path());
  out.error = header.error_text();
  if (!header) return out;
  out.header = header.value();
  auto rows = open_rows({.path = file.path(), .required = out.header, .time_column = "t"});
  out.error = rows.error_text();
  if (!rows) return out;
  std::vector<double> some(3 * out.header.size());
  auto read = rows.value()->read(some);
  for (; read.ok(); read = rows.value()->read(some)) {
    const auto width = static_cast<std::ptrdiff_t>(out.header.size());
    for (std::size_t i = 0; i < read.value(); ++i) {
      const auto from = some.begin() + static_cast<std::ptrdiff_t>(i) * width;
      out.rows.emplace_back(from, from + width);
    }
  }
  out.error = rows.value()->error_text();
  out.health = rows.value()->health();
  return out;
}

/// The only number of an array of one.
double number_of(const std::string& type, const std::string& data) {
  const ReadRows out = read_rows(array_of("'" + type + "'", "(1,)", data));
  EXPECT_EQ(out.rows.size(), 1U) << type << out.error;
  return out.rows.empty() ? 0.0 : out.rows[0][0];
}

TEST(NpyReader, ReadsEveryKindOfNumberInEitherByteOrder) {
  for (const bool big : {false, true}) {
    const std::string order = big ? ">" : "<";
    EXPECT_EQ(number_of(order + "f8", stored(-1.25e-9, big)), -1.25e-9);
    EXPECT_EQ(number_of(order + "f4", stored(0.375F, big)), 0.375);
    EXPECT_EQ(number_of(order + "i2", stored(std::int16_t{-300}, big)), -300.0);
    EXPECT_EQ(number_of(order + "i4", stored(std::int32_t{-70'000}, big)), -70'000.0);
    EXPECT_EQ(number_of(order + "i8", stored(std::int64_t{-5'000'000'000}, big)), -5e9);
    EXPECT_EQ(number_of(order + "u2", stored(std::uint16_t{65'000}, big)), 65'000.0);
    EXPECT_EQ(number_of(order + "u4", stored(std::uint32_t{4'000'000'000}, big)), 4e9);
    EXPECT_EQ(number_of(order + "u8", stored(~std::uint64_t{0}, big)), 18446744073709551615.0);
  }
  EXPECT_EQ(number_of("|i1", "\xFE"), -2.0);
  EXPECT_EQ(number_of("|u1", "\xFE"), 254.0);
  EXPECT_EQ(number_of("|b1", "\x01"), 1.0);
}

TEST(NpyReader, RefusesWhatIsNoNumber) {
  for (const char* type : {"<f2", "<f16", "<c16", "<U8", "|S3", "<i3", "|b2", "|O", "<m8[s]",
                           "<M8[D]", "<M4[s]", "<f8x", "f8", "<f", ""})
    EXPECT_THAT(read_rows(array_of(fmt::format("'{}'", type), "(1,)", std::string(16, '\0'))).error,
                HasSubstr("holds no numbers"))
        << type;
}

TEST(NpyReader, CountsTimesInSecondsFromTheFirst) {
  for (const auto& [unit, per_s] :
       {std::pair{"ns", std::int64_t{1'000'000'000}}, {"us", 1'000'000}, {"ms", 1000}, {"s", 1}}) {
    const std::int64_t begin = 1'700'000'000 * per_s;
    const std::string data = stored(begin) + stored(begin + 2 * per_s) + stored(begin + 7 * per_s);
    const ReadRows out = read_rows(array_of(fmt::format("'<M8[{}]'", unit), "(3,)", data));
    ASSERT_EQ(out.rows.size(), 3U) << unit << out.error;
    EXPECT_EQ(out.rows[0][0], 0.0);
    EXPECT_NEAR(out.rows[1][0], 2.0, 1e-6) << unit;
    EXPECT_NEAR(out.rows[2][0], 7.0, 1e-6) << unit;
  }
  const std::string none = stored(std::numeric_limits<std::int64_t>::min());
  const ReadRows out = read_rows(array_of("'<M8[s]'", "(2,)", stored(std::int64_t{5}) + none));
  ASSERT_EQ(out.rows.size(), 2U);
  EXPECT_TRUE(std::isnan(out.rows[1][0])) << "NaT";
}

TEST(NpyReader, ReadsRowsAndColumns) {
  const std::vector<std::vector<double>> rows{{1, 2}, {3, 4}, {5, 6}, {7, 8}};
  const std::string by_row = doubles({1, 2, 3, 4, 5, 6, 7, 8});
  const std::string by_column = doubles({1, 3, 5, 7, 2, 4, 6, 8});
  for (const int version : {1, 2, 3}) {
    const ReadRows out = read_rows(array_of("'<f8'", "(4, 2)", by_row, false, version));
    EXPECT_THAT(out.header, ElementsAre("1", "2")) << version << out.error;
    EXPECT_EQ(out.rows, rows) << version;
    EXPECT_FALSE(out.health.truncated);
    EXPECT_EQ(read_rows(array_of("'<f8'", "(4, 2)", by_column, true, version)).rows, rows);
  }
  EXPECT_EQ(read_rows(array_of("'<f8'", "(4,)", doubles({1, 2, 3, 4}), true)).rows.size(), 4U);
  EXPECT_THAT(read_rows(array_of("'<f8'", "(4, 2)", by_row, false, 4)).error,
              HasSubstr("is no NumPy array of version 1, 2 or 3"));
  EXPECT_THAT(read_rows(array_of("'<f8'", "(1, 2, 4)", by_row)).error,
              HasSubstr("more than two dimensions"));
  EXPECT_THAT(read_rows(array_of("'<f8'", "()", doubles({1}))).error, HasSubstr("single number"));
  EXPECT_THAT(read_rows(array_of("'<f8'", "(4, 0)", "")).error, HasSubstr("has no column"));
}

TEST(NpyReader, ReadsTheFieldsOfStructures) {
  const std::string data = stored(0.5) + stored(2.0F) + stored(std::int16_t{-3}) +  //
                           stored(1.5) + stored(4.0F) + stored(std::int16_t{6});
  const std::string type = "[('t', '<f8'), ('force_n', '<f4'), ('n', '<i2')]";
  for (const char* shape : {"(2,)", "(2, 1)"}) {
    const ReadRows out = read_rows(array_of(type, shape, data));
    EXPECT_THAT(out.header, ElementsAre("t", "force_n", "n")) << out.error;
    EXPECT_THAT(out.rows, ElementsAre(ElementsAre(0.5, 2.0, -3.0), ElementsAre(1.5, 4.0, 6.0)));
  }
  EXPECT_THAT(read_rows(array_of(type, "(1, 2)", data)).error, HasSubstr("several structures"));
  const std::string times = stored(std::int64_t{10}) + stored(std::int64_t{12});
  EXPECT_THAT(read_rows(array_of("[('t', '<M8[s]'),]", "(2,)", times)).rows,
              ElementsAre(ElementsAre(0.0), ElementsAre(2.0)))
      << "one field, whose unit is in brackets";
  EXPECT_THAT(read_rows(array_of("[('t', '<f8'), ('name', '<U8')]", "(1,)", data)).error,
              HasSubstr("holds no numbers"));
}

TEST(NpyReader, CutOffItGivesTheWholeRows) {
  const std::string whole = array_of("'<f8'", "(3, 2)", doubles({1, 2, 3, 4, 5, 6}));
  for (std::size_t cut = 1; cut <= 48; ++cut) {
    const ReadRows out = read_rows(whole.substr(0, whole.size() - cut));
    EXPECT_EQ(out.rows.size(), (48 - cut) / 16) << cut;
    EXPECT_TRUE(out.health.truncated || out.rows.empty()) << cut;
  }
  for (std::size_t size = 8; size < whole.size() - 48; ++size)
    EXPECT_THAT(read_rows(whole.substr(0, size)).error, HasSubstr("is cut off in its header"))
        << size;
}

TEST(NpyReader, TellsTheShareThatWasRead) {
  const TemporaryFile file{array_of("'<f8'", "(4,)", doubles({1, 2, 3, 4})), ".npy"};
  const auto rows = open_rows({.path = file.path(), .required = {"1"}});
  std::array<double, 1> row{};
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    ASSERT_TRUE(rows.value()->read(row).ok());
    EXPECT_EQ(rows.value()->share_read(), share);
  }
  const TemporaryFile none{array_of("'<f8'", "(0,)", ""), ".npy"};
  EXPECT_EQ(open_rows({.path = none.path(), .required = {"1"}}).value()->share_read(), 1.0);
}

TEST(NpyReader, ATimeThatGoesBackIsNamedByItsRow) {
  const ReadRows out = read_rows(array_of("[('t', '<f8')]", "(3,)", doubles({1, 2, 2})));
  EXPECT_EQ(out.rows.size(), 2U);
  EXPECT_THAT(out.error, HasSubstr("row 3: found t = 2, expected a time after 2"));
}

TEST(NpyReader, GoesOnBehindATimeThatGoesBackWhereItMay) {
  const TemporaryFile file{array_of("[('t', '<f8')]", "(4,)", doubles({1, 2, 2, 3})), ".npy"};
  auto rows = open_rows(
      {.path = file.path(), .required = {"t"}, .time_column = "t", .skip_bad_lines = true});
  std::array<double, 10> some{};
  ASSERT_EQ(rows.value()->read(some).value(), 3U);
  EXPECT_EQ(some[2], 3.0);
  EXPECT_EQ(rows.value()->health().malformed, 1U);
  EXPECT_EQ(rows.value()->health().line, 4U);
  EXPECT_EQ(rows.value()->read(some).error(), Errc::kEndOfStream);
  EXPECT_FALSE(rows.value()->health().truncated);
}

TEST(NpyReader, GivesWholeRowsOfTheColumnsThatAreAskedFor) {
  const std::string type = "[('t', '<f8'), ('a', '<f4'), ('b', '<i2')]";
  std::string data;
  for (int i = 0; i < 5; ++i)
    data += stored(1.0 * i) + stored(10.0F * static_cast<float>(i)) +
            stored(static_cast<std::int16_t>(-i));
  const TemporaryFile file{array_of(type, "(5,)", data), ".npy"};
  auto rows = open_rows(
      {.path = file.path(), .required = {"b", "t"}, .optional = {"none"}, .time_column = "t"});
  ASSERT_TRUE(rows.ok()) << rows.error_text();
  std::array<double, 8> some{};  // of three columns two rows
  ASSERT_EQ(rows.value()->read(some).value(), 2U);
  EXPECT_THAT(std::vector<double>(some.begin(), some.begin() + 2), ElementsAre(0.0, 0.0));
  EXPECT_TRUE(std::isnan(some[2]));
  EXPECT_THAT(std::vector<double>(some.begin() + 3, some.begin() + 5), ElementsAre(-1.0, 1.0));
  ASSERT_EQ(rows.value()->read(some).value(), 2U);
  ASSERT_EQ(rows.value()->read(some).value(), 1U);
  EXPECT_EQ(some[0], -4.0);
  EXPECT_EQ(rows.value()->read(some).error(), Errc::kEndOfStream);
}

TEST(NpyReader, EveryColumnOfTimesHasAZeroOfItsOwn) {
  const std::string type = "[('t', '<M8[s]'), ('u', '>M8[ms]')]";
  const ReadRows out =
      read_rows(array_of(type, "(2,)",
                         stored(std::int64_t{10}) + stored(std::int64_t{7000}, true) +
                             stored(std::int64_t{12}) + stored(std::int64_t{7500}, true)));
  EXPECT_THAT(out.rows, ElementsAre(ElementsAre(0.0, 0.0), ElementsAre(2.0, 0.5))) << out.error;
}

TEST(NpyReader, CutOffItGivesTheRowsWhoseColumnsAreAllThere) {
  const std::string whole = array_of("'<f8'", "(3, 2)", doubles({1, 2, 3, 4, 5, 6}), true);
  for (std::size_t cut = 1; cut < 48; ++cut) {
    const ReadRows out = read_rows(whole.substr(0, whole.size() - cut));
    EXPECT_EQ(out.rows.size(), cut < 24 ? (24 - cut) / 8 : 0U) << cut;
    if (!out.rows.empty()) {
      EXPECT_EQ(out.rows[0], (std::vector<double>{1.0, 4.0})) << cut;
      EXPECT_TRUE(out.health.truncated) << cut;
    }
  }
}

TEST(NpyReader, AHeaderNeedsNoBlanks) {
  for (const std::string text :
       {"{'descr':'<f8','fortran_order':False,'shape':(2,2)}",
        "{'shape':  ( 2 , 2 ),  'fortran_order':  False,  'descr':  '<f8'}"}) {
    const std::string header = "\x93NUMPY" + std::string{'\1', '\0'} +
                               stored(static_cast<std::uint16_t>(text.size())) + text;
    EXPECT_THAT(read_rows(header + doubles({1, 2, 3, 4})).rows,
                ElementsAre(ElementsAre(1.0, 2.0), ElementsAre(3.0, 4.0)))
        << text;
  }
}

TEST(NpyReader, SaysWhereAnArrayHasNoRow) {
  EXPECT_THAT(read_rows(array_of("'<f8'", "(0,)", "")).error, HasSubstr("holds no whole row"));
  EXPECT_THAT(read_rows(array_of("'<f8'", "(2,)", "abc")).error, HasSubstr("holds no whole row"));
  EXPECT_EQ(read_rows(array_of("'<f8'", "(1,)", doubles({1}))).error, "");
}

TEST(NpyReader, HasUpTo1024Columns) {
  const auto array = [](std::size_t columns, bool fields) {
    std::string type;
    for (std::size_t c = 0; fields && c < columns; ++c) type += fmt::format("('f{}', '<f8'), ", c);
    return array_of(fields ? "[" + type.substr(0, type.size() - 2) + "]" : "'<f8'",
                    fields ? "(1,)" : fmt::format("(1, {})", columns),
                    doubles(std::vector<double>(columns, 2.5)));
  };
  for (const bool fields : {false, true}) {
    const ReadRows out = read_rows(array(1024, fields));
    ASSERT_EQ(out.rows.size(), 1U) << out.error;
    EXPECT_EQ(out.rows[0], std::vector<double>(1024, 2.5));
    EXPECT_THAT(read_rows(array(1025, fields)).error,
                HasSubstr(fields ? "holds no numbers" : "more than 1024"));
  }
}

// A header of 64 KiB and no longer.
TEST(NpyReader, AHeaderMayBePadded) {
  const auto padded = [](std::size_t length, int version) {
    std::string text = "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }";
    text.resize(length, ' ');
    std::string out = "\x93NUMPY" + std::string{static_cast<char>(version), '\0'};
    out += version == 1 ? stored(static_cast<std::uint16_t>(length))
                        : stored(static_cast<std::uint32_t>(length));
    return out + text + stored(0.5);
  };
  EXPECT_EQ(read_rows(padded(65'535, 1)).rows.size(), 1U);
  EXPECT_EQ(read_rows(padded(65'536, 2)).rows.size(), 1U);
  EXPECT_THAT(read_rows(padded(65'537, 2)).error, HasSubstr("is cut off in its header"));
  std::string none = padded(100, 1);
  none[6] = 0;
  EXPECT_THAT(read_rows(none).error, HasSubstr("is no NumPy array of version 1, 2 or 3"));
}

/// A zip file, as NumPy's savez writes it.
class Archive {
 public:
  void add(const std::string& name, const std::string& content, bool deflate = false,
           bool wide = false) {
    const std::string packed = deflate ? deflated(content) : content;
    const auto size = [&](std::size_t bytes) {
      return stored(wide ? 0xFFFFFFFFU : static_cast<std::uint32_t>(bytes));
    };
    const std::string common = stored(std::uint16_t{0}) +
                               stored(static_cast<std::uint16_t>(deflate ? 8 : 0)) +
                               std::string(8, '\0') + size(packed.size()) + size(content.size()) +
                               stored(static_cast<std::uint16_t>(name.size()));
    const std::string extra = wide ? stored(std::uint16_t{7}) + stored(std::uint16_t{2}) + "ab" +
                                         stored(std::uint16_t{1}) + stored(std::uint16_t{24}) +
                                         stored(std::uint64_t{content.size()}) +
                                         stored(std::uint64_t{packed.size()}) +
                                         stored(std::uint64_t{bytes_.size()})
                                   : std::string{};
    directory_ += "PK\x01\x02" + stored(std::uint16_t{20}) + stored(std::uint16_t{20}) + common +
                  stored(static_cast<std::uint16_t>(extra.size())) + stored(std::uint16_t{3}) +
                  std::string(8, '\0') + size(bytes_.size()) + name + extra + "end";
    bytes_ += "PK\x03\x04" + stored(std::uint16_t{20}) + common + stored(std::uint16_t{4}) + name +
              "more" + packed;
    ++count_;
  }
  [[nodiscard]] std::string bytes(bool wide = false, const std::string& note = "a note") const {
    std::string end;
    if (wide) {
      const std::size_t at = bytes_.size() + directory_.size();
      end = "PK\x06\x06" + stored(std::uint64_t{44}) + std::string(12, '\0') +
            stored(std::uint64_t{count_}) + stored(std::uint64_t{count_}) +
            stored(std::uint64_t{directory_.size()}) + stored(std::uint64_t{bytes_.size()}) +
            "PK\x06\x07" + std::string(4, '\0') + stored(std::uint64_t{at}) + std::string(4, '\0');
    }
    return bytes_ + directory_ + end + "PK\x05\x06" + std::string(4, '\0') + stored(count_) +
           stored(count_) + stored(static_cast<std::uint32_t>(directory_.size())) +
           stored(wide ? 0xFFFFFFFFU : static_cast<std::uint32_t>(bytes_.size())) +
           stored(static_cast<std::uint16_t>(note.size())) + note;
  }

 private:
  static std::string deflated(const std::string& text) {
    z_stream state{};
    ::deflateInit2(&state, 6, Z_DEFLATED, -15, 8, Z_DEFAULT_STRATEGY);
    std::string out(::deflateBound(&state, text.size()), '\0');
    state.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
    state.avail_in = static_cast<uInt>(text.size());
    state.next_out = reinterpret_cast<Bytef*>(out.data());
    state.avail_out = static_cast<uInt>(out.size());
    ::deflate(&state, Z_FINISH);
    out.resize(state.total_out);
    ::deflateEnd(&state);
    return out;
  }
  std::string bytes_;
  std::string directory_;
  std::uint16_t count_{0};
};

TEST(NpyReader, TakesTheLongestArraysOfAnArchiveAsColumns) {
  for (const bool deflate : {false, true}) {
    for (const bool wide : {false, true}) {
      Archive archive;
      archive.add("t.npy", array_of("'<f8'", "(3,)", doubles({0, 1, 2})), deflate, wide);
      archive.add("rate.npy", array_of("'<f8'", "()", doubles({300})), deflate, wide);
      archive.add("notes.txt", "no array", deflate, wide);
      archive.add("short.npy", array_of("'<f8'", "(2,)", doubles({8, 9})), deflate, wide);
      archive.add("a.npy",
                  array_of("'<f4'", "(3, 2)",
                           stored(1.0F) + stored(2.0F) + stored(3.0F) + stored(4.0F) +
                               stored(5.0F) + stored(6.0F)),
                  deflate, wide);
      const ReadRows out = read_rows(archive.bytes(wide));
      EXPECT_THAT(out.header, ElementsAre("t", "a_1", "a_2")) << deflate << wide << out.error;
      EXPECT_THAT(out.rows, ElementsAre(ElementsAre(0.0, 1.0, 2.0), ElementsAre(1.0, 3.0, 4.0),
                                        ElementsAre(2.0, 5.0, 6.0)));
    }
  }
}

// NumPy writes no comment at an archive's end; 64 KiB are the longest.
TEST(NpyReader, AnArchiveMayHaveACommentOrNone) {
  Archive archive;
  archive.add("t.npy", array_of("'<f8'", "(3,)", doubles({0, 1, 2})));
  for (const std::size_t length : {0U, 1U, 65'535U})
    EXPECT_EQ(read_rows(archive.bytes(false, std::string(length, '.'))).rows.size(), 3U) << length;
}

TEST(NpyReader, ReadsTheFirst1024MembersOfAnArchive) {
  for (const auto& [others, rows] : {std::pair{1022, 3U}, std::pair{1023, 2U}}) {
    Archive archive;
    archive.add("short.npy", array_of("'<f8'", "(2,)", doubles({0, 1})));
    for (int i = 0; i < others; ++i) archive.add("notes.txt", "no array");
    archive.add("long.npy", array_of("'<f8'", "(3,)", doubles({0, 1, 2})));
    EXPECT_EQ(read_rows(archive.bytes()).rows.size(), rows) << others;
  }
}

// By columns an array is read in several places at once, which a deflated one cannot be.
TEST(NpyReader, LeavesOutADeflatedArrayThatLiesByColumns) {
  const std::string by_column = array_of("'<f8'", "(2, 2)", doubles({1, 3, 2, 4}), true);
  Archive deflated;
  deflated.add("a.npy", by_column, true);
  EXPECT_THAT(read_rows(deflated.bytes()).error, HasSubstr("holds no array of numbers"));
  Archive plain;
  plain.add("b.npy", array_of("'<f8'", "(2,)", doubles({8, 9})), true);
  plain.add("a.npy", by_column);
  const ReadRows out = read_rows(plain.bytes());
  EXPECT_THAT(out.header, ElementsAre("b", "a_1", "a_2"));
  EXPECT_THAT(out.rows, ElementsAre(ElementsAre(8.0, 1.0, 2.0), ElementsAre(9.0, 3.0, 4.0)));
}

TEST(NpyReader, SaysWhatIsWrongWithAnArchive) {
  Archive archive;
  archive.add("t.npy", array_of("'<f8'", "(3,)", doubles({0, 1, 2})));
  const std::string whole = archive.bytes();
  EXPECT_EQ(read_rows(whole).rows.size(), 3U);
  EXPECT_THAT(read_rows(whole.substr(0, whole.size() - 10)).error,
              HasSubstr("found no directory of its arrays"));
  std::string moved = whole;
  moved[whole.find("PK\x01\x02") + 42] = 3;
  EXPECT_THAT(read_rows(moved).error, HasSubstr("found no array where its directory says"));
  Archive wide;
  wide.add("t.npy", array_of("'<f8'", "(3,)", doubles({0, 1, 2})), false, true);
  EXPECT_EQ(read_rows(wide.bytes()).rows.size(), 3U);
  for (std::uint32_t missing = 1; missing < 40; ++missing) {
    std::string cut = wide.bytes();
    const std::size_t end = cut.rfind("PK\x05\x06");
    std::uint32_t size = 0;
    std::memcpy(&size, &cut[end + 12], sizeof size);
    size -= missing;
    std::memcpy(&cut[end + 12], &size, sizeof size);
    EXPECT_THAT(read_rows(cut).error, HasSubstr("holds no array of numbers")) << missing;
  }
  std::string longer = wide.bytes();
  longer.replace(longer.rfind(std::string{"\7\0\2\0ab", 6}) + 2, 2, "\xFF\xFF");
  EXPECT_THAT(read_rows(longer).error, HasSubstr("found no array where its directory says"))
      << "a field beyond the end of the others";
  Archive empty;
  empty.add("a.npy", array_of("'<U8'", "(1,)", std::string(32, '\0')));
  EXPECT_THAT(read_rows(empty.bytes()).error, HasSubstr("holds no array of numbers"));
}

}  // namespace
}  // namespace dampline::drivers
