// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <linux/can/raw.h>

#include <memory>
#include <vector>

#include "drivers/socketcan/sender.hpp"
#include "tests/drivers/manual_clock.hpp"
#include "tests/fault/can_kernel.hpp"
#include "tests/fault/fault_plan.hpp"

namespace dampline::fault {
namespace {

class CanSending : public ::testing::Test {
 protected:
  static constexpr std::int64_t kLookNs = 200'000'000;
  CanSending() {
    kernel_.add("can0");
    sender_ = std::move(drivers::CanSender::open("can0", clock_).value());
  }
  static std::vector<CanFrame> numbered(std::uint32_t count) {
    std::vector<CanFrame> frames(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      frames[i].id = i % 0x800;
      frames[i].length = 8;
    }
    return frames;
  }
  void expect_all_sent(std::uint32_t count) {
    ASSERT_EQ(kernel_.sent().size(), count);
    for (std::uint32_t i = 0; i < count; ++i) EXPECT_EQ(kernel_.sent()[i].can_id, i % 0x800);
  }

  CanKernel kernel_;
  ManualClock clock_;
  std::unique_ptr<drivers::CanSender> sender_;
};

TEST_F(CanSending, SendsInOrderAndReceivesNothing) {
  EXPECT_EQ(sender_->send(numbered(3000)), 3000U);
  expect_all_sent(3000);
  EXPECT_EQ(sender_->health().sent, 3000U);
  EXPECT_TRUE(kernel_.option(SOL_CAN_RAW, CAN_RAW_FILTER).empty());
}

TEST_F(CanSending, LeavesOutWhatIsNoFrame) {
  auto frames = numbered(3);
  frames[1].length = 9;
  EXPECT_EQ(sender_->send(frames), 2U);
  EXPECT_EQ(sender_->health().not_sent, 1U);
  EXPECT_EQ(sender_->last_errno(), EINVAL);
}

TEST_F(CanSending, SkipsCanFdWhereItCannotBeSent) {
  kernel_.forget_option(SOL_CAN_RAW, CAN_RAW_FD_FRAMES);
  sender_ = std::move(drivers::CanSender::open("can0", clock_).value());
  auto frames = numbered(5);
  frames[2].fd = true;
  EXPECT_EQ(sender_->send(frames), 4U);
  EXPECT_EQ(sender_->health().not_sent, 1U);
}

TEST_F(CanSending, WaitsForAFullQueueButNotForEver) {
  kernel_.set_transmit_room(10);
  const std::int64_t begin_ns = clock_.monotonic_ns();
  EXPECT_EQ(sender_->send(numbered(15)), 10U);
  EXPECT_EQ(clock_.monotonic_ns() - begin_ns, drivers::CanSender::kPatienceNs);
  EXPECT_EQ(sender_->health().not_sent, 5U);
  EXPECT_GT(sender_->health().retries, 0U);
  kernel_.set_transmit_room(1000);
  EXPECT_EQ(sender_->send(numbered(15)), 15U);
}

TEST_F(CanSending, CountsFramesWhileTheInterfaceIsDown) {
  kernel_.down("can0");
  {
    const ArmedFault counter{{.call = Call::kSendmmsg, .nth = kNever}};
    EXPECT_EQ(sender_->send(numbered(5)), 0U);
    EXPECT_EQ(counter.calls(), 2U) << "the first may tell what is past";
  }
  EXPECT_EQ(sender_->last_errno(), ENETDOWN);
  kernel_.up("can0");
  EXPECT_EQ(sender_->send(numbered(5)), 5U);
  kernel_.down("can0");
  kernel_.up("can0");  // the error is still to be told, but is past
  EXPECT_EQ(sender_->send(numbered(5)), 5U);
  EXPECT_EQ(sender_->health().not_sent, 5U);
  EXPECT_EQ(kernel_.sockets_opened(), 1U);
}

TEST_F(CanSending, OpensANewSocketWhenARemovedInterfaceIsBack) {
  kernel_.remove("can0");
  for (int i = 0; i < 10; ++i) EXPECT_EQ(sender_->send(numbered(1)), 0U);
  EXPECT_EQ(kernel_.sockets_opened(), 2U) << "looked once, not with every frame";
  kernel_.add("can0");
  clock_.advance(kLookNs);
  EXPECT_EQ(sender_->send(numbered(5)), 5U);
  EXPECT_EQ(sender_->health().not_sent, 10U);
  EXPECT_EQ(sender_->health().reopened, 1U);
}

TEST_F(CanSending, SaysThatTheInterfaceIsGoneWhateverFailedLast) {
  kernel_.remove("can0");
  EXPECT_EQ(sender_->send(numbered(1)), 0U);
  errno = EPERM;
  EXPECT_EQ(sender_->send(numbered(1)), 0U);
  EXPECT_EQ(sender_->last_errno(), ENODEV);
}

TEST_F(CanSending, BearsInterruptionsButNotForEver) {
  const ArmedFault fault{{.call = Call::kSendmmsg, .error = EINTR, .for_ever = true}};
  EXPECT_EQ(sender_->send(numbered(1)), 0U);
  EXPECT_EQ(fault.calls(), 1000U);
}

TEST_F(CanSending, AccountsForEveryFrameWhateverErrorEachCallGives) {
  for (int error = 1; error < 134; ++error) {
    for (const bool for_ever : {false, true}) {
      const auto before = sender_->health();
      const std::size_t sent_before = kernel_.sent().size();
      {
        const ArmedFault fault{{.call = Call::kSendmmsg, .error = error, .for_ever = for_ever}};
        static_cast<void>(sender_->send(numbered(4)));
      }
      const auto after = sender_->health();
      EXPECT_EQ(after.sent - before.sent, kernel_.sent().size() - sent_before) << error;
      EXPECT_EQ(after.sent - before.sent + after.not_sent - before.not_sent, 4U) << error;
      clock_.advance(kLookNs);
      EXPECT_EQ(sender_->send(numbered(4)), 4U) << error;
      clock_.advance(kLookNs);
    }
  }
}

TEST_F(CanSending, SaysWhyItCannotOpen) {
  sender_.reset();
  for (const Call call : {Call::kSocket, Call::kSetsockopt, Call::kIoctl, Call::kBind}) {
    const ArmedFault fault{{.call = call, .error = EPERM}};
    const auto opened = drivers::CanSender::open("can0", clock_);
    ASSERT_FALSE(opened.ok());
    EXPECT_EQ(opened.error_text().find("can0: "), 0U);
    EXPECT_EQ(kernel_.sockets_open(), 0U);
  }
  EXPECT_NE(drivers::CanSender::open("can9", clock_).error_text().find("no such interface"),
            std::string::npos);
}

}  // namespace
}  // namespace dampline::fault
