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

}  // namespace
}  // namespace dampline::app
