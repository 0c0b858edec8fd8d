// SPDX-License-Identifier: MIT
// `dampline archive`: resumable, and the same bytes by threads, parts, MPI's ranks and Slurm's
// tasks.
#include <nlohmann/json.hpp>
#include <random>

#include "tests/fleet/segments.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::size_t kLogs = 9;

class Archive : public SegmentsTest {
 protected:
  void SetUp() override {
    make_logs(kLogs, "", "logs/4711/front/part");
    program_.write("logs/4711/front/noise.log", "neither frames nor rows\n");
    program_.write("logs/4711/front/empty.csv", "");
    program_.write("logs/readme.md", "is no record\n");
  }
  std::string arguments(const std::string& out) const {
    return "archive logs --no-report --folders vehicle/truck --out " + out + " ";
  }
  /// Of one process and one thread.
  std::string expected() const {
    expect_success(arguments("alone") + "--quiet --jobs 1");
    return bytes_of("alone/merged");
  }
  std::size_t states_in(const std::string& out) const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator{program_.path(out + "/states")})
      if (entry.path().extension() == ".dls") ++count;
    return count;
  }
  bool has_program(const std::string& name) const { return shell("command -v " + name).code == 0; }
};

TEST_F(Archive, MakesEachStateOnce) {
  const json first = json::parse(program_.run(arguments("a") + "--json").output);
  EXPECT_EQ(first.at("logs"), kLogs + 2);
  EXPECT_EQ(first.at("states_made"), kLogs);
  EXPECT_EQ(first.at("set_aside").size(), 2U);
  EXPECT_THAT(first.at("set_aside").at(0).at("reason"), HasSubstr("empty.csv: is empty"));
  EXPECT_EQ(states_in("a"), kLogs);
  const StateAbout about = about_of("a/merged/state.dls");
  EXPECT_EQ(about.segment.vehicle, "4711");
  EXPECT_EQ(about.segment.truck, "front");
  EXPECT_EQ(about.segments, kLogs);
  const std::string bytes = bytes_of("a/merged");
  const json second = json::parse(program_.run(arguments("a") + "--json").output);
  EXPECT_EQ(second.at("states_made"), 0);
  EXPECT_EQ(second.at("done_before"), kLogs + 2);
  EXPECT_TRUE(bytes_of("a/merged") == bytes);
}

TEST_F(Archive, TriesAgainWhatWasSetAside) {
  expect_success(arguments("a") + "--quiet");
  const json again = json::parse(program_.run(arguments("a") + "--again --json").output);
  EXPECT_EQ(again.at("done_before"), kLogs);
  EXPECT_EQ(again.at("set_aside").size(), 2U);
}

TEST_F(Archive, TakesALogThatGrewAsALaterStateOfItsSegment) {
  const std::string log = program_.read("logs/4711/front/part0.log");
  program_.write("logs/4711/front/part0.log", log.substr(0, log.find('\n', log.size() / 2) + 1));
  expect_success(arguments("a") + "--quiet");
  const std::string before = bytes_of("a/merged");
  program_.write("logs/4711/front/part0.log", log);
  const json grown = json::parse(program_.run(arguments("a") + "--json").output);
  EXPECT_EQ(grown.at("states_made"), 1);
  EXPECT_THAT(grown.at("left_out").at(0).at("reason"), HasSubstr("an earlier state"));
  EXPECT_FALSE(bytes_of("a/merged") == before);
  EXPECT_TRUE(bytes_of("a/merged") == expected());
}

TEST_F(Archive, RefusesAnotherConfigurationAndAnotherFolder) {
  expect_success(arguments("a") + "--quiet");
  const auto other = program_.run("archive logs --no-report --out a");
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.error, HasSubstr("a/archive.toml: was made with another configuration"));
  EXPECT_EQ(program_.run("archive logs --out logs").code, 2) << "holds something";
  EXPECT_EQ(program_.run("archive logs --out b --folders car").code, 2);
  EXPECT_EQ(program_.run("archive logs --out b --part 3/3").code, 2);
  const auto nothing = program_.run("archive logs/readme.md --out b");
  EXPECT_EQ(nothing.code, 1);
  EXPECT_THAT(nothing.error, HasSubstr("no state that can be merged"));
}

TEST_F(Archive, KilledAnywhereGoesOn) {
  std::mt19937 random{9};
  std::uniform_int_distribution<int> after_ms{5, 120};
  for (int kill = 0; kill < 12; ++kill)
    static_cast<void>(program_.run(arguments("a") + "--quiet --jobs 2",
                                   fmt::format("timeout -s KILL 0.{:03}", after_ms(random))));
  const auto last = program_.run(arguments("a") + "--json");
  ASSERT_EQ(last.code, 0) << last.error;
  const json done = json::parse(last.output);
  EXPECT_EQ(done.at("set_aside").size(), 2U);
  EXPECT_TRUE(bytes_of("a/merged") == expected());
  EXPECT_EQ(states_in("a"), kLogs);
  EXPECT_EQ(shell("ls -A a/states a/set_aside | grep -c partial").output, "0\n");
}

TEST_F(Archive, GivesTheSameBytesByThreadsAndParts) {
  const std::string bytes = expected();
  expect_success(arguments("threads") + "--quiet --jobs 7");
  EXPECT_TRUE(bytes_of("threads/merged") == bytes);
  ASSERT_EQ(
      shell("find $PWD/logs -type f ! -name '*.md' | shuf --random-source=all.log > list").code, 0);
  for (const char* part : {"2/3", "0/3", "1/3"})
    expect_success(fmt::format(
        "archive --list list --no-report --folders vehicle/truck --quiet --out parts --part {}",
        part));
  expect_success(
      "archive --list list --no-report --folders vehicle/truck --quiet --out parts --merge-only");
  EXPECT_TRUE(bytes_of("parts/merged") == bytes);
}

TEST_F(Archive, EndsWhereAStateCannotBeWritten) {
  expect_success(arguments("a") + "--quiet");
  ASSERT_EQ(shell("rm a/states/*; rmdir a/states; touch a/states").code, 0);
  const auto outcome = program_.run(arguments("a"));
  EXPECT_EQ(outcome.code, 1);
  EXPECT_THAT(outcome.error, HasSubstr("a/states: cannot"));
}

TEST_F(Archive, GivesTheSameBytesByTheRanksOfMpi) {
  if (!has_program("mpirun") ||
      !std::filesystem::exists(DAMPLINE_BINARY_DIR "/dampline-archive-mpi"))
    GTEST_SKIP() << "built without MPI";
  // MPI does not give back all that it takes.
  const std::string launcher =
      "ASAN_OPTIONS=detect_leaks=0 timeout 100 mpirun --allow-run-as-root --oversubscribe -n";
  const std::string bytes = expected();
  for (const int ranks : {1, 2, 3, 7}) {
    const std::string out = fmt::format("mpi{}", ranks);
    const auto outcome = program_.run(arguments(out), fmt::format("{} {}", launcher, ranks));
    ASSERT_EQ(outcome.code, 0) << ranks << '\n' << outcome.error;
    EXPECT_THAT(outcome.output, HasSubstr("11 logs: 9 states made, 0 done before, 2 set aside"));
    EXPECT_TRUE(bytes_of(out + "/merged") == bytes) << ranks;
  }
  const auto wrong = program_.run("archive logs --out mpi3", launcher + " 3");
  EXPECT_EQ(wrong.code, 2) << "ends, and waits for nobody";
}

using ArchiveNightly = Archive;

TEST_F(ArchiveNightly, OfTasksOfSlurmHasTheSameBytes) {
  if (!has_program("slurmctld") || !has_program("munged") || ::geteuid() != 0)
    GTEST_SKIP() << "no slurm-wlm, or not root";
  const std::string bytes = expected();
  program_.write("submit", arguments("slurm_run") + "--slurm 3 --jobs 1\n");
  program_.write("script", R"sh(set -e
"$DAMPLINE" $(cat submit)
for i in $(seq 500); do ls slurm_run/states 2>/dev/null | grep -q . && break; sleep .01; done
running=$(squeue -h -r -t R -o %i | head -n 1)
[ -z "$running" ] || scontrol requeue "$running"
for i in $(seq 400); do [ -n "$(squeue -h)" ] || break; sleep .2; done
cat slurm_run/slurm/*.out >&2
)sh");
  const auto outcome =
      shell("DAMPLINE='" DAMPLINE_BINARY_DIR "/dampline' timeout 120 '" DAMPLINE_SOURCE_DIR
            "/app/service/slurm/start' engine sh script");
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.output, HasSubstr("11 logs in 3 tasks: job 1; merge behind it: job 2"));
  EXPECT_TRUE(bytes_of("slurm_run/merged") == bytes) << outcome.error;
}

}  // namespace
}  // namespace dampline::app
