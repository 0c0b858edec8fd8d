// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>

#include "sim_hw/nodes.hpp"
#include "sim_hw/simulation.hpp"
#include "tests/proof/callgrind.hpp"
#include "tests/proof/counts.hpp"
#include "tests/proof/probe/rooms.hpp"
#include "tests/proof/profile.hpp"

namespace dampline::proof {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kInstants = 7'500;  // 25 s
constexpr std::int64_t kFirst = 4'500;     // ranges, steps and lengths are learned by then
/// Of one test alone: tests run side by side.
std::string folder(const std::string& room) {
  const std::string path = fmt::format("{}/proof/room_cost_{}", DAMPLINE_BINARY_DIR, room);
  fs::create_directories(path);
  return path;
}

void write_instants(const std::string& path) {
  sim::Simulation simulation{sim::SimulationConfig{}};
  sim::SensorNodes nodes{{}, 1};
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  std::ofstream file{path, std::ios::binary};
  for (std::int64_t i = 0; i < kInstants; ++i) {
    const sim::SimulatedSample simulated = simulation.next();
    Instant instant;
    instant.frames = nodes.pack(simulated);
    instant.sample = sim::to_sample(simulated);
    instant.result = identifier->update(instant.sample);
    file.write(reinterpret_cast<const char*>(&instant), sizeof instant);
  }
}

std::string probe(const std::string& room, const std::string& instants, std::int64_t first) {
  return fmt::format("{} {} {} {}", DAMPLINE_ROOM_PROBE, room, instants, first);
}

class RoomCost : public testing::TestWithParam<const char*> {};

/// To write the counts anew after a change that is meant: counts.hpp.
TEST_P(RoomCost, IsWhatWasCommitted) {
  if (const auto why = why_not_counted()) GTEST_SKIP() << *why;
  const std::string room = GetParam();
  const std::string instants = folder(room) + "/instants";
  write_instants(instants);
  const Profile now =
      profile_inside(probe(room, instants, kFirst), "room_measured", folder(room) + "/profile");
  fs::remove_all(folder(room));
  ASSERT_GT(total_of(now), 100'000U);
  check_counts(room, now, kInstants - kFirst);
}

INSTANTIATE_TEST_SUITE_P(Rooms, RoomCost, testing::ValuesIn(kRoomNames),
                         [](const auto& room) { return std::string{room.param}; });

struct Spread {
  std::uint64_t mean;
  std::uint64_t largest;
};

/// Over three blocks' ends.
Spread spread_of(const std::string& room) {
  constexpr std::int64_t kLast = 2'000;
  const std::string path = folder("worst_case_" + room);
  write_instants(path + "/instants");
  const auto counts = instructions_per_call(probe(room, path + "/instants", kInstants - kLast),
                                            "room_measured", path + "/calls");
  fs::remove_all(path);  // one file a sample
  EXPECT_EQ(counts.size(), static_cast<std::size_t>(kLast));
  const Spread out{std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}) / counts.size(),
                   *std::max_element(counts.begin(), counts.end())};
  fmt::print("{}: {} instructions per sample in the mean, {} in the worst case\n", room, out.mean,
             out.largest);
  return out;
}

TEST(ChainCost, OfTheWorstCaseIsBounded) {
  if (!fs::exists("/proc/self/maps")) GTEST_SKIP() << "valgrind needs /proc";
  const Spread spread = spread_of("chain");
  EXPECT_GT(spread.mean, 1'000U);
  EXPECT_LE(spread.largest, 60'000U);
}

TEST(ChainCost, OfTheWorstCaseWithEveryCandidateIsBounded) {
  if (!fs::exists("/proc/self/maps")) GTEST_SKIP() << "valgrind needs /proc";
  EXPECT_LE(spread_of("explain").largest, 280'000U);
}

TEST(CallgrindProfile, TellsAFunctionsOwnCostFromThatOfItsCalls) {
  const Profile profile = parse_callgrind(
      "events: Ir\n\nfn=(1) outer(int, int)\n0 100\ncfn=(2) inner\ncalls=3 0\n0 5000\n0 11\n\n"
      "fn=(2)\n0 4000\ncfi=(4)\ncfn=(3) leaf\ncalls=1 0\n0 1000\n\nfn=(3)\n* 1000\n\n"
      "totals: 5111\n");
  EXPECT_EQ(profile, (Profile{{"outer(int, int)", 111}, {"inner", 4000}, {"leaf", 1000}}));
  EXPECT_EQ(total_of(profile), 5111U);
}

TEST(CallgrindProfile, NamesWhatGrewMostFirst) {
  const std::string text =
      describe_growth({{"a", 10}, {"b", 10}, {"gone", 5}}, {{"a", 11}, {"b", 40}, {"new", 20}}, 2);
  EXPECT_EQ(text, fmt::format("  {:+12} b\n  {:+12} new\n", 30, 20));
}

TEST(CallgrindProfile, IsThatOfTheFunctionAskedFor) {
  if (!fs::exists("/proc/self/maps")) GTEST_SKIP() << "valgrind needs /proc";
  const std::string path = folder("control");
  const Profile profile = profile_inside(DAMPLINE_COST_CONTROL, "work_measured", path + "/profile");
  fs::remove_all(path);
  // 103,000 rounds of a loop, and nothing else.
  EXPECT_GE(total_of(profile), 2U * 103'000U);
  EXPECT_GT(profile.at("work_measured"), total_of(profile) * 99 / 100);
}

}  // namespace
}  // namespace dampline::proof
