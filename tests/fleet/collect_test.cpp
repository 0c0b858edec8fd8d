// SPDX-License-Identifier: MIT
// `dampline collect`: the newest state of each segment in one database, which merges to the same
// bytes as the files.
#include <nlohmann/json.hpp>
#include <random>

#include "tests/fleet/segments.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class Collect : public SegmentsTest {
 protected:
  json collect(const std::string& sources) const {
    const auto outcome = program_.run("collect --db fleet.sqlite --json " + sources);
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    return json::parse(outcome.output);
  }
  /// What sqlite3 answers.
  std::string ask(const std::string& sql) const {
    const auto outcome = shell("sqlite3 -csv fleet.sqlite \"" + sql + "\"");
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    return outcome.output;
  }
};

TEST_F(Collect, MergesToTheBytesOfTheFiles) {
  constexpr std::size_t kSegments = 6;
  make_logs(kSegments);
  std::vector<std::string> runs = identify_logs(kSegments);
  // An earlier state of the last segment, and a car of its own.
  const std::string log = program_.read("logs/part5.log");
  program_.write("half.log", log.substr(0, log.find('\n', log.size() / 2) + 1));
  expect_success("identify half.log --quiet --no-report --out half");
  runs.emplace_back("half");
  std::mt19937 random{3};
  for (int round = 0; round < 4; ++round) {
    std::shuffle(runs.begin(), runs.end(), random);
    std::filesystem::remove(program_.path("fleet.sqlite"));
    for (const std::string& run : runs) static_cast<void>(collect(run));
    const json again = collect(words(runs));
    EXPECT_EQ(again.at("states_new"), 0);
    EXPECT_EQ(again.at("states_later"), 0);
    EXPECT_EQ(again.at("states_known"), runs.size());
    EXPECT_EQ(again.at("segments"), kSegments);
    EXPECT_TRUE(merged_bytes("fleet.sqlite --jobs 3") == merged_bytes(words(runs))) << round;
  }
}

TEST_F(Collect, AnswersInSql) {
  make_logs(2);
  identify_logs(2);
  const auto named = [](const char* car) {
    return [car](StateAbout& about, Statistics&) { about.segment.vehicle = car; };
  };
  std::filesystem::create_directories(program_.path("spool"));
  rewrite("r0/state.dls", "spool/a.dls", named("it's"));
  rewrite("r1/state.dls", "spool/b.dls", named("it's"));
  rewrite("r1/state.dls", "spool/c.dls", named("B"));
  EXPECT_EQ(collect("spool").at("states_new"), 3);
  EXPECT_EQ(ask("select vehicle, segments, last_contact_utc from truck"),
            "B,1,\"2023-11-14 22:15:19\"\n\"it's\",2,\"2023-11-14 22:15:19\"\n");
  EXPECT_EQ(ask("select vehicle, month, segments, round(hours, 2) from month where vehicle = 'B'"),
            "B,2023-11,1,0.02\n");
  const double level = std::stod(ask("select coulomb_n from month where vehicle = 'B'"));
  EXPECT_DOUBLE_EQ(level, about_of("r1/state.dls").coulomb_n.value);
  const auto by = program_.run("merge fleet.sqlite --by vehicle --no-report --quiet --out by");
  EXPECT_EQ(by.code, 0) << by.error;
  EXPECT_TRUE(program_.exists("by/it's/run.toml"));
}

TEST_F(Collect, RefusesWhatIsNoStateAndGoesOn) {
  make_logs(1);
  identify_logs(1);
  std::filesystem::create_directories(program_.path("spool"));
  const std::string state = program_.read("r0/state.dls");
  program_.write("spool/good.dls", state);
  program_.write("spool/half.dls", state.substr(0, state.size() / 2));
  program_.write("spool/.partial-3.dls", "what is being written");
  const auto outcome = program_.run("collect --db fleet.sqlite spool");
  EXPECT_EQ(outcome.code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("1 new, 0 later, 0 known; 1 segments in fleet.sqlite"));
  EXPECT_THAT(outcome.error, HasSubstr("refused: spool/half.dls: is cut off"));
  EXPECT_THAT(ask("select reason from refused"), HasSubstr("is cut off"));
  program_.write("no.sqlite", "is no database");
  EXPECT_EQ(program_.run("collect --db no.sqlite spool").code, 1);
}

TEST_F(Collect, KilledAnywhereLosesNothing) {
  make_logs(1);
  identify_logs(1);
  std::filesystem::create_directories(program_.path("spool"));
  for (int i = 0; i < 150; ++i)
    rewrite("r0/state.dls", fmt::format("spool/{}.dls", i), [i](StateAbout& about, Statistics&) {
      about.segment.vehicle = fmt::format("car{}", i);
    });
  for (const char* after : {"0.02", "0.05", "0.1"})
    static_cast<void>(program_.run("collect --db fleet.sqlite --quiet spool",
                                   fmt::format("timeout -s KILL {}", after)));
  EXPECT_EQ(collect("spool").at("segments"), 150);
  EXPECT_EQ(ask("pragma integrity_check"), "ok\n");
}

/// A fleet of light states: of three cars, two loads, 40 days; some earlier states, one faulty, one
/// that names what no database can hold.
class CollectFleet : public Collect {
 protected:
  void SetUp() override {
    make_logs(1);
    identify_logs(1);
    std::filesystem::create_directories(program_.path("spool"));
    const auto sums = std::make_unique<Statistics>();
    const StateAbout first = load_state(program_.path("r0/state.dls"), *sums);
    for (int i = 0; i < kStates; ++i) {
      StateAbout about = first;
      about.segment.vehicle = fmt::format("car {}", i % 3);
      about.segment.start_ns += (i / 6) * kDayNs + i % 2;
      about.end_ns += (i / 6) * kDayNs + i % 2;
      about.load = i % 2 == 0 ? "laden" : "empty";
      about.coulomb_n.value += 10.0 * (i / 6) + 7.0 * (i % 5);
      if (i == 17) about.trust = Trust::kDataFaulty;
      if (i % 6 == 1) about.alarms = "coulomb_below";
      write_state(i, "", about, *sums);
      about.sequence /= 2;
      about.coulomb_n.value = -1.0;
      if (i % 9 == 0) write_state(i, "earlier", about, *sums);
    }
    StateAbout foreign = first;
    foreign.segment.vehicle = "\xED\xA0\x80";  // a surrogate
    write_state(kStates, "", foreign, *sums);
  }
  void write_state(int i, const char* more, const StateAbout& about, const Statistics& sums) const {
    program_.write(fmt::format("spool/{}{}.dls", i, more),
                   encode_state(sums, about, StateKind::kLight));
  }
  std::string csv(const std::string& more) const {
    const auto outcome = program_.run("fleet --db fleet.sqlite --csv " + more);
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    return outcome.output;
  }
  /// Numbers to nine digits.
  static std::string rounded(const std::string& table) {
    std::string out;
    std::string cell;
    for (const char c : table) {
      if (c != ',' && c != '\n') {
        cell += c;
        continue;
      }
      char* end = nullptr;
      const double number = std::strtod(cell.c_str(), &end);
      out += !cell.empty() && *end == '\0' ? fmt::format("{:.9g}", number) : cell;
      out += c;
      cell.clear();
    }
    return out;
  }
  static constexpr int kStates = 240;
  static constexpr std::int64_t kDayNs = 86'400'000'000'000;
};

TEST_F(CollectFleet, KeepsTrendsAsTheirRowsSay) {
  // In parts and in another order, the later state before the earlier one and behind it.
  const auto part = [&](const char* pattern) {
    const auto outcome =
        program_.run(fmt::format("collect --db fleet.sqlite --quiet spool/{}", pattern));
    EXPECT_EQ(outcome.code, 0) << outcome.error;
  };
  for (const char* pattern : {"*7.dls", "1*.dls", "*earlier.dls"}) part(pattern);
  EXPECT_EQ(collect("spool").at("segments"), kStates);
  EXPECT_THAT(ask("select reason from refused"), HasSubstr(R"(\xED\xA0\x80)"));
  const std::string kept = csv("trend");
  EXPECT_EQ(std::count(kept.begin(), kept.end(), '\n'), 1 + 6);
  EXPECT_TRUE(kept == csv("trend --renew")) << "recomputed";
  const auto number = [&](const char* column) {
    return std::stod(ask(
        fmt::format("select {} from trend where vehicle = 'car 0' and load = 'laden'", column)));
  };
  // 10 N a day, beside what the segments scatter.
  EXPECT_NEAR(number("trend_n_per_year"), 3652.5, 3.0 * number("trend_std_n_per_year"));
  EXPECT_LT(number("trend_std_n_per_year"), 200.0);
  EXPECT_NEAR(number("level_n") - number("mean_n"), 10.0 * (39 - 3) / 2.0, 15.0);
  EXPECT_EQ(ask("select cast(sum(segments) as bigint), cast(sum(faulty_segments) as bigint), "
                "sum(usable_segments) from trend"),
            "240,1,239\n");
}

TEST_F(CollectFleet, IsOnAServerWhatItIsInAFile) {
  if (!std::filesystem::exists("/usr/lib/postgresql/15/bin/initdb"))
    GTEST_SKIP() << "no postgresql-15";
  if (program_.run("collect --db postgresql:///none?host=/none spool").code == 2)
    GTEST_SKIP() << "built without libpq";
  static_cast<void>(collect("spool"));
  program_.write("script", R"sh(set -e
for after in .03 .06 .09 .15; do  # killed anywhere
  timeout -s KILL $after "$DAMPLINE" collect --db "$DAMPLINE_DB" --quiet spool || true
done
for i in 1 2; do  # two at once, in another order
  "$DAMPLINE" collect --db "$DAMPLINE_DB" --quiet $(ls -d spool/* | shuf --random-source=script) &
done 2>/dev/null
wait
"$DAMPLINE" collect --db "$DAMPLINE_DB" --json spool >collected.json
"$DAMPLINE" merge "$DAMPLINE_DB" --by vehicle,load --quiet --no-report --out on_server
for view in truck trend month segment figure norm outlier; do
  "$DAMPLINE" fleet --db "$DAMPLINE_DB_READ" --csv $view >$view.csv
done
! "$DAMPLINE" collect --db "$DAMPLINE_DB_READ" --quiet spool 2>denied
)sh");
  const auto outcome = shell("DAMPLINE='" DAMPLINE_BINARY_DIR
                             "/dampline' DAMPLINE_PG_FSYNC=off timeout 120 '" DAMPLINE_SOURCE_DIR
                             "/app/service/fleet/start' engine sh script");
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  const json collected = json::parse(program_.read("collected.json"));
  EXPECT_EQ(collected.at("states_new"), 0);
  EXPECT_EQ(collected.at("segments"), kStates);
  for (const char* view : {"trend", "segment", "figure", "norm", "outlier"})
    EXPECT_EQ(program_.read(fmt::format("{}.csv", view)), csv(view)) << view;
  for (const char* view : {"truck", "month"})  // whose sums have no order
    EXPECT_EQ(rounded(program_.read(fmt::format("{}.csv", view))), rounded(csv(view))) << view;
  EXPECT_THAT(program_.read("denied"), HasSubstr("permission denied"));
  expect_success("merge fleet.sqlite --by vehicle,load --quiet --no-report --out in_file");
  for (const char* group : {"car_0.laden", "car_2.empty"})
    EXPECT_TRUE(bytes_of(fmt::format("on_server/{}", group)) ==
                bytes_of(fmt::format("in_file/{}", group)))
        << group;
}

TEST_F(Collect, NamesNoPassword) {
  const auto outcome =
      program_.run("collect --db 'postgresql://me:secret@/dampline?host=/none&password=hidden' .");
  EXPECT_NE(outcome.code, 0);
  EXPECT_THAT(outcome.error, HasSubstr("postgresql://me:***@/dampline?host=/none&password=***"));
  EXPECT_THAT(outcome.error + outcome.output, testing::Not(HasSubstr("secret")));
  EXPECT_THAT(outcome.error + outcome.output, testing::Not(HasSubstr("hidden")));
}

}  // namespace
}  // namespace dampline::app
