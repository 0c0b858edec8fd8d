// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numeric>

#include "dampline/damping/estimator.hpp"
#include "tests/proof/callgrind.hpp"
#include "tests/proof/ride.hpp"

namespace dampline::proof {
namespace {

namespace fs = std::filesystem;

constexpr double kMostInstructions = 1500.0;

class DensityCost : public testing::TestWithParam<double> {};

/// From the first instant on, so that ranges are learned meanwhile, over some blocks' ends.
TEST_P(DensityCost, IsBelowItsLimit) {
  if (!fs::exists("/proc/self/maps")) GTEST_SKIP() << "valgrind needs /proc";
  const std::string folder =
      fmt::format("{}/proof/density_cost_{:.0f}", DAMPLINE_BINARY_DIR, GetParam());
  fs::create_directories(folder);
  const std::string motions = folder + "/ride.motions";
  {
    std::ofstream file{motions, std::ios::binary};
    const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
    for (const Sample& sample : laden_ride(24.0)) {
      const UpdateResult result = identifier->update(sample);
      if (!result.has_motion) continue;
      file.write(reinterpret_cast<const char*>(&result.motion), sizeof result.motion);
    }
  }
  const auto counts =
      instructions_per_call(fmt::format("{} {} {} 0", DAMPLINE_DENSITY_PROBE, motions, GetParam()),
                            "density_measured", folder + "/calls");
  fs::remove_all(folder);  // one file a sample
  ASSERT_GT(counts.size(), 4'000U);
  const auto sum = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  const double mean = static_cast<double>(sum) / static_cast<double>(counts.size());
  const auto worst = *std::max_element(counts.begin(), counts.end());
  auto sorted = counts;
  std::sort(sorted.begin(), sorted.end());
  fmt::print("instructions per sample: mean {:.0f}, 99.9 % below {}, worst case {}\n", mean,
             sorted[sorted.size() * 999 / 1000], worst);
  EXPECT_LE(mean, kMostInstructions);
  EXPECT_LE(static_cast<double>(sorted[sorted.size() * 99 / 100]), 1.5 * kMostInstructions);
}

INSTANTIATE_TEST_SUITE_P(Memories, DensityCost, testing::Values(0.0, 10.0));

}  // namespace
}  // namespace dampline::proof
