// SPDX-License-Identifier: MIT
// What coarse, noisy, slow and unfiltered sensors cost, by a simulation that shares nothing with
// the program. bench/sensors has every row on more records.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "app/run/json.hpp"
#include "tests/app/plain_truck.hpp"

namespace dampline::app {
namespace {

using test::identified_from;
using test::kPlainTrucks;
using test::PlainSensors;
using test::PlainTruck;

constexpr double kSeconds = 200.0;

const Parameter& parameter(const RunResult& result, const char* name) {
  const Parameter* const found = find_parameter(result.parameters, name);
  if (found == nullptr) throw std::runtime_error{name};
  return *found;
}

struct Sensing {
  const char* name;
  PlainSensors sensors;
  double most_level{0.01};  ///< error of the level, of the truth
};

class PlainSensorsTest : public testing::TestWithParam<Sensing> {};

/// Within three deviations: two hold 19 of 20, and these are twelve numbers.
TEST_P(PlainSensorsTest, LeaveLevelAndSpringWithinTheirDeviations) {
  for (const std::size_t which : {0U, 2U}) {
    const PlainTruck& truck = kPlainTrucks.at(which);
    const RunResult result = identified_from(truck, GetParam().sensors, kSeconds, 31);
    const Parameter& level = parameter(result, "coulomb");
    const Parameter& spring = parameter(result, "stiffness");
    EXPECT_LE(std::abs(level.value / truck.coulomb_n - 1.0), GetParam().most_level) << truck.name;
    EXPECT_LE(std::abs(level.value - truck.coulomb_n), 3.0 * level.std) << truck.name;
    EXPECT_LE(std::abs(spring.value - truck.spring_npm), 3.0 * spring.std) << truck.name;
    EXPECT_EQ(result.trust, Trust::kTrusted) << truck.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, PlainSensorsTest,
                         testing::Values(Sensing{"EightBits", {.bits = 8}, 0.04},
                                         Sensing{"Noisy", {.noise_mps2 = 0.1}, 0.04},
                                         Sensing{"LowCorner", {.corner_hz = 60.0}},
                                         Sensing{"Slow", {.rate_hz = 150.0, .corner_hz = 60.0}},
                                         Sensing{"Fast", {.rate_hz = 1000.0, .corner_hz = 400.0}}),
                         [](const auto& sensing) { return std::string{sensing.param.name}; });

/// The node at 3 mm/s lies below 1.5 times the law's width there: the level all the same.
TEST(PlainSensorsCurve, HoldsTheLevelAtItsSlowestNode) {
  const PlainTruck& truck = kPlainTrucks.front();
  for (const double noise_mps2 : {0.02, 0.1}) {
    const RunResult result = identified_from(truck, {.noise_mps2 = noise_mps2}, kSeconds, 32);
    int nodes = 0;
    for (const CurveRow& row : result.curve) {
      if (row.velocity_mps <= 0.0 || row.velocity_mps > 0.02) continue;
      ++nodes;
      EXPECT_LE(std::abs(row.force_n - truck.coulomb_n), 3.0 * row.std_n) << row.velocity_mps;
    }
    EXPECT_GE(nodes, 5);
  }
}

}  // namespace
}  // namespace dampline::app
