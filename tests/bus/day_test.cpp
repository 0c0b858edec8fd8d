// SPDX-License-Identifier: MIT
// Ten minutes of what tests/bus/day does for a whole one: driving with a standstill, live on the
// socket path, in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "tests/bus/bus.hpp"
#include "tests/bus/live_program.hpp"

namespace dampline::bus {
namespace {

using std::chrono::seconds;

constexpr double kLevel_n = 8356.0;  // laden car: what the simulated friction comes to
constexpr double kStiffness_npm = 5.26e6;

struct Day {
  RunFiles files;
  nlohmann::json result;
  std::vector<std::uint64_t> memory_kib;
};

/// Drives for ten minutes, and stands still from 240 s to 360 s.
Day drive() {
  const Folder folder;
  const VirtualCan bus;
  LiveProgram live{folder, bus.name(), folder / "live"};
  Child simulate{simulate_command(bus.name(), 600.0, 10, {"--standstill", "240,360"}),
                 folder.path()};
  Day day;
  for (int i = 0; i < 5; ++i) {
    std::this_thread::sleep_for(seconds{100});
    day.memory_kib.push_back(live.memory_kib("VmSize"));
  }
  EXPECT_EQ(simulate.wait().status, 0);
  std::this_thread::sleep_for(seconds{1});
  day.result = live.stop();
  day.files = read_run(live.run());
  return day;
}

/// Rows of convergence.csv: time_s, coulomb, its std, stiffness, its std.
std::vector<std::array<double, 5>> rows_of(const std::string& csv) {
  std::istringstream lines{csv};
  std::string line;
  std::getline(lines, line);
  std::vector<std::array<double, 5>> rows;
  while (std::getline(lines, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream cells{line};
    std::array<double, 5> row{};
    for (double& cell : row) cells >> cell;
    rows.push_back(row);
  }
  return rows;
}

TEST(TimeTravelDay, TenMinutesWithAStandstillLoseNothingAndEndWhereTheyShould) {
  const Day day = drive();
  const auto& counts = day.result.at("counts");
  EXPECT_EQ(counts.at("samples"), 180'000);
  EXPECT_EQ(counts.at("gaps"), 0);
  EXPECT_EQ(counts.at("frames_sent"), 540'000);
  EXPECT_EQ(counts.at("frames_processed"), 540'000);
  EXPECT_GT(counts.at("blocks_still"), 10);
  const auto& live = day.result.at("live");
  EXPECT_EQ(live.at("cycle_slips"), 0);
  EXPECT_EQ(live.at("records_lost"), 0);
  // Of the acquisition's thread, in 177,000 samples after its warm-up.
  EXPECT_TRUE(live.at("memory_locked"));
  EXPECT_EQ(live.at("minor_faults"), 0);
  EXPECT_EQ(live.at("major_faults"), 0);
  for (const std::uint64_t kib : day.memory_kib) EXPECT_EQ(kib, day.memory_kib.front());
  // From the end of the standstill on, within the bounds that the README states for a fresh 300 s.
  std::size_t after = 0;
  for (const auto& [time_s, coulomb_n, coulomb_std_n, stiffness, stiffness_std] :
       rows_of(day.files.convergence)) {
    if (time_s < 360.0) continue;
    ++after;
    EXPECT_NEAR(coulomb_n, kLevel_n, 0.004 * kLevel_n) << time_s;
    EXPECT_NEAR(stiffness, kStiffness_npm, 0.013 * kStiffness_npm) << time_s;
  }
  EXPECT_GT(after, 20U);
}

// run_with starts it in two machines, one after the other, and compares what they leave.
TEST(TimeTravelTwice, TenMinutesGiveTheSameBytes) {
  const char* const keep = std::getenv("DAMPLINE_KEEP");
  ASSERT_NE(keep, nullptr) << "start it by tests/bus/run_with";
  const Day day = drive();
  std::ofstream{std::filesystem::path{keep} / "result"} << day.files.parameters << day.files.counts
                                                        << day.files.state << day.files.curve
                                                        << day.files.convergence;
}

}  // namespace
}  // namespace dampline::bus
