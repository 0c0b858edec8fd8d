// SPDX-License-Identifier: MIT
// The contract of hal::FrameSource over SocketCanSource, on the modelled kernel and by the real
// clock.
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <memory>

#include "drivers/os/system_clock.hpp"
#include "drivers/socketcan/source.hpp"
#include "tests/contract/frame_source_contract.hpp"
#include "tests/fault/can_kernel.hpp"

namespace dampline {
namespace {

/// With error frames, which are told as events, among the others.
class ModelledBus {
 public:
  ModelledBus() {
    kernel_.add("can0");
    source_ = std::move(drivers::SocketCanSource::open(
                            {.interface = "can0", .run_time = hal::RunTime::start(clock_)}, clock_)
                            .value());
    for (std::size_t i = 0; i < kContractFrames; ++i) send(i % 50 == 49);
  }
  hal::FrameSource& source() { return *source_; }
  void down() { kernel_.down("can0"); }
  void up() {
    kernel_.up("can0");
    send(false);
  }

 private:
  void send(bool error) {
    const auto id = static_cast<std::uint32_t>(error ? CAN_ERR_FLAG | CAN_ERR_BUSOFF : 0x310);
    kernel_.receive(id, 0, clock_.realtime_ns());
  }

  fault::CanKernel kernel_;
  drivers::SystemClock clock_;
  std::unique_ptr<drivers::SocketCanSource> source_;
};

INSTANTIATE_TYPED_TEST_SUITE_P(SocketCan, FrameSourceContract, ModelledBus);

}  // namespace
}  // namespace dampline
