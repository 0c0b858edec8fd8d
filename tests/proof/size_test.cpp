// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cstddef>
#include <iostream>
#include <type_traits>

#include "dampline/dampline.h"
#include "dampline/identifier.hpp"

namespace dampline::proof {
namespace {

constexpr std::size_t kKiB = 1024;

/// Prints a size, for docs/api.md, and holds it below a bound.
void expect_below(std::size_t bound, std::size_t size, const char* what) {
  std::cout << what << " = " << size << " bytes\n";
  EXPECT_LT(size, bound) << what;
}

TEST(Size, OfTheEstimateIsBelow512KiB) {
  expect_below(512 * kKiB, sizeof(Estimator), "sizeof(Estimator)");
  expect_below(512 * kKiB, sizeof(BasicIdentifier<kEstimateParts>), "corridor: estimate");
}

TEST(Size, OfTheCorridorIsBounded) {
  expect_below(1536 * kKiB, sizeof(EmbeddedIdentifier), "sizeof(EmbeddedIdentifier)");
  expect_below(1536 * kKiB, dampline_size(), "dampline_size()");
  expect_below(2048 * kKiB, sizeof(Identifier), "sizeof(Identifier)");
  expect_below(9984 * kKiB, sizeof(BasicIdentifier<kExplainParts>), "corridor: explain");
}

// The stack takes 17,092 bytes more on a Cortex-M7 (bench/cross/run).
TEST(Size, OfTheSmallEstimateLeavesItsStackRoomIn128KiB) {
  expect_below(110 * kKiB, sizeof(SmallIdentifier), "sizeof(SmallIdentifier)");
}

// Identifier::check(), level(), snapshot() and faults() return on the stack.
TEST(Size, OfWhatIsReturnedIsBelow5KiB) {
  expect_below(4 * kKiB, sizeof(IdentifierConfig), "sizeof(IdentifierConfig)");
  expect_below(4 * kKiB, sizeof(Snapshot), "sizeof(Snapshot)");
  expect_below(5 * kKiB, sizeof(FaultView), "sizeof(FaultView)");
  expect_below(320 * kKiB, sizeof(Statistics), "sizeof(Statistics), in memory of the caller's");
}

// A part that is not wanted takes a byte and its alignment.
TEST(Size, OfTheEstimateAloneIsThatOfEstimatorLowPassAndConfiguration) {
  EXPECT_LE(sizeof(BasicIdentifier<kEstimateParts>),
            sizeof(Estimator) + sizeof(ReferenceLowPass) + sizeof(IdentifierConfig) + 16);
}

TEST(Statistics, CanBeCopiedByteByByte) { EXPECT_TRUE(std::is_trivially_copyable_v<Statistics>); }

}  // namespace
}  // namespace dampline::proof
