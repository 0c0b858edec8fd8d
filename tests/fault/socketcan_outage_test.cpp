// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include "drivers/os/system_clock.hpp"
#include "tests/fault/socketcan_bus.hpp"

namespace dampline::fault {
namespace {

using hal::EventKind;
using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class SocketCanOutage : public SocketCanBus {
 protected:
  SocketCanOutage() { open(); }
};

TEST_F(SocketCanOutage, KeepsItsSocketWhileTheInterfaceIsDown) {
  receive(0x310, 1);
  kernel_.down("can0");
  EXPECT_EQ(read_all().size(), 1U) << "what was queued comes first";
  EXPECT_TRUE(link_down());
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kLinkDown));
  EXPECT_TRUE(read_all().empty());
  EXPECT_TRUE(link_down());
  EXPECT_THAT(event_kinds(), IsEmpty());
  EXPECT_FALSE(source_->health().link_up);
  kernel_.up("can0");
  receive(0x310, 2);
  EXPECT_EQ(read_all().at(0).data[0], 2);
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kLinkUp));
  EXPECT_EQ(kernel_.sockets_opened(), 1U);
  EXPECT_EQ(source_->health().link_downs, 1U);
  EXPECT_EQ(source_->health().reopened, 0U);
}

TEST_F(SocketCanOutage, NoticesAnInterfaceThatWasDownForAMomentOnly) {
  kernel_.down("can0");
  kernel_.up("can0");
  receive(0x310);
  EXPECT_EQ(read_all().size(), 1U);
  EXPECT_TRUE(read_all().empty());
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kLinkDown, EventKind::kLinkUp));
  EXPECT_TRUE(source_->health().link_up);
}

TEST_F(SocketCanOutage, OpensANewSocketWhenARemovedInterfaceIsBack) {
  receive(0x310, 1);
  kernel_.remove("can0");
  EXPECT_EQ(read_all().size(), 1U);
  EXPECT_TRUE(link_down());
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kLinkDown, EventKind::kInterfaceRemoved));
  EXPECT_EQ(kernel_.sockets_open(), 0U);
  for (int i = 0; i < 5; ++i) {
    clock_.advance(kLookNs);
    EXPECT_TRUE(read_all().empty());
  }
  EXPECT_EQ(kernel_.sockets_open(), 0U);
  kernel_.add("can0", false);
  clock_.advance(kLookNs);
  EXPECT_TRUE(read_all().empty());
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kInterfaceBack));
  kernel_.up("can0");
  receive(0x310, 2);
  EXPECT_EQ(read_all().at(0).data[0], 2);
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kLinkUp));
  EXPECT_EQ(source_->health().link_downs, 1U);
  EXPECT_EQ(source_->health().reopened, 1U);
}

TEST_F(SocketCanOutage, LooksForARemovedInterfaceFiveTimesASecondOnly) {
  kernel_.remove("can0");
  read_all();
  clock_.advance(kLookNs);
  const ArmedFault looks{{.call = Call::kSocket, .nth = kNever}};
  for (int i = 0; i < 1000; ++i) {
    clock_.advance(kMs);
    static_cast<void>(source_->read(frames_));
  }
  EXPECT_GE(looks.calls(), 4U);
  EXPECT_LE(looks.calls(), 6U);
}

TEST_F(SocketCanOutage, LooksAtOnceForAnInterfaceThatGoesAgain) {
  kernel_.remove("can0");
  read_all();
  kernel_.add("can0");
  clock_.advance(kLookNs);
  read_all();
  EXPECT_EQ(kernel_.sockets_open(), 1U);
  kernel_.remove("can0");
  kernel_.add("can0");
  read_all();
  read_all();
  receive(0x310, 7);
  EXPECT_EQ(read_all().at(0).data[0], 7) << "no time has passed";
}

TEST_F(SocketCanOutage, NoticesAnInterfaceThatWasReplacedWhileItWasDown) {
  kernel_.down("can0");
  read_all();
  kernel_.remove("can0");  // down already: the socket hears ENODEV
  kernel_.add("can0");
  kernel_.fail_sockets(0);  // but let it not hear it
  read_all();
  clock_.advance(kLookNs);
  read_all();
  EXPECT_THAT(event_kinds(), ElementsAre(EventKind::kLinkDown, EventKind::kInterfaceRemoved,
                                         EventKind::kInterfaceBack, EventKind::kLinkUp));
  receive(0x310);
  EXPECT_EQ(read_all().size(), 1U);
}

TEST_F(SocketCanOutage, KeepsRunTimeOverAnOutage) {
  receive(0x310);
  const std::int64_t first_ns = read_all().at(0).time_ns;
  kernel_.remove("can0");
  read_all();
  clock_.step_wall(-3'600'000 * kMs);
  kernel_.add("can0");
  clock_.advance(kLookNs);
  read_all();
  receive(0x310);
  EXPECT_NEAR(static_cast<double>(read_all().at(0).time_ns - first_ns), 201e6, 3000.0);
}

/// The Nth recvmmsg fails with each error that there is; all frames must come in the end, an
/// outage must have been told where one was made.
TEST_F(SocketCanOutage, SurvivesEveryErrorOfEveryRead) {
  for (int error = 1; error < 134; ++error) {
    for (std::uint64_t nth = 1; nth <= 3; ++nth) {
      const std::uint64_t before = source_->health().link_downs;
      const std::size_t opened = kernel_.sockets_opened();
      std::size_t frames = 0;
      {
        const ArmedFault fault{{.call = Call::kRecvmmsg, .nth = nth, .error = error}};
        for (int i = 0; i < 4; ++i) {
          receive(0x310);
          frames += read_all().size();
        }
        EXPECT_EQ(fault.fired(), 1U);
      }
      for (int i = 0; i < 3; ++i) {
        clock_.advance(kLookNs);
        frames += read_all().size();
      }
      receive(0x310);
      EXPECT_EQ(read_all().size(), 1U) << error;
      EXPECT_TRUE(source_->health().link_up) << error;
      const bool lost = frames < 4;
      if (lost) {  // with the socket's queue
        EXPECT_EQ(source_->health().link_downs, before + 1) << error;
        EXPECT_EQ(kernel_.sockets_opened(), opened + 1) << error;
      }
    }
  }
}

TEST_F(SocketCanOutage, SurvivesErrorsThatDoNotEnd) {
  for (const int error : {EAGAIN, EINTR, ENOMEM, ENOBUFS, ENETDOWN, ENODEV, ENXIO, EBADF, EIO}) {
    {
      const ArmedFault fault{{.call = Call::kRecvmmsg, .error = error, .for_ever = true}};
      for (int i = 0; i < 5; ++i) {
        receive(0x310);
        EXPECT_TRUE(read_all().empty());
        clock_.advance(kLookNs);
      }
    }
    for (int i = 0; i < 3; ++i) {
      clock_.advance(kLookNs);
      read_all();
    }
    receive(0x310);
    EXPECT_EQ(read_all().size(), 1U) << error;
  }
}

TEST_F(SocketCanOutage, SaysWhatTheKernelRefused) {
  EXPECT_EQ(source_->error_text(), "");
  const ArmedFault fault{{.call = Call::kRecvmmsg, .error = EIO}};
  read_all();
  EXPECT_TRUE(link_down());
  EXPECT_EQ(source_->error_text(), "can0: recvmmsg: Input/output error");
}

TEST_F(SocketCanOutage, TriesAgainWhereANewSocketIsRefused) {
  for (const Call call : {Call::kSocket, Call::kSetsockopt, Call::kBind, Call::kIoctl}) {
    kernel_.remove("can0");
    read_all();
    kernel_.add("can0");
    {
      const ArmedFault fault{{.call = call, .error = EMFILE, .for_ever = true}};
      for (int i = 0; i < 3; ++i) {
        clock_.advance(kLookNs);
        EXPECT_TRUE(read_all().empty());
        EXPECT_TRUE(link_down());
        EXPECT_EQ(kernel_.sockets_open(), 0U);
      }
    }
    clock_.advance(kLookNs);
    read_all();
    receive(0x310);
    EXPECT_EQ(read_all().size(), 1U);
  }
}

/// wait() with the real clock.
class SocketCanWait : public ::testing::Test {
 protected:
  SocketCanWait() {
    kernel_.add("can0");
    source_ = std::move(drivers::SocketCanSource::open(
                            {.interface = "can0", .run_time = hal::RunTime::start(clock_)}, clock_)
                            .value());
  }
  [[nodiscard]] bool wait(milliseconds timeout) { return source_->wait(timeout).value(); }
  [[nodiscard]] Errc read_error() { return source_->read(frames_).error(); }

  CanKernel kernel_;
  drivers::SystemClock clock_;
  std::unique_ptr<drivers::SocketCanSource> source_;
  std::array<CanFrame, 8> frames_;
};

TEST_F(SocketCanWait, EndsWithAFrameOrWithTheTime) {
  const std::int64_t begin_ns = clock_.monotonic_ns();
  EXPECT_FALSE(wait(milliseconds{20}));
  EXPECT_GE(clock_.monotonic_ns(), begin_ns + 20'000'000);
  kernel_.receive(0x310, 0, clock_.realtime_ns());
  EXPECT_TRUE(wait(milliseconds{10'000}));
  EXPECT_TRUE(wait(milliseconds{0}));
  EXPECT_EQ(source_->read(frames_).value(), 1U);
  EXPECT_FALSE(wait(milliseconds{0}));
}

TEST_F(SocketCanWait, EndsWithAnOutageAndWithItsEnd) {
  kernel_.down("can0");
  EXPECT_TRUE(wait(milliseconds{10'000}));
  EXPECT_EQ(read_error(), Errc::kLinkDown);
  EXPECT_FALSE(wait(milliseconds{1})) << "nothing new";
  kernel_.up("can0");
  EXPECT_TRUE(wait(milliseconds{10'000}));
  EXPECT_EQ(source_->read(frames_).value(), 0U);
  kernel_.remove("can0");
  EXPECT_TRUE(wait(milliseconds{10'000}));
  EXPECT_EQ(read_error(), Errc::kLinkDown);
  EXPECT_FALSE(wait(milliseconds{250}));
  kernel_.add("can0");
  EXPECT_TRUE(wait(milliseconds{10'000}));
  EXPECT_EQ(source_->read(frames_).value(), 0U);
  EXPECT_TRUE(source_->health().link_up);
}

TEST_F(SocketCanWait, CountsDropsThatNoFrameTells) {
  kernel_.set_room(2);
  for (int i = 0; i < 5; ++i) kernel_.receive(0x310, 0, clock_.realtime_ns());
  EXPECT_EQ(source_->read(frames_).value(), 2U);
  EXPECT_EQ(source_->health().dropped, 0U);
  EXPECT_TRUE(wait(milliseconds{1})) << "an event";
  EXPECT_EQ(source_->health().dropped, 3U);
  EXPECT_FALSE(wait(milliseconds{1}));
  kernel_.receive(0x310, 0, clock_.realtime_ns());
  EXPECT_EQ(source_->read(frames_).value(), 1U);
  EXPECT_EQ(source_->health().dropped, 3U);
}

TEST_F(SocketCanWait, ReadsAllTheSameWherePollingFails) {
  kernel_.receive(0x310, 0, clock_.realtime_ns());
  const std::int64_t begin_ns = clock_.monotonic_ns();
  const ArmedFault fault{{.call = Call::kPpoll, .error = ENOMEM, .for_ever = true}};
  EXPECT_TRUE(wait(milliseconds{10'000}));
  EXPECT_GE(clock_.monotonic_ns(), begin_ns + 5'000'000) << "not without a pause";
  EXPECT_EQ(source_->read(frames_).value(), 1U);
  EXPECT_EQ(source_->error_text(), "can0: ppoll: Cannot allocate memory");
}

TEST_F(SocketCanWait, IsCutShortByASignal) {
  const ArmedFault fault{{.call = Call::kPpoll, .error = EINTR}};
  EXPECT_FALSE(wait(milliseconds{60'000}));
}

}  // namespace
}  // namespace dampline::fault
