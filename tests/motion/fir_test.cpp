// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "dampline/motion/anti_alias.hpp"

namespace dampline {
namespace {

TEST(Fir, WeighsTheSamplesAroundTheCentre) {
  Fir<2> fir{{1.0, 10.0, 100.0, 1000.0, 10000.0}};
  double out = -1.0;
  // Tap k weighs the sample k before the centre: the newest sample has the first tap.
  for (const double x : {1.0, 2.0, 3.0, 4.0}) EXPECT_FALSE(fir.update(x, out));
  ASSERT_TRUE(fir.update(5.0, out));
  EXPECT_EQ(out, 5.0 * 1 + 4.0 * 10 + 3.0 * 100 + 2.0 * 1000 + 1.0 * 10000);
  ASSERT_TRUE(fir.update(6.0, out));
  EXPECT_EQ(out, 6.0 * 1 + 5.0 * 10 + 4.0 * 100 + 3.0 * 1000 + 2.0 * 10000);
}

TEST(Fir, IsHalfItsLengthLate) {
  Fir<3> fir{{0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0}};
  double out = 0.0;
  for (int n = 0; n < 20; ++n) {
    if (fir.update(n, out)) {
      EXPECT_EQ(out, n - Fir<3>::kDelay);
    }
  }
}

TEST(Fir, ForgetsEverythingAtAReset) {
  Fir<1> fir{{1.0, 1.0, 1.0}};
  double out = 0.0;
  for (int n = 0; n < 5; ++n) static_cast<void>(fir.update(1e6, out));
  fir.reset();
  EXPECT_FALSE(fir.update(1.0, out));
  EXPECT_FALSE(fir.update(1.0, out));
  ASSERT_TRUE(fir.update(1.0, out));
  EXPECT_EQ(out, 3.0);
}

}  // namespace
}  // namespace dampline
