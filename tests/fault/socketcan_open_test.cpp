// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>

#include <cstring>

#include "tests/fault/socketcan_bus.hpp"

namespace dampline::fault {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SocketCanOpen : public SocketCanBus {
 protected:
  std::string open_error() {
    const auto opened = drivers::SocketCanSource::open(config(), clock_);
    return opened.ok() ? "no error" : opened.error_text();
  }
  [[nodiscard]] int option(int level, int name) const {
    int value = -1;
    const auto bytes = kernel_.option(level, name);
    std::memcpy(&value, bytes.data(), std::min(bytes.size(), sizeof(value)));
    return value;
  }
};

std::string setsockopt_call(int level, int name) {
  return "setsockopt " + std::to_string(level) + " " + std::to_string(name);
}

TEST_F(SocketCanOpen, SetsEverythingBeforeItBinds) {
  drivers::SocketCanConfig wanted = config();
  wanted.identifiers = {{0x310, false}};
  open(wanted);
  EXPECT_THAT(kernel_.calls(), ElementsAre("socket", setsockopt_call(SOL_CAN_RAW, CAN_RAW_FILTER),
                                           setsockopt_call(SOL_CAN_RAW, CAN_RAW_ERR_FILTER),
                                           setsockopt_call(SOL_CAN_RAW, CAN_RAW_FD_FRAMES),
                                           setsockopt_call(SOL_SOCKET, SO_RCVBUFFORCE),
                                           setsockopt_call(SOL_SOCKET, SO_TIMESTAMPING),
                                           setsockopt_call(SOL_SOCKET, SO_RXQ_OVFL), "bind"));
  EXPECT_EQ(option(SOL_CAN_RAW, CAN_RAW_ERR_FILTER), static_cast<int>(CAN_ERR_MASK));
  EXPECT_EQ(option(SOL_SOCKET, SO_TIMESTAMPING),
            SOF_TIMESTAMPING_SOFTWARE | SOF_TIMESTAMPING_RX_SOFTWARE |
                SOF_TIMESTAMPING_RAW_HARDWARE | SOF_TIMESTAMPING_RX_HARDWARE);
  EXPECT_EQ(kernel_.option(SOL_CAN_RAW, CAN_RAW_FILTER).size(), sizeof(can_filter));
  EXPECT_EQ(source_->receive_buffer_bytes(), 2 * wanted.receive_buffer_bytes);
}

TEST_F(SocketCanOpen, TakesEveryFrameWhereTheKernelCannotFilterSoMany) {
  drivers::SocketCanConfig wanted = config();
  for (std::uint32_t id = 0; id < 513; ++id) wanted.identifiers.push_back({id, false});
  open(wanted);
  EXPECT_TRUE(kernel_.option(SOL_CAN_RAW, CAN_RAW_FILTER).empty());
}

TEST_F(SocketCanOpen, NamesAnInterfaceThatDoesNotExist) {
  kernel_.remove("can0");
  EXPECT_THAT(open_error(), HasSubstr("can0: there is no such interface"));
  EXPECT_EQ(kernel_.sockets_open(), 0U);
}

TEST_F(SocketCanOpen, SaysThatAKernelHasNoCan) {
  const ArmedFault fault{{.call = Call::kSocket, .error = EAFNOSUPPORT}};
  EXPECT_THAT(open_error(), HasSubstr("can0: this kernel has no CAN sockets"));
}

TEST_F(SocketCanOpen, SaysThatThereIsNoSocketToBeHad) {
  const ArmedFault fault{{.call = Call::kSocket, .error = EMFILE}};
  EXPECT_THAT(open_error(), HasSubstr("can0: no CAN socket to be had: Too many open files"));
}

TEST_F(SocketCanOpen, DoesWithoutCanFdAndWithoutAForcedBuffer) {
  kernel_.forget_option(SOL_CAN_RAW, CAN_RAW_FD_FRAMES);
  kernel_.forget_option(SOL_SOCKET, SO_RCVBUFFORCE);
  open();
  receive(0x310);
  EXPECT_EQ(read_all().size(), 1U);
  EXPECT_EQ(option(SOL_SOCKET, SO_RCVBUF), config().receive_buffer_bytes);
}

TEST_F(SocketCanOpen, FallsBackToOlderStamps) {
  kernel_.forget_option(SOL_SOCKET, SO_TIMESTAMPING);
  open();
  receive(0x310);
  const std::int64_t first_ns = read_all().at(0).time_ns;
  EXPECT_EQ(first_ns, clock_.realtime_ns() - clock_.realtime_ns() % 1000);

  kernel_.forget_option(SOL_SOCKET, SO_TIMESTAMPNS);
  open();
  receive(0x310);
  const CanFrame second = read_all().at(0);
  EXPECT_EQ(second.time_ns, first_ns + kMs);
  EXPECT_EQ(second.time_source, TimeSource::kSoftware);

  kernel_.forget_option(SOL_SOCKET, SO_TIMESTAMP);
  EXPECT_THAT(open_error(), HasSubstr("can0: the kernel refuses SO_TIMESTAMP"));
}

/// Each call that opening makes fails once; the source must be refused with a reason, or work.
TEST_F(SocketCanOpen, SurvivesEachFailingCall) {
  for (const Call call :
       {Call::kSocket, Call::kSetsockopt, Call::kGetsockopt, Call::kBind, Call::kIoctl}) {
    for (std::uint64_t nth = 1;; ++nth) {
      ASSERT_LT(nth, 50U);
      const ArmedFault fault{{.call = call, .nth = nth, .error = EPERM}};
      auto opened = drivers::SocketCanSource::open(config(), clock_);
      if (fault.fired() == 0) break;
      if (!opened.ok()) {
        EXPECT_THAT(opened.error_text(), ::testing::StartsWith("can0: "));
        EXPECT_EQ(kernel_.sockets_open(), 0U);
        continue;
      }
      source_ = std::move(opened.value());
      receive(0x310);
      EXPECT_EQ(read_all().size(), 1U);
      source_.reset();
    }
  }
}

TEST_F(SocketCanOpen, WaitsForAnInterfaceThatIsDown) {
  kernel_.down("can0");
  open();
  EXPECT_TRUE(read_all().empty());
  EXPECT_TRUE(link_down());
  kernel_.up("can0");
  receive(0x310);
  EXPECT_EQ(read_all().size(), 1U);
  EXPECT_FALSE(link_down());
  EXPECT_THAT(event_kinds(), ElementsAre(hal::EventKind::kLinkDown, hal::EventKind::kLinkUp));
}

}  // namespace
}  // namespace dampline::fault
