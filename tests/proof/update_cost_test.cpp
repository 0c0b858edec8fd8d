// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <numeric>

#include "dampline/damping/estimator.hpp"
#include "tests/proof/callgrind.hpp"
#include "tests/proof/ride.hpp"

namespace dampline::proof {
namespace {

namespace fs = std::filesystem;

/// Of this test alone: tests run side by side.
std::string folder() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::string path = std::string{DAMPLINE_BINARY_DIR "/proof/"} + test->name();
  fs::create_directories(path);
  return path;
}

void write_samples(const std::string& path, const std::vector<Sample>& samples) {
  std::ofstream file{path, std::ios::binary};
  file.write(reinterpret_cast<const char*>(samples.data()),
             static_cast<std::streamsize>(samples.size() * sizeof(Sample)));
}

struct Cost {
  double mean;
  std::uint64_t max;
};

/// Instructions of Estimator::update for samples `first` up to `last` of a laden ride.
Cost cost_of_update(Memory memory, const std::vector<Sample>& ride, long first, long last) {
  const std::string samples = folder() + "/ride.samples";
  write_samples(samples, ride);
  const auto counts =
      instructions_per_call(fmt::format("{} {} {} {} {}", DAMPLINE_COST_PROBE, samples,
                                        static_cast<int>(memory), first, last),
                            "update_measured", folder() + "/calls");
  fs::remove_all(folder());  // one file a sample
  EXPECT_EQ(counts.size(), static_cast<std::size_t>(last - first));
  if (counts.empty()) return {};
  const auto sum = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  return {static_cast<double>(sum) / static_cast<double>(counts.size()),
          *std::max_element(counts.begin(), counts.end())};
}

bool valgrind_can_run() { return fs::exists("/proc/self/maps"); }

void expect_spread_work(Memory memory, const std::vector<Sample>& ride, long first, long last) {
  if (!valgrind_can_run()) GTEST_SKIP() << "valgrind needs /proc, which is not mounted here";
  const Cost cost = cost_of_update(memory, ride, first, last);
  const double ratio = static_cast<double>(cost.max) / cost.mean;
  fmt::print("instructions per sample: mean {:.0f}, worst case {}, ratio {:.1f}\n", cost.mean,
             cost.max, ratio);
  EXPECT_GT(cost.mean, 100.0);
  EXPECT_LE(ratio, 20.0);
}

// 68 s from the first sample on: in that time the store of blocks fills and is compacted.
TEST(UpdateCost, OfTheWorstCaseIsAtMostTwentyTimesTheMean) {
  expect_spread_work(Memory::kInfinite, laden_ride(69.0), 0, 20'500);
}

// With a memory of 30 s, these 10 s hold blocks that leave it.
TEST(UpdateCost, IsAsEvenWithASlidingWindow) {
  expect_spread_work(Memory::kWindow, laden_ride(54.0), 13'000, 16'000);
}

TEST(UpdateCost, IsAsEvenWithForgetting) {
  expect_spread_work(Memory::kForgetting, laden_ride(54.0), 13'000, 16'000);
}

TEST(UpdateCost, IsAsEvenWhereSamplesAreLostAndDamaged) {
  std::vector<Sample> ride = laden_ride(69.0);
  Trouble trouble{1};
  for (Sample& sample : ride) trouble.apply(sample);
  expect_spread_work(Memory::kInfinite, ride, 0, 20'500);
}

TEST(InstructionCounts, AreThoseOfTheCallsAndRepeat) {
  if (!valgrind_can_run()) GTEST_SKIP() << "valgrind needs /proc, which is not mounted here";
  const auto count = [] {
    return instructions_per_call(DAMPLINE_COST_CONTROL, "work_measured", folder() + "/calls");
  };
  const auto counts = count();
  ASSERT_EQ(counts.size(), 3U);  // 1,000, 2,000 and 100,000 rounds of a loop
  const double per_round = static_cast<double>(counts[1] - counts[0]) / 1000.0;
  EXPECT_GE(per_round, 2.0);
  EXPECT_NEAR(static_cast<double>(counts[2] - counts[1]), 98'000.0 * per_round, 100.0);
  EXPECT_EQ(count(), counts);
}

}  // namespace
}  // namespace dampline::proof
