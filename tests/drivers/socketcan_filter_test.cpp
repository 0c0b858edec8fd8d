// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <vector>

#include "drivers/socketcan/socket.hpp"

namespace dampline::drivers {
namespace {

/// What the kernel does with a filter (linux/can/raw.h).
bool passes(const std::vector<can_filter>& filters, std::uint32_t can_id) {
  for (const can_filter& filter : filters) {
    if ((can_id & filter.can_mask) == (filter.can_id & filter.can_mask)) return true;
  }
  return false;
}

TEST(FrameFilter, HasTheBytesThatTheKernelExpects) {
  const std::array<Identifier, 2> wanted{{{0x310, false}, {0x1ABCDEF0, true}}};
  const auto filters = make_filters(wanted);
  ASSERT_EQ(filters.size(), 2U);
  const std::array<std::uint32_t, 4> expected{0x310, 0xC00007FF, 0x9ABCDEF0, 0xDFFFFFFF};
  ASSERT_EQ(sizeof(expected), filters.size() * sizeof(can_filter));
  EXPECT_EQ(std::memcmp(filters.data(), expected.data(), sizeof(expected)), 0);
}

TEST(FrameFilter, LetsNeitherRemoteRequestsNorTheOtherFormatThrough) {
  const std::array<Identifier, 2> wanted{{{0x310, false}, {0x312, true}}};
  const auto filters = make_filters(wanted);
  EXPECT_TRUE(passes(filters, 0x310));
  EXPECT_TRUE(passes(filters, 0x312 | CAN_EFF_FLAG));
  EXPECT_FALSE(passes(filters, 0x310 | CAN_RTR_FLAG));
  EXPECT_FALSE(passes(filters, 0x310 | CAN_EFF_FLAG));
  EXPECT_FALSE(passes(filters, 0x312));
  EXPECT_FALSE(passes(filters, 0x312 | CAN_EFF_FLAG | CAN_RTR_FLAG));
  EXPECT_FALSE(passes(filters, 0x311));
}

TEST(FrameFilter, HoldsEachIdentifierOnce) {
  const std::array<Identifier, 5> wanted{
      {{5, false}, {3, false}, {5, true}, {5, false}, {3, false}}};
  EXPECT_EQ(make_filters(wanted).size(), 3U);
  EXPECT_TRUE(make_filters({}).empty());
}

}  // namespace
}  // namespace dampline::drivers
