// SPDX-License-Identifier: MIT
#include "tests/proof/symbols.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dampline::proof {
namespace {

using ::testing::Contains;
using ::testing::IsEmpty;
using ::testing::Not;

// Of the optimised build only: assertions print, sanitizers call their run-time library.
#ifdef DAMPLINE_IS_RELEASE
TEST(CoreLibrary, NeedsNothingThatAllocatesThrowsPrintsOrAsksTheSystem) {
  ASSERT_THAT(needed_symbols(DAMPLINE_CORE_ARCHIVE), Contains("memcpy"))
      << "the list of symbols is not that of a library with code in it";
  EXPECT_THAT(forbidden_symbols(DAMPLINE_CORE_ARCHIVE), IsEmpty());
  EXPECT_THAT(forbidden_symbols(DAMPLINE_PUBLISHED_ARCHIVE), IsEmpty());
}
#endif

TEST(CoreLibrary, IsCheckedByAToolThatSeesAllocationExceptionsAndOutput) {
  const std::set<std::string> seen = forbidden_symbols(DAMPLINE_CONTROL_ARCHIVE);
  EXPECT_THAT(seen, Contains("_Znwm"));  // operator new
  EXPECT_THAT(seen, Contains("malloc"));
  EXPECT_THAT(seen, Contains("__cxa_throw"));
  EXPECT_THAT(seen, Contains("__cxa_guard_acquire"));
  EXPECT_THAT(seen, Contains("clock_gettime"));
  EXPECT_THAT(seen, Contains("puts"));
}

TEST(CoreLibrary, IsNotTakenForCleanWhereThereIsNone) {
  EXPECT_THROW(static_cast<void>(forbidden_symbols("/nonexistent.a")), std::runtime_error);
}

}  // namespace
}  // namespace dampline::proof
