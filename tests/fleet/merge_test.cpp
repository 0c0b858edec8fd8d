// SPDX-License-Identifier: MIT
// `dampline merge`: the same bytes however it is done, the numbers of the whole, and what it
// refuses.
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/fleet/segments.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Merge : public SegmentsTest {
 protected:
  json parameters_of(const std::string& run) const {
    const json whole = json::parse(program_.read(run + "/parameters.json"));
    json out;
    for (const json& p : whole.at("parameters")) out[p.at("name").get<std::string>()] = p;
    return out;
  }
};

TEST_F(Merge, GivesTheSameBytesInAnyOrderSplitAndNumberOfJobs) {
  constexpr std::size_t kSegments = 7;
  make_logs(kSegments);
  std::vector<std::string> runs = identify_logs(kSegments);
  const std::string expected = merged_bytes(words(runs));
  std::mt19937 random{24};
  for (const int jobs : {1, 2, 3, 7}) {
    std::shuffle(runs.begin(), runs.end(), random);
    std::vector<std::string> twice = runs;
    twice.push_back(runs.front());
    EXPECT_TRUE(merged_bytes(fmt::format("{}--jobs {}", words(twice), jobs)) == expected) << jobs;
  }
  std::filesystem::create_directories(program_.path("day/deep"));
  for (const std::string& run : runs)
    std::filesystem::rename(program_.path(run),
                            program_.path((run < "r4" ? "day/" : "day/deep/") + run));
  EXPECT_TRUE(merged_bytes("day") == expected) << "of a directory";
}

TEST_F(Merge, OfOneStateIsThatState) {
  make_logs(1);
  identify_logs(1);
  static_cast<void>(merged_bytes("r0"));
  EXPECT_TRUE(program_.read("merged/state.dls") == program_.read("r0/state.dls"));
  EXPECT_DOUBLE_EQ(parameters_of("merged").at("coulomb").at("value"),
                   parameters_of("r0").at("coulomb").at("value"));
}

TEST_F(Merge, SaysWhatTheWholeRecordSays) {
  constexpr std::size_t kSegments = 6;
  make_logs(kSegments, "--seed 5");
  const auto runs = identify_logs(kSegments);
  expect_success("identify all.log --quiet --no-report --out whole");
  static_cast<void>(merged_bytes(words(runs)));
  const json merged = parameters_of("merged");
  const json whole = parameters_of("whole");
  for (const char* name : {"coulomb", "stiffness"}) {
    const double value = whole.at(name).at("value");
    const double std = whole.at(name).at("std");
    EXPECT_NEAR(merged.at(name).at("value"), value, std) << name << ": edges of the logs are lost";
    EXPECT_NEAR(merged.at(name).at("std").get<double>() / std, 1.0, 0.4) << name;
  }
  const StateAbout about = about_of("merged/state.dls");
  EXPECT_EQ(about.segments, kSegments);
  EXPECT_EQ(about.sequence, 6U * 18000U);
  EXPECT_EQ(about.segment.start_ns, about_of("r0/state.dls").segment.start_ns);
  EXPECT_EQ(about.end_ns, about_of("r5/state.dls").end_ns);
}

TEST_F(Merge, CountsTheLatestStateOfASegment) {
  make_logs(1);
  const std::string log = program_.read("logs/part0.log");
  program_.write("half.log", log.substr(0, log.find('\n', log.size() / 2) + 1));
  expect_success("identify half.log --quiet --no-report --out half");
  identify_logs(1);
  EXPECT_LT(about_of("half/state.dls").sequence, about_of("r0/state.dls").sequence);
  const auto outcome = program_.run("merge half r0 --no-report --out both");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.output,
              HasSubstr("left out: half/state.dls: an earlier state of the segment of r0"));
  EXPECT_TRUE(program_.read("both/state.dls") == program_.read("r0/state.dls"));
}

TEST_F(Merge, RefusesWhatCannotBeAddedWithTheReason) {
  make_logs(2);
  identify_logs(2);
  const auto other = [&](const std::string& car, const std::string& why) {
    program_.write("car.toml", car);
    expect_success("identify logs/part1.log --config car.toml --quiet --no-report --force --out o");
    expect_refused("r0 o", "o/state.dls: cannot be added to r0/state.dls: another " + why);
  };
  other("[model]\nvelocity_corner_hz = 1.0\n", "basis: its velocity's drift filter");
  other("[model]\ncurve_nodes_mps = [0.01, 0.02, 0.04, 0.06, 0.08, 0.12, 0.2, 0.4]\n",
        "basis: its curve has other nodes");
  other("[input.anti_alias]\ncorner_hz = 90.0\n", "basis: its anti-aliasing filter");
  other("[car]\nmoving_mass_kg = 18600.0\n", "mass: [car] moving_mass_kg is 18600, expected 37200");
  rewrite("r1/state.dls", "rate.dls", [](StateAbout& a, Statistics&) { a.rate_hz.value = 300.5; });
  expect_refused("r0 rate.dls",
                 "another rate: 300.500 Hz by its record's own time, expected 300.000");
  rewrite("r1/state.dls", "sign.dls", [](StateAbout& a, Statistics&) {
    a.coulomb_n = {-3683.0, 20.0};
  });
  expect_refused("r0 sign.dls", "another sign: its friction comes out negative");
  const auto outcome = program_.run("merge r0 sign.dls --leave-out --no-report --out kept");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.output, HasSubstr("left out: sign.dls: another sign"));
  EXPECT_TRUE(program_.read("kept/state.dls") == program_.read("r0/state.dls"));
}

TEST_F(Merge, RefusesWhatIsNoStateOfASegment) {
  make_logs(2);
  identify_logs(2);
  expect_success("merge r0 r1 --quiet --no-report --out both");
  expect_refused("both r1", "both/state.dls: is itself a merge, of 2 segments");
  std::string old = program_.read("r0/state.dls");
  old.resize(old.size() / 2);
  program_.write("half.dls", old);
  expect_refused("r0 half.dls", "half.dls: is cut off");
  expect_refused("r0 absent.dls", "absent.dls: cannot be read");
  program_.write("empty/nothing.txt", "");
  std::filesystem::create_directories(program_.path("empty"));
  expect_refused("empty", "empty: holds no state");
  EXPECT_EQ(program_.run("merge r0 --out r0").code, 2) << "its own run";
  EXPECT_EQ(program_.run("merge r0 r1 --by day --out x").code, 2);
}

TEST_F(Merge, LeavesOutWhatFaultsSpoil) {
  make_logs(2);
  identify_logs(2);
  rewrite("r1/state.dls", "bad.dls",
          [](StateAbout& a, Statistics&) { a.trust = Trust::kDataFaulty; });
  const auto outcome = program_.run("merge r0 bad.dls --no-report --json --out good");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  const json found = json::parse(outcome.output);
  EXPECT_EQ(found.at("left_out").at(0).at("reason"), "faults of the data spoil it");
  EXPECT_EQ(found.at("groups").at(0).at("segments"), 1);
}

TEST_F(Merge, TellsOfOverlapsAndNamelessCars) {
  make_logs(3);
  identify_logs(3);
  expect_success("identify all.log --quiet --no-report --out whole");
  // The whole begins with part 0 and is its later state; the other parts lie within it.
  const auto outcome = program_.run("merge r0 r1 r2 whole --no-report --out all");
  EXPECT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error,
              AllOf(HasSubstr("r1/state.dls begins 2 min before whole/state.dls ends"),
                    HasSubstr("name no vehicle")));
}

TEST_F(Merge, MakesARunForEachGroup) {
  make_logs(4);
  for (const auto& [i, car] : {std::pair{0, "vehicle = \"A\"\ntruck = \"front\"\nload = \"laden\""},
                               {1, "vehicle = \"A\"\ntruck = \"front\"\nload = \"laden\""},
                               {2, "vehicle = \"A\"\ntruck = \"rear\"\nload = \"laden\""},
                               {3, "vehicle = \"B/1\"\ntruck = \"front\""}}) {
    program_.write("car.toml", fmt::format("[record]\n{}\n", car));
    expect_success(fmt::format(
        "identify logs/part{0}.log --config car.toml --quiet --no-report --out r{0}", i));
  }
  expect_success("merge r0 r1 r2 r3 --by vehicle,truck,load,month --quiet --no-report --out by");
  for (const char* run :
       {"by/A.front.laden.2023-11", "by/A.rear.laden.2023-11", "by/B_1.front.37200_kg.2023-11"}) {
    EXPECT_TRUE(program_.exists(std::string{run} + "/run.toml")) << run;
    EXPECT_TRUE(program_.exists(std::string{run} + "/segments.csv")) << run;
  }
  EXPECT_EQ(parameters_of("by/A.front.laden.2023-11").at("coulomb").at("unit"), "N");
  const std::string table = program_.read("by/groups.csv");
  EXPECT_THAT(table,
              AllOf(HasSubstr("vehicle,truck,load,month,segments,duration_h,coulomb_n,"),
                    HasSubstr("A,front,laden,2023-11,2,"), HasSubstr("A,rear,laden,2023-11,1,"),
                    HasSubstr("B_1,front,37200_kg,2023-11,1,")));
  EXPECT_EQ(program_.run("merge r0 --by truck --no-report --out by").code, 2) << "exists already";
}

TEST_F(Merge, OfLightStatesIsOfSomeKilobytesAndAMillionthOff) {
  constexpr std::size_t kSegments = 7;
  constexpr std::size_t kFewBytes = 6000;
  make_logs(kSegments);
  const auto runs = identify_logs(kSegments);
  std::vector<std::string> light;
  for (const std::string& run : runs) {
    light.push_back(run + ".dls");
    expect_success("merge " + run + " --quiet --no-report --force --out one --light " +
                   light.back());
    EXPECT_LT(std::filesystem::file_size(program_.path(light.back())), kFewBytes);
    EXPECT_EQ(about_of(light.back()).segment, about_of(run + "/state.dls").segment);
    EXPECT_EQ(about_of(light.back()).coulomb_n.std, about_of(run + "/state.dls").coulomb_n.std);
  }
  static_cast<void>(merged_bytes(words(runs)));
  const json full = parameters_of("merged");
  static_cast<void>(merged_bytes(words(light)));
  const json small = parameters_of("merged");
  for (const char* name : {"coulomb", "stiffness"}) {
    const double value = full.at(name).at("value");
    EXPECT_NEAR(small.at(name).at("value").get<double>() / value, 1.0, 1e-6) << name;
    // Its deviation is of seven pieces, not of twenty-eight.
    EXPECT_NEAR(
        std::log(small.at(name).at("std").get<double>() / full.at(name).at("std").get<double>()),
        0.0, std::log(2.5))
        << name;
  }
  // Where both are there, the full one counts.
  EXPECT_TRUE(merged_bytes(words(light) + words(runs)) == merged_bytes(words(runs)));
  expect_refused(light[0] + " " + light[1], "or four light states");
}

}  // namespace
}  // namespace dampline::app
