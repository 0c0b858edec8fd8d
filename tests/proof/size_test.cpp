// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <iostream>
#include <type_traits>

#include "dampline/damping/estimator.hpp"

namespace dampline::proof {
namespace {

TEST(IdentifierSize, IsBelow512KiB) {
  std::cout << "sizeof(Estimator) = " << sizeof(Estimator)
            << " bytes, sizeof(Snapshot) = " << sizeof(Snapshot)
            << " bytes, sizeof(Statistics) = " << sizeof(Statistics) << " bytes\n";
  EXPECT_LT(sizeof(Estimator), 512U * 1024U);
}

TEST(Statistics, CanBeCopiedByteByByte) { EXPECT_TRUE(std::is_trivially_copyable_v<Statistics>); }

}  // namespace
}  // namespace dampline::proof
