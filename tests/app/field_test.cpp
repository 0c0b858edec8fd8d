// SPDX-License-Identifier: MIT
// Faults of sensors and of their transport on trucks by a simulation that shares nothing with the
// program. bench/field has all of them on more records.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/app/plain_faults.hpp"

namespace dampline::app {
namespace {

using test::kPlainTrucks;
using test::PlainFaultCase;

constexpr double kFieldS = 150.0;

/// One motion of the empty truck bears every fault; the mass alone is declared.
class FieldFaults : public testing::Test {
 protected:
  const test::PlainTruck& truck_ = kPlainTrucks.back();
  test::PlainMotion motion_ = test::plain_motion(truck_, {}, kFieldS + 0.1, 71);

  [[nodiscard]] test::PlainExplained with(const std::string& name) const {
    std::vector<PlainFaultCase> all = test::plain_value_faults(kFieldS);
    const auto timing = test::plain_timing_faults(kFieldS);
    all.insert(all.end(), timing.begin(), timing.end());
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const auto& each) { return each.name == name; });
    right_ = found->right;
    return test::explained_with(truck_, motion_, *found, 7101, kFieldS, found->needs_all);
  }
  void expect_named(const std::string& name) const {
    const auto found = with(name);
    EXPECT_TRUE(std::any_of(right_.begin(), right_.end(), [&](FaultKind kind) {
      return found.has_fault(name_of(kind));
    })) << name;
    EXPECT_FALSE(found.names_effect()) << name;
    EXPECT_FALSE(found.result.faults.drift) << name;
  }
  /// Level within `most` of the truth and three deviations.
  void expect_harmless(const std::string& name, double most) const {
    const auto found = with(name);
    EXPECT_FALSE(found.names_effect()) << name;
    const Parameter* const level = find_parameter(found.result.parameters, "coulomb");
    ASSERT_NE(level, nullptr) << name;
    EXPECT_NEAR(level->value, truck_.coulomb_n, most * truck_.coulomb_n) << name;
    EXPECT_NEAR(level->value, truck_.coulomb_n, 3.0 * level->std) << name;
  }

 private:
  mutable std::vector<FaultKind> right_;
};

TEST_F(FieldFaults, AreNamed) {
  for (const char* const name :
       {"noise burst", "gain step of the frame 3-10 %", "1-3 samples lost, all channels",
        "timing step 1-8 ms", "a low pass higher than declared", "frame behind 45-80 Hz",
        "one wheelset behind 45-80 Hz", "both wheelsets behind 45-80 Hz"})
    expect_named(name);
}

TEST_F(FieldFaults, OrLeaveTheLevelAsItIs) {
  expect_harmless("resolution lost, 2-4 bits", 0.02);
  expect_harmless("1 % lost, of each channel", 0.015);
  expect_harmless("5 % lost, of each channel", 0.05);
}

}  // namespace
}  // namespace dampline::app
