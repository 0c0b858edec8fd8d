// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <algorithm>
#include <array>

#include "drivers/socketcan/message.hpp"

namespace dampline::drivers {
namespace {

using hal::EventKind;

canfd_frame wire_frame(std::uint32_t can_id, std::uint8_t length) {
  canfd_frame wire{};
  wire.can_id = can_id;
  wire.len = length;
  for (std::uint8_t i = 0; i < CANFD_MAX_DLEN; ++i) wire.data[i] = static_cast<std::uint8_t>(i + 1);
  return wire;
}

TEST(WireFrame, TakesTheTwoSizesOfAFrameAndNoOther) {
  for (std::size_t bytes = 0; bytes <= 80; ++bytes) {
    CanFrame frame;
    const bool taken = from_wire(wire_frame(0x123, 8), bytes, frame);
    EXPECT_EQ(taken, bytes == 16 || bytes == 72) << bytes;
    if (taken) {
      EXPECT_EQ(frame.fd, bytes == 72);
    }
  }
}

TEST(WireFrame, TakesNoPayloadLongerThanItsKindHas) {
  for (int length = 0; length <= 80; ++length) {
    CanFrame frame;
    const canfd_frame wire = wire_frame(0x123, static_cast<std::uint8_t>(length));
    EXPECT_EQ(from_wire(wire, CAN_MTU, frame), length <= 8) << length;
    EXPECT_EQ(from_wire(wire, CANFD_MTU, frame), length <= 64) << length;
  }
}

TEST(WireFrame, ReadsIdentifierFormatAndPayload) {
  CanFrame frame;
  frame.data.fill(0xEE);
  ASSERT_TRUE(from_wire(wire_frame(0x1ABCDEF0 | CAN_EFF_FLAG, 3), CAN_MTU, frame));
  EXPECT_EQ(frame.id, 0x1ABCDEF0U);
  EXPECT_TRUE(frame.extended);
  EXPECT_FALSE(frame.remote || frame.error || frame.fd);
  EXPECT_EQ(frame.length, 3);
  EXPECT_EQ(frame.data[2], 3);
  EXPECT_TRUE(std::all_of(frame.data.begin() + 3, frame.data.end(), [](auto b) { return b == 0; }));
}

TEST(WireFrame, ReadsARemoteRequestWithoutData) {
  CanFrame frame;
  ASSERT_TRUE(from_wire(wire_frame(0x123 | CAN_RTR_FLAG, 4), CAN_MTU, frame));
  EXPECT_TRUE(frame.remote);
  EXPECT_EQ(frame.length, 4);
  EXPECT_EQ(frame.data[0], 0);
}

TEST(WireFrame, SurvivesTheWayToTheKernelAndBack) {
  for (const bool fd : {false, true}) {
    for (const std::uint8_t length : std::to_array<std::uint8_t>({0, 1, 7, 8, 12, 20, 48, 64})) {
      if (!fd && length > 8) continue;
      for (const bool extended : {false, true}) {
        CanFrame frame;
        frame.id = extended ? 0x1FFFFFFF : 0x7FF;
        frame.extended = extended;
        frame.fd = fd;
        frame.fd_flags = fd ? CANFD_BRS : 0;
        frame.length = length;
        std::fill_n(frame.data.begin(), length, std::uint8_t{0xA5});
        canfd_frame wire{};
        const std::size_t bytes = to_wire(frame, wire);
        ASSERT_EQ(bytes, fd ? CANFD_MTU : CAN_MTU);
        CanFrame back;
        ASSERT_TRUE(from_wire(wire, bytes, back));
        EXPECT_EQ(back.id, frame.id);
        EXPECT_EQ(back.extended, extended);
        EXPECT_EQ(back.fd, fd);
        EXPECT_EQ(back.fd_flags, frame.fd_flags);
        EXPECT_EQ(back.length, length);
        EXPECT_EQ(back.data, frame.data);
      }
    }
  }
}

TEST(WireFrame, PadsCanFdToTheNextLengthAndRefusesWhatIsNoFrame) {
  canfd_frame wire{};
  CanFrame frame;
  frame.fd = true;
  frame.length = 33;
  EXPECT_EQ(to_wire(frame, wire), CANFD_MTU);
  EXPECT_EQ(wire.len, 48);
  frame.length = 65;
  EXPECT_EQ(to_wire(frame, wire), 0U);
  frame = {};
  frame.length = 9;
  EXPECT_EQ(to_wire(frame, wire), 0U);
  frame.length = 8;
  frame.id = 0x800;
  EXPECT_EQ(to_wire(frame, wire), 0U);
}

CanFrame error_frame(std::uint32_t classes) {
  CanFrame frame;
  EXPECT_TRUE(from_wire(wire_frame(classes | CAN_ERR_FLAG, 8), CAN_MTU, frame));
  frame.time_ns = 77;
  return frame;
}

TEST(ErrorFrame, TellsEachClass) {
  for (std::uint32_t bit = 0; bit < 10; ++bit) {
    const std::uint32_t classes = 1U << bit;
    const CanFrame frame = error_frame(classes);
    EXPECT_TRUE(frame.error);
    EXPECT_FALSE(frame.extended);
    const ErrorEvents told = error_events(frame);
    ASSERT_EQ(told.count, 1U) << classes;
    EXPECT_EQ(told.events[0].time_ns, 77);
    if (classes == CAN_ERR_BUSOFF) {
      EXPECT_EQ(told.events[0].kind, EventKind::kBusOff);
      EXPECT_EQ(told.events[0].value, 0);
    } else if (classes == CAN_ERR_RESTARTED) {
      EXPECT_EQ(told.events[0].kind, EventKind::kBusRestarted);
    } else {
      EXPECT_EQ(told.events[0].kind, EventKind::kBusError);
      EXPECT_EQ(told.events[0].value, classes);
    }
  }
}

TEST(ErrorFrame, TellsSeveralClassesAtOnceAndNothingOfADataFrame) {
  const ErrorEvents told =
      error_events(error_frame(CAN_ERR_BUSOFF | CAN_ERR_ACK | CAN_ERR_CRTL | CAN_ERR_RESTARTED));
  ASSERT_EQ(told.count, 3U);
  EXPECT_EQ(told.events[0].kind, EventKind::kBusOff);
  EXPECT_EQ(told.events[1].kind, EventKind::kBusError);
  EXPECT_EQ(told.events[1].value, CAN_ERR_ACK | CAN_ERR_CRTL);
  EXPECT_EQ(told.events[2].kind, EventKind::kBusRestarted);
  CanFrame data;
  data.id = CAN_ERR_BUSOFF;
  EXPECT_EQ(error_events(data).count, 0U);
}

}  // namespace
}  // namespace dampline::drivers
