// SPDX-License-Identifier: MIT
// Ten minutes of what tests/bus/day does for a whole one: driving with a standstill, live on the
// socket path, in virtual time.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
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

struct Plan {
  double duration_s{600.0};
  std::vector<std::array<double, 2>> standstills_s{{240.0, 360.0}};

  [[nodiscard]] static Plan chosen() {
    if (std::getenv("DAMPLINE_WHOLE_DAY") == nullptr) return {};
    constexpr double kHour_s = 3600.0;
    return {24.0 * kHour_s, {{6.0 * kHour_s, 6.25 * kHour_s}, {12.0 * kHour_s, 20.0 * kHour_s}}};
  }
  [[nodiscard]] std::uint64_t samples() const {
    return static_cast<std::uint64_t>(duration_s * 300.0);
  }
  [[nodiscard]] Words options() const {
    Words words;
    for (const auto& [start_s, end_s] : standstills_s)
      words.insert(words.end(),
                   {"--standstill", std::to_string(start_s) + "," + std::to_string(end_s)});
    return words;
  }
};

struct Day {
  RunFiles files;
  nlohmann::json result;
  std::vector<std::uint64_t> memory_kib;
};

Day drive(const Plan& plan) {
  const Folder folder;
  const VirtualCan bus;
  std::ofstream{folder / "day.toml"} << "[blackbox]\nrotate_mib = 16\nkeep_mib = 64\n";
  LiveProgram live{folder, bus.name(), folder / "live", {"--config", folder / "day.toml"}};
  Child simulate{simulate_command(bus.name(), plan.duration_s, 10, plan.options()), folder.path()};
  Day day;
  for (int i = 0; i < 5; ++i) {
    std::this_thread::sleep_for(std::chrono::duration<double>{plan.duration_s / 6.0});
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

void expect_nothing_lost(const Plan& plan, const Day& day) {
  const auto& counts = day.result.at("counts");
  EXPECT_EQ(counts.at("samples"), plan.samples());
  EXPECT_EQ(counts.at("gaps"), 0);
  EXPECT_EQ(counts.at("frames_sent"), 3 * plan.samples());
  EXPECT_EQ(counts.at("frames_processed"), 3 * plan.samples());
  EXPECT_GT(counts.at("blocks_still"), 10);
  const auto& live = day.result.at("live");
  EXPECT_EQ(live.at("cycle_slips"), 0);
  EXPECT_EQ(live.at("records_lost"), 0);
  // Of the acquisition's thread, in all samples but the first 3,000.
  EXPECT_TRUE(live.at("memory_locked"));
  EXPECT_EQ(live.at("minor_faults"), 0);
  EXPECT_EQ(live.at("major_faults"), 0);
  // The explainer's first allocation, when it first has something to explain, reserves the
  // addresses of an arena of its own; nothing else grows.
  constexpr std::uint64_t kArenaKib = 65536;
  for (const std::uint64_t kib : day.memory_kib)
    EXPECT_TRUE(kib == day.memory_kib.front() || kib == day.memory_kib.front() + kArenaKib) << kib;
}

// Within the bounds that the README states for a fresh 300 s, at all times after a standstill.
void expect_right_estimates(const Plan& plan, const Day& day) {
  std::size_t after = 0;
  for (const auto& [time_s, coulomb_n, coulomb_std_n, stiffness, stiffness_std] :
       rows_of(day.files.convergence)) {
    if (time_s < plan.standstills_s.front()[1]) continue;
    ++after;
    EXPECT_NEAR(coulomb_n, kLevel_n, 0.004 * kLevel_n) << time_s;
    EXPECT_NEAR(stiffness, kStiffness_npm, 0.013 * kStiffness_npm) << time_s;
  }
  EXPECT_GT(after, 20U);
}

void print(const Day& day) {
  std::printf("memory %llu KiB throughout\n%s\n%s\n%s\nlive %s\n",
              static_cast<unsigned long long>(day.memory_kib.back()), day.files.parameters.c_str(),
              day.files.counts.c_str(), day.files.convergence.c_str(),
              day.result.at("live").dump(1).c_str());
}

// run_with starts it in two machines, one after the other, and compares what they leave; so does
// tests/bus/day, for a whole day.
TEST(TimeTravelNightlyTwice, DrivingWithAStandstillLosesNothingAndGivesTheSameBytes) {
  const char* const keep = std::getenv("DAMPLINE_KEEP");
  ASSERT_NE(keep, nullptr) << "start it by tests/bus/run_with";
  const Plan plan = Plan::chosen();
  const Day day = drive(plan);
  print(day);
  expect_nothing_lost(plan, day);
  expect_right_estimates(plan, day);
  std::ofstream{std::filesystem::path{keep} / "result"} << day.files.parameters << day.files.counts
                                                        << day.files.state << day.files.curve
                                                        << day.files.convergence;
}

}  // namespace
}  // namespace dampline::bus
