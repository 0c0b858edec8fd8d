// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <linux/can/error.h>

#include "tests/fault/socketcan_bus.hpp"

namespace dampline::fault {
namespace {

using hal::EventKind;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

using SocketCanSource = SocketCanBus;

TEST_F(SocketCanSource, DeliversABurstInOrder) {
  open();
  for (int i = 0; i < 1000; ++i) receive(0x310, static_cast<std::uint8_t>(i));
  const auto frames = read_all();
  ASSERT_EQ(frames.size(), 1000U);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].data[0], static_cast<std::uint8_t>(i));
    if (i > 0) {
      EXPECT_EQ(frames[i].time_ns - frames[i - 1].time_ns, kMs);
    }
  }
  EXPECT_EQ(source_->health().frames, 1000U);
  EXPECT_FALSE(link_down());
}

TEST_F(SocketCanSource, TakesOnlyTheIdentifiersAskedFor) {
  drivers::SocketCanConfig wanted = config();
  wanted.identifiers = {{0x310, false}, {0x312, true}};
  open(wanted);
  for (const std::uint32_t id : {0x310U, 0x311U, 0x312U, 0x310U | CAN_EFF_FLAG,
                                 0x312U | CAN_EFF_FLAG, 0x310U | CAN_RTR_FLAG}) {
    receive(id);
  }
  const auto frames = read_all();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[1].id, 0x312U);
  EXPECT_TRUE(frames[1].extended);
}

TEST_F(SocketCanSource, CountsWhatIsNoFrameAndGoesOn) {
  open();
  canfd_frame frame{};
  for (std::size_t bytes = 0; bytes <= 80; ++bytes) {
    clock_.advance(kMs);
    kernel_.receive(frame, bytes, {clock_.realtime_ns(), 0});
  }
  frame.len = 9;
  kernel_.receive(frame, CAN_MTU, {clock_.realtime_ns(), 0});
  // What is longer than a frame is cut by the buffer, and then looks like one.
  EXPECT_EQ(read_all().size(), 1U + 9U);
  EXPECT_EQ(source_->health().malformed, 82U - 10U);
}

TEST_F(SocketCanSource, AccountsForEveryDroppedFrame) {
  kernel_.set_room(100);
  open();
  for (int i = 0; i < 5000; ++i) receive(0x310);
  EXPECT_EQ(read_all().size(), 100U);
  EXPECT_EQ(source_->health().dropped, 0U);  // not told yet
  receive(0x310);
  EXPECT_EQ(read_all().size(), 1U);
  EXPECT_EQ(source_->health().dropped, 4900U);
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kFramesDropped));
  EXPECT_EQ(last_value_, 4900);
  for (int i = 0; i < 150; ++i) receive(0x310);
  EXPECT_EQ(read_all().size(), 100U);
  receive(0x310);
  EXPECT_EQ(read_all().size(), 1U);
  EXPECT_EQ(source_->health().dropped, 4950U);
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kFramesDropped));
  EXPECT_EQ(last_value_, 50);
}

TEST_F(SocketCanSource, CountsDropsOverANewSocket) {
  kernel_.set_room(10);
  open();
  for (int i = 0; i < 15; ++i) receive(0x310);
  EXPECT_EQ(read_all().size(), 10U);
  kernel_.remove("can0");  // the 5 have not been told by a frame
  EXPECT_TRUE(read_all().empty());
  EXPECT_EQ(source_->health().dropped, 5U);
  kernel_.add("can0");
  read_all();
  for (int i = 0; i < 13; ++i) receive(0x310);
  EXPECT_EQ(read_all().size(), 10U);
  receive(0x310);
  EXPECT_EQ(read_all().size(), 1U);
  EXPECT_EQ(source_->health().dropped, 8U);
}

TEST_F(SocketCanSource, StatesWhichClockStampedAFrame) {
  open();
  canfd_frame frame{};
  clock_.advance(kMs);
  kernel_.receive(frame, CAN_MTU, {clock_.realtime_ns(), 1'000'000});
  kernel_.receive(frame, CAN_MTU, {clock_.realtime_ns(), 1'500'000});
  kernel_.receive(frame, CANFD_MTU, {clock_.realtime_ns(), 0});
  kernel_.receive(frame, CAN_MTU, {0, 0});
  kernel_.receive(frame, CAN_MTU, {0, 0});
  const auto frames = read_all();
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_EQ(frames[0].time_source, TimeSource::kHardware);
  EXPECT_NEAR(static_cast<double>(frames[1].time_ns - frames[0].time_ns), 500e3, 1000.0);
  EXPECT_EQ(frames[2].time_source, TimeSource::kSoftware);
  EXPECT_TRUE(frames[2].fd);
  EXPECT_EQ(frames[3].time_source, TimeSource::kUnknown);
  EXPECT_EQ(source_->health().hardware_times, 2U);
}

TEST_F(SocketCanSource, TellsErrorFrames) {
  open();
  receive(CAN_ERR_FLAG | CAN_ERR_BUSOFF);
  receive(CAN_ERR_FLAG | CAN_ERR_RESTARTED);
  receive(CAN_ERR_FLAG | CAN_ERR_ACK);
  const auto frames = read_all();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(frames[0].error);
  EXPECT_EQ(frames[2].id, CAN_ERR_ACK);
  EXPECT_THAT(event_kinds(),
              ElementsAre(EventKind::kBusOff, EventKind::kBusRestarted, EventKind::kBusError));
  EXPECT_EQ(last_value_, CAN_ERR_ACK);
  const hal::SourceHealth health = source_->health();
  EXPECT_EQ(health.error_frames, 3U);
  EXPECT_EQ(health.bus_offs, 1U);
  EXPECT_EQ(health.restarts, 1U);
  EXPECT_TRUE(health.link_up);
}

TEST_F(SocketCanSource, TellsAStepOfTheWallClockOnASilentBus) {
  open();
  read_all();
  clock_.step_wall(3'600'000 * kMs);
  EXPECT_TRUE(read_all().empty());
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kClockStep));
}

TEST_F(SocketCanSource, TellsAStepOfTheWallClockBehindTheFramesBeforeIt) {
  kernel_.set_room(10);
  open();
  for (int i = 0; i < 11; ++i) receive(0x310);
  read_all();
  receive(0x310);
  clock_.step_wall(3'600'000 * kMs);
  receive(0x310);
  const auto frames = read_all();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_NEAR(static_cast<double>(frames[1].time_ns - frames[0].time_ns), 1e6, 1000.0);
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kFramesDropped, EventKind::kClockStep));
  EXPECT_NEAR(static_cast<double>(last_value_), 3600e9, 1000.0);
  EXPECT_EQ(source_->health().clock_steps, 1U);
  EXPECT_EQ(source_->health().reordered, 0U);
}

TEST_F(SocketCanSource, HandsOutNoMoreThanThereIsSpaceFor) {
  open();
  for (int i = 0; i < 7; ++i) receive(0x310, static_cast<std::uint8_t>(i));
  EXPECT_EQ(source_->read({}).value(), 0U);
  std::array<CanFrame, 3> few;
  EXPECT_EQ(source_->read(few).value(), 3U);
  EXPECT_EQ(source_->read(few).value(), 3U);
  EXPECT_EQ(few[0].data[0], 3);
  EXPECT_EQ(source_->read(few).value(), 1U);
  EXPECT_EQ(source_->read(few).value(), 0U);
  EXPECT_THAT(event_kinds(), IsEmpty());
}

TEST_F(SocketCanSource, KnowsTheTimeOfItsFrames) {
  open();
  receive(0x310);
  const std::int64_t now_ns = source_->now_ns().value();
  EXPECT_NEAR(static_cast<double>(now_ns - read_all().at(0).time_ns), 0.0, 1000.0);
}

}  // namespace
}  // namespace dampline::fault
