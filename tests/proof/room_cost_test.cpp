// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>
#include <sstream>

#include "sim_hw/nodes.hpp"
#include "sim_hw/simulation.hpp"
#include "tests/proof/callgrind.hpp"
#include "tests/proof/probe/rooms.hpp"
#include "tests/proof/profile.hpp"

namespace dampline::proof {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kInstants = 7'500;  // 25 s
constexpr std::int64_t kFirst = 4'500;     // ranges, steps and lengths are learned by then
constexpr double kMostGrowth = 1.03;
constexpr double kMostShrinkage = 0.90;

/// Counts are those of one compiler, and of processors that take the functions for wider vectors.
fs::path counts_folder() {
  return fs::path{DAMPLINE_SOURCE_DIR} / fmt::format("tests/proof/counts/gcc-{}", __GNUC__);
}

bool has_wide_vectors() {
#if defined(__x86_64__)
  return __builtin_cpu_supports("avx2") != 0;
#else
  return false;
#endif
}

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

/// One function a line: instructions, name.
Profile read_counts(const fs::path& path) {
  Profile out;
  std::ifstream file{path};
  for (std::string line; std::getline(file, line);) {
    const auto space = line.find(' ');
    if (space != std::string::npos)
      out[line.substr(space + 1)] = std::strtoull(line.c_str(), nullptr, 10);
  }
  return out;
}

/// The dearest first; what is below a thousandth goes together.
void write_counts(const fs::path& path, const Profile& profile) {
  std::vector<std::pair<std::uint64_t, std::string>> lines;
  std::uint64_t rest = 0;
  for (const auto& [name, count] : profile) {
    if (count * 1000 > total_of(profile))
      lines.emplace_back(count, name);
    else
      rest += count;
  }
  std::stable_sort(lines.rbegin(), lines.rend());
  if (rest > 0) lines.emplace_back(rest, "(all others)");
  fs::create_directories(path.parent_path());
  std::ofstream file{path};
  for (const auto& [count, name] : lines) file << count << ' ' << name << '\n';
}

std::string probe(const std::string& room, const std::string& instants, std::int64_t first) {
  return fmt::format("{} {} {} {}", DAMPLINE_ROOM_PROBE, room, instants, first);
}

class RoomCost : public testing::TestWithParam<const char*> {};

/// To write the counts anew after a change that is meant:
///   DAMPLINE_WRITE_COUNTS=1 build/release/tests/test_proof --gtest_filter='*RoomCost*'
TEST_P(RoomCost, IsWhatWasCommitted) {
  if (!fs::exists("/proc/self/maps")) GTEST_SKIP() << "valgrind needs /proc";
  const std::string room = GetParam();
  const fs::path path = counts_folder() / (room + ".txt");
  const bool writes = std::getenv("DAMPLINE_WRITE_COUNTS") != nullptr;
  if (!has_wide_vectors()) GTEST_SKIP() << "the counts are those of a processor with AVX2";
  if (!writes && !fs::exists(counts_folder()))
    GTEST_SKIP() << "no counts are committed for this compiler";
  const std::string instants = folder(room) + "/instants";
  write_instants(instants);
  const Profile now =
      profile_inside(probe(room, instants, kFirst), "room_measured", folder(room) + "/profile");
  fs::remove_all(folder(room));
  ASSERT_GT(total_of(now), 100'000U);
  if (writes) write_counts(path, now);
  const Profile before = read_counts(path);
  ASSERT_FALSE(before.empty()) << "no counts in " << path;
  const double ratio = static_cast<double>(total_of(now)) / static_cast<double>(total_of(before));
  fmt::print("{}: {:.1f} instructions per sample, {:+.2f} % of what is committed\n", room,
             static_cast<double>(total_of(now)) / static_cast<double>(kInstants - kFirst),
             100.0 * (ratio - 1.0));
  EXPECT_LE(ratio, kMostGrowth) << "what grew, in instructions:\n"
                                << describe_growth(before, now, 12);
  EXPECT_GE(ratio, kMostShrinkage) << "a gain: commit the new counts, so that it cannot be lost";
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
  const std::string path = folder("dearest_" + room);
  write_instants(path + "/instants");
  const auto counts = instructions_per_call(probe(room, path + "/instants", kInstants - kLast),
                                            "room_measured", path + "/calls");
  fs::remove_all(path);  // one file a sample
  EXPECT_EQ(counts.size(), static_cast<std::size_t>(kLast));
  const Spread out{std::accumulate(counts.begin(), counts.end(), std::uint64_t{0}) / counts.size(),
                   *std::max_element(counts.begin(), counts.end())};
  fmt::print("{}: {} instructions per sample in the mean, {} for the dearest\n", room, out.mean,
             out.largest);
  return out;
}

TEST(ChainCost, OfTheDearestSampleIsBounded) {
  if (!fs::exists("/proc/self/maps")) GTEST_SKIP() << "valgrind needs /proc";
  const Spread spread = spread_of("chain");
  EXPECT_GT(spread.mean, 1'000U);
  EXPECT_LE(spread.largest, 60'000U);
}

TEST(ChainCost, OfTheDearestSampleWithEveryCandidateIsBounded) {
  if (!fs::exists("/proc/self/maps")) GTEST_SKIP() << "valgrind needs /proc";
  EXPECT_LE(spread_of("explain").largest, 250'000U);
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
