// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "drivers/csv/reader.hpp"
#include "temporary_file.hpp"
#include "tests/shared_data.hpp"

namespace dampline::drivers {
namespace {
using test::TemporaryFile;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

struct Table {
  bool opened{false};
  std::vector<std::vector<double>> rows;
  hal::RowHealth health;
  Errc end{};
  std::string error;
  std::vector<std::string> ignored;
};

Table read_all(RowFileConfig config, std::string_view text) {
  const TemporaryFile file{text, ".csv"};
  config.path = file.path();
  Table table;
  auto reader = CsvReader::open(config);
  table.opened = reader.ok();
  table.error = reader.error_text();
  if (reader.ok()) {
    std::vector<double> some(3 * reader.value()->width() + 1);
    for (;;) {
      const auto count = reader.value()->read(some);
      if (!count.ok()) {
        table.end = count.error();
        break;
      }
      const auto width = static_cast<std::ptrdiff_t>(reader.value()->width());
      for (std::size_t i = 0; i < count.value(); ++i) {
        const auto first = some.begin() + static_cast<std::ptrdiff_t>(i) * width;
        table.rows.emplace_back(first, first + width);
      }
    }
    table.health = reader.value()->health();
    table.error = reader.value()->error_text();
    table.ignored = reader.value()->ignored_columns();
  }
  const std::size_t at = table.error.find(file.path());
  if (at != std::string::npos) table.error.replace(at, file.path().size(), "FILE");
  return table;
}

RowFileConfig rig() {
  RowFileConfig config;
  config.required = {"time_s", "deflection_m", "force_n"};
  return config;
}

TEST(CsvReader, ReadsColumnsByNameInTheOrderAskedFor) {
  const Table table =
      read_all(rig(), "force_n,note,time_s,deflection_m\n1.5,9,0,-2e-3\n2.5,9,0.1,3e-3\n");
  ASSERT_EQ(table.error, "");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(table.rows[0], ElementsAre(0.0, -2e-3, 1.5));
  EXPECT_THAT(table.rows[1], ElementsAre(0.1, 3e-3, 2.5));
  EXPECT_THAT(table.ignored, ElementsAre("note"));
  EXPECT_EQ(table.end, Errc::kEndOfStream);
  EXPECT_EQ(table.health.rows, 2U);
  EXPECT_EQ(table.health.line, 3U);
}

TEST(CsvReader, BearsWhatOtherProgramsWrite) {
  const Table table =
      read_all(rig(),
               "\xEF\xBB\xBF# recorded on a rig\r\n\r\n\"time_s\" , \"deflection_m\",force_n\r\n# "
               "units\r\n0,+1,\"2\"\r\n 1 , 2,3,\r\n");
  ASSERT_EQ(table.error, "");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_THAT(table.rows[0], ElementsAre(0.0, 1.0, 2.0));
  EXPECT_THAT(table.rows[1], ElementsAre(1.0, 2.0, 3.0));
  EXPECT_EQ(table.health.ignored, 1U);
}

TEST(CsvReader, FindsTheSeparator) {
  EXPECT_THAT(read_all(rig(), "time_s;deflection_m;force_n\n0;0,5;1,25e3\n").rows[0],
              ElementsAre(0.0, 0.5, 1250.0));
  EXPECT_THAT(read_all(rig(), "time_s\tdeflection_m\tforce_n\n0\t0.5\t1\n").rows[0],
              ElementsAre(0.0, 0.5, 1.0));
  EXPECT_THAT(read_all(rig(), "\"a,b;c\",time_s,deflection_m,force_n\n7,0,1,2\n").rows[0],
              ElementsAre(0.0, 1.0, 2.0));
}

TEST(CsvReader, TakesColumnsByOtherNames) {
  RowFileConfig config = rig();
  config.renamed = {{"deflection_m", "x_m"}, {"force_n", "F_N"}, {"time_s", "t_s"}};
  EXPECT_THAT(read_all(config, "t_s,x_m,F_N\n0,1,2\n").rows[0], ElementsAre(0.0, 1.0, 2.0));
}

TEST(CsvReader, GivesNanForAnEmptyCellAndForAColumnThatIsOptional) {
  RowFileConfig config = rig();
  config.optional = {"velocity_mps"};
  const Table table = read_all(config, "time_s,deflection_m,force_n\n0,,2\n");
  ASSERT_EQ(table.rows.size(), 1U);
  EXPECT_TRUE(std::isnan(table.rows[0][1]));
  EXPECT_EQ(table.rows[0][2], 2.0);
  EXPECT_TRUE(std::isnan(table.rows[0][3]));
}

TEST(CsvReader, KnowsWhichColumnsTheRecordHas) {
  const TemporaryFile file{"time_s,velocity_mps\n0,1\n"};
  auto reader = CsvReader::open(
      {.path = file.path(), .required = {"time_s"}, .optional = {"velocity_mps", "force_n"}});
  EXPECT_TRUE(reader.value()->has("velocity_mps"));
  EXPECT_FALSE(reader.value()->has("force_n"));
  EXPECT_FALSE(reader.value()->has("other"));
  EXPECT_THAT(header_of(file.path()).value(), ElementsAre("time_s", "velocity_mps"));
}

TEST(CsvReader, PassesNanAndInfinityOnAsSuch) {
  const Table table = read_all(rig(), "time_s,deflection_m,force_n\n0,nan,inf\n1,NaN,-Infinity\n");
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_TRUE(std::isnan(table.rows[0][1]));
  EXPECT_EQ(table.rows[0][2], std::numeric_limits<double>::infinity());
  EXPECT_EQ(table.rows[1][2], -std::numeric_limits<double>::infinity());
}

TEST(CsvReader, NamesTheMissingColumnAndThosePresent) {
  const Table table = read_all(rig(), "time_s,x_m,force_n\n0,1,2\n");
  EXPECT_FALSE(table.opened);
  EXPECT_EQ(table.error,
            "FILE: found no column \"deflection_m\", expected it among: time_s, x_m, force_n");
  RowFileConfig config = rig();
  config.renamed = {{"deflection_m", "pos"}};
  EXPECT_EQ(
      read_all(config, "time_s,x_m,force_n\n0,1,2\n").error,
      "FILE: found no column \"pos\" (for deflection_m), expected it among: time_s, x_m, force_n");
}

TEST(CsvReader, RefusesANameThatIsNotClear) {
  EXPECT_THAT(read_all(rig(), "time_s,deflection_m,force_n,force_n\n").error,
              HasSubstr("\"force_n\" stands twice"));
  RowFileConfig config = rig();
  config.renamed = {{"deflection_m", "x"}, {"force_n", "x"}};
  EXPECT_THAT(read_all(config, "time_s,x\n").error,
              HasSubstr("\"x\" is asked for as deflection_m and as force_n"));
}

TEST(CsvReader, ReportsFileLineAndColumnOfABadRow) {
  constexpr const char* kHead = "time_s,deflection_m,force_n\n0,1,2\n";
  const auto error = [&](const char* row) {
    return read_all(rig(), std::string{kHead} + row + "\n9,1,2\n").error;
  };
  EXPECT_EQ(error("1,1.5x,2"), "FILE:3:3: found \"1.5x\", expected a number for deflection_m");
  EXPECT_EQ(error("1,2"), "FILE:3:4: found 2 cells, expected 3");
  EXPECT_EQ(error("1,2,3,4"), "FILE:3:8: found 4 cells, expected 3");
  EXPECT_EQ(error("0,2,3"), "FILE:3:1: found time_s = 0, expected a time after 0");
  EXPECT_EQ(error("-1,2,3"), "FILE:3:1: found time_s = -1, expected a time after 0");
  EXPECT_EQ(error(",2,3"), "FILE:3:1: found time_s = nan, expected a time after 0");
  EXPECT_EQ(error("1,2,1e999"), "FILE:3:5: found \"1e999\", expected a number for force_n");
  EXPECT_EQ(error("1,--2,3"), "FILE:3:3: found \"--2\", expected a number for deflection_m");
}

TEST(CsvReader, DeliversTheRowsBeforeABadOneAndStaysStopped) {
  const TemporaryFile file{"time_s\n0\n1\nx\n3\n"};
  auto reader = CsvReader::open({.path = file.path(), .required = {"time_s"}});
  std::array<double, 10> rows{};
  EXPECT_EQ(reader.value()->read(rows).value(), 2U);
  EXPECT_EQ(reader.value()->read(rows).error(), Errc::kMalformed);
  EXPECT_EQ(reader.value()->read(rows).error(), Errc::kMalformed);
}

TEST(CsvReader, FillsTheRoomThatThereIs) {
  const TemporaryFile file{"time_s,deflection_m,force_n\n0,1,2\n1,2,3\n2,3,4\n"};
  RowFileConfig config = rig();
  config.path = file.path();
  auto reader = CsvReader::open(config);
  std::array<double, 6> rows{};
  EXPECT_EQ(reader.value()->read({rows.data(), 2}).value(), 0U) << "less than a row";
  EXPECT_EQ(reader.value()->read({rows.data(), 3}).value(), 1U);
  EXPECT_EQ(reader.value()->read(rows).value(), 2U);
  EXPECT_EQ(rows[5], 4.0);
}

TEST(CsvReader, CountsBadRowsWhenAskedTo) {
  RowFileConfig config = rig();
  config.skip_bad_lines = true;
  const Table table =
      read_all(config, "time_s,deflection_m,force_n\n0,1,2\nx\n1,1\n0,3,3\n2,3,4\n");
  EXPECT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.health.malformed, 3U);
  EXPECT_EQ(table.end, Errc::kEndOfStream);
}

TEST(CsvReader, DropsALastLineWithoutItsEndAndSaysSo) {
  const Table table = read_all(rig(), "time_s,deflection_m,force_n\n0,1,2\n1,1,22");
  EXPECT_EQ(table.rows.size(), 1U);
  EXPECT_TRUE(table.health.truncated);
  EXPECT_FALSE(read_all(rig(), "time_s,deflection_m,force_n\n0,1,2\n").health.truncated);
}

TEST(CsvReader, RefusesFilesOfAnotherKind) {
  EXPECT_THAT(read_all(rig(), "").error,
              HasSubstr("FILE: found nothing: it is empty, expected a header line"));
  EXPECT_THAT(read_all(rig(), "# only\n\n").error, HasSubstr("it is empty"));
  EXPECT_THAT(read_all(rig(), "(1631416514.736052) can0 0D0#A8FF\n").error,
              HasSubstr("found a candump log beginning"));
  EXPECT_THAT(read_all(rig(), std::string_view{"\x7F"
                                               "ELF\x02\0\0\n,\n",
                                               10})
                  .error,
              HasSubstr("found binary data"));
  EXPECT_THAT(read_all(rig(), "0,1,2\n1,1,2\n").error, HasSubstr("expected it among: 1, 2, 3"));
  EXPECT_THAT(read_all(rig(), "time_s,deflection_m,force_n\n").error,
              HasSubstr("a header but no row"));
  EXPECT_THAT(CsvReader::open({.path = "/nonexistent.csv"}).error_text(),
              HasSubstr("/nonexistent.csv: cannot be opened"));
}

TEST(CsvReader, BearsRandomCorruption) {
  std::string good = "time_s,deflection_m,force_n\n";
  for (int i = 0; i < 1000; ++i) good += fmt::format("{},{},{}\n", i * 0.01, i * 1e-5, 100 - i);
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::mt19937 random{seed};
    std::string text = good;
    for (std::size_t i = 28; i < text.size(); ++i) {
      if (random() % 100 < (seed % 2 == 0 ? 10 : 1)) text[i] = static_cast<char>(random());
    }
    RowFileConfig config = rig();
    config.skip_bad_lines = true;
    const Table table = read_all(config, text);
    const auto lines = static_cast<std::uint64_t>(std::count(text.begin() + 28, text.end(), '\n'));
    EXPECT_EQ(table.health.rows + table.health.malformed + table.health.ignored, lines) << seed;
    for (std::size_t i = 1; i < table.rows.size(); ++i)
      EXPECT_GT(table.rows[i][0], table.rows[i - 1][0]);
  }
}

TEST(CsvReader, TakesColumnsByNumberWhereThereIsNoHeader) {
  RowFileConfig config = rig();
  config.renamed = {{"time_s", "3"}, {"deflection_m", "1"}, {"force_n", "2"}};
  const auto bare = read_all(config, "0.1 5 1.0\n0.2 6 2.0\n");
  ASSERT_EQ(bare.rows.size(), 2U) << bare.error;
  EXPECT_THAT(bare.rows[1], ElementsAre(2.0, 0.2, 6.0));
  const auto named = read_all(config, "x,y,t\n0.1,5,1.0\n0.2,6,2.0\n");
  ASSERT_EQ(named.rows.size(), 2U) << named.error;
  EXPECT_THAT(named.rows[1], ElementsAre(2.0, 0.2, 6.0));
  config.renamed["force_n"] = "4";
  EXPECT_THAT(read_all(config, "0.1 5 1.0\n0.2 6 2.0\n").error,
              HasSubstr("expected it among: 1, 2, 3"));
}

TEST(CsvReader, ReadsColumnsBetweenBlanks) {
  const auto out = read_all(rig(), "  time_s  deflection_m   force_n \n  0.0  1e-3 5\n 0.1 -  6\n");
  ASSERT_EQ(out.rows.size(), 2U) << out.error;
  EXPECT_EQ(out.rows[0][1], 1e-3);
  EXPECT_EQ(out.rows[1][2], 6.0);
}

TEST(CsvReader, TakesDatesAsTime) {
  const auto out = read_all(rig(),
                            "time_s,deflection_m,force_n\n2024-02-29T23:59:59.750Z,1,5\n"
                            "2024-03-01 00:00:00.001,2,6\n2024-03-01T01:00:01+01:00,3,7\n");
  ASSERT_EQ(out.rows.size(), 3U) << out.error;
  EXPECT_EQ(out.rows[0][0], 0.0);
  EXPECT_NEAR(out.rows[1][0], 0.251, 1e-12);
  EXPECT_NEAR(out.rows[2][0], 1.25, 1e-12);
  EXPECT_THAT(read_all(rig(), "time_s,deflection_m,force_n\n2024-02-30T00:00:00,1,5\n").error,
              HasSubstr("found \"2024-02-30T00:00:00\", expected a number for time_s"));
}

TEST(CsvReader, PassesOverWhatDevicesWriteBeforeTheHeader) {
  const std::string preamble =
      "Catman export\nJob;Damper 7\nSample rate [Hz];300\n\nOperator;A;B\n";
  const auto plain =
      read_all(rig(), preamble + "time_s;deflection_m;force_n\n0,0;1,5;5\n0,1;2,5;6\n0,2;3,5;7\n");
  ASSERT_EQ(plain.rows.size(), 3U) << plain.error;
  EXPECT_EQ(plain.rows[0][1], 1.5);
  const auto units =
      read_all(rig(), preamble + "time_s;deflection_m;force_n\ns;m;N\n0,0;1,5;5\n0,1;2,5;6\n");
  EXPECT_EQ(units.rows.size(), 2U) << units.error;
}

TEST(CsvReader, FindsTheHeaderBelowOneLineAndByItsRowsSeparator) {
  const auto one = read_all(rig(), "Damper 7\ntime_s;deflection_m;force_n\n0;1;5\n1;2;6\n");
  ASSERT_EQ(one.rows.size(), 2U) << one.error;
  EXPECT_EQ(one.health.ignored, 1U);
  RowFileConfig config = rig();
  config.renamed = {{"force_n", "force_n, left, filtered, 2"}};
  const auto commas =
      read_all(config, "a\nb\ntime_s;deflection_m;force_n, left, filtered, 2\n0;1;5\n1;2;6\n");
  ASSERT_EQ(commas.rows.size(), 2U) << commas.error;
  EXPECT_THAT(commas.rows[1], ElementsAre(1.0, 2.0, 6.0));
}

TEST(CsvReader, PassesOverUnitsThatAreShortOrInBrackets) {
  const std::string head = "a;b\ntime_s;deflection_m;force_n\n";
  const std::string rows = "0;1;5\n1;2;6\n";
  EXPECT_EQ(read_all(rig(), head + "[seconds];(millimetres);N\n" + rows).rows.size(), 2U);
  EXPECT_EQ(read_all(rig(), head + "s;m/s^2;N\n" + rows).rows.size(), 2U);
  EXPECT_EQ(read_all(rig(), "time_s;deflection_m;force_n\nm;N\n" + rows).rows.size(), 0U)
      << "not one for each column";
  EXPECT_THAT(read_all(rig(), head + "seconds;metres;N\n" + rows).error,
              HasSubstr("expected it among: seconds, metres, N"))
      << "names, of which the last line counts";
}

TEST(CsvReader, TakesOneRowForARecordAndTwoNumbersForNoHeader) {
  const auto one = read_all(rig(), "time_s,deflection_m,force_n\n0,1,2\n");
  EXPECT_EQ(one.rows.size(), 1U);
  EXPECT_EQ(one.end, Errc::kEndOfStream);
  RowFileConfig config;
  config.required = {"time_s"};
  config.renamed = {{"time_s", "2"}};
  EXPECT_EQ(read_all(config, "5,1\n6,2\n").rows.size(), 2U);
}

TEST(CsvReader, APreambleMayHoldARowThatIsNone) {
  const auto out = read_all(rig(), "file;7\n;3\n\ntime_s;deflection_m;force_n\n0;1;5\n1;2;6\n");
  ASSERT_EQ(out.rows.size(), 2U) << out.error;
}

TEST(CsvReader, ReadsTheMeasuredRigRecords) {
  const auto path = test::shared_data() / "emps" / "emps_train.csv";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "measured data not found: " << path;
  auto reader = CsvReader::open({.path = path.string(),
                                 .required = {"time_s", "deflection_m"},
                                 .renamed = {{"time_s", "t"}, {"deflection_m", "qm"}}});
  ASSERT_TRUE(reader.ok()) << reader.error_text();
  std::vector<double> rows(2 * 30000);
  EXPECT_EQ(reader.value()->read(rows).value(), 24841U);
  EXPECT_EQ(reader.value()->read(rows).error(), Errc::kEndOfStream);
  EXPECT_EQ(rows[2], 0.001);
  EXPECT_EQ(rows[3], 1.43e-05);
}

TEST(CsvReader, AColumnMayBeAskedForByItsNumber) {
  const auto column = [](const std::string& name) {
    RowFileConfig config;
    config.required = {"x"};
    config.renamed = {{"x", name}};
    return read_all(config, "a,b,c,d,e,f,g,h,i,j,k,12\n1,2,3,4,5,6,7,8,9,10,11,120\n");
  };
  for (const int number : {1, 9, 10, 11})
    EXPECT_THAT(column(std::to_string(number)).rows, ElementsAre(ElementsAre(number)));
  EXPECT_THAT(column("12").rows, ElementsAre(ElementsAre(120.0))) << "a name";
  for (const char* none : {"0", "13", "A", "-1"})
    EXPECT_THAT(column(none).error, HasSubstr("found no column")) << none;
}

Table times(const std::vector<double>& times_s, bool skip) {
  std::string text = "time_s\n";
  for (const double time_s : times_s) text += fmt::format("{}\n", time_s);
  RowFileConfig config;
  config.required = {"time_s"};
  config.skip_bad_lines = skip;
  return read_all(config, text);
}

TEST(CsvReader, ARecordIsShorterThanTenYears) {
  EXPECT_EQ(times({5.0, 3.19999e8}, false).rows.size(), 2U);
  EXPECT_THAT(times({5.0, 3.2e8 + 5.0}, false).error, HasSubstr("expected a time after 5"));
  EXPECT_THAT(times({5.0, 5.0}, false).error, HasSubstr("found time_s = 5, expected a time after"));
}

// Where bad lines are skipped a time that is a minute ahead may be one: 16 of them wait for a 17th.
TEST(CsvReader, APauseIsNotABadTime) {
  const auto after = [](double gap_s, int rows) {
    std::vector<double> all{0.0, 1.0};
    for (int i = 0; i < rows; ++i) all.push_back(1.0 + gap_s + i);
    return times(all, true);
  };
  EXPECT_EQ(after(59.9, 1).rows.size(), 3U);
  EXPECT_EQ(after(60.0, 1).rows.size(), 2U);
  EXPECT_EQ(after(60.0, 1).health.malformed, 1U);
  EXPECT_EQ(after(1000.0, 16).rows.size(), 2U);
  EXPECT_EQ(after(1000.0, 16).health.malformed, 16U);
  EXPECT_EQ(after(1000.0, 17).rows.size(), 3U);
  EXPECT_EQ(after(1000.0, 30).rows.size(), 16U);
  std::vector<double> apart{0.0, 1.0};
  for (int i = 1; i < 40; ++i) apart.push_back(1000.0 * i);
  EXPECT_EQ(times(apart, true).rows.size(), 2U) << "far from one another they are no record";
  std::vector<double> between{0.0};
  for (int i = 1; i < 40; ++i) {
    between.push_back(1e6 + i);
    between.push_back(i);
  }
  EXPECT_EQ(times(between, true).rows.size(), 40U) << "the record goes on between them";
}

}  // namespace
}  // namespace dampline::drivers
