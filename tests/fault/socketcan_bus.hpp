// SPDX-License-Identifier: MIT
#pragma once
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "drivers/socketcan/source.hpp"
#include "tests/drivers/manual_clock.hpp"
#include "tests/fault/can_kernel.hpp"
#include "tests/fault/fault_plan.hpp"

namespace dampline::fault {

/// A modelled bus can0 with a source on it, and a clock that the test moves. Use read() only: a
/// wait would not end.
class SocketCanBus : public ::testing::Test {
 protected:
  static constexpr std::int64_t kMs = 1'000'000;
  static constexpr std::int64_t kLookNs = 200 * kMs;

  SocketCanBus() { kernel_.add("can0"); }
  [[nodiscard]] drivers::SocketCanConfig config() const {
    return {.interface = "can0", .run_time = hal::RunTime::start(clock_)};
  }
  void open() { open(config()); }
  void open(const drivers::SocketCanConfig& config) {
    auto opened = drivers::SocketCanSource::open(config, clock_);
    ASSERT_TRUE(opened.ok()) << opened.error_text();
    source_ = std::move(opened.value());
  }
  /// A frame now.
  void receive(std::uint32_t can_id, std::uint8_t first_byte = 0) {
    clock_.advance(kMs);
    kernel_.receive(can_id, first_byte, clock_.realtime_ns());
  }
  /// Frames that a read gives, all of them.
  std::vector<CanFrame> read_all() {
    std::vector<CanFrame> all;
    for (;;) {
      const Result<std::size_t> count = source_->read(frames_);
      last_error_ = count.ok() ? Errc::kNotReady : count.error();
      if (!count.ok() || count.value() == 0) return all;
      all.insert(all.end(), frames_.begin(),
                 frames_.begin() + static_cast<std::ptrdiff_t>(count.value()));
    }
  }
  [[nodiscard]] bool link_down() const { return last_error_ == Errc::kLinkDown; }
  std::vector<hal::EventKind> event_kinds() {
    std::vector<hal::EventKind> kinds;
    hal::Event event;
    while (source_->next_event(event)) {
      EXPECT_GE(event.time_ns, newest_event_ns_);
      newest_event_ns_ = event.time_ns;
      last_value_ = event.value;
      kinds.push_back(event.kind);
    }
    return kinds;
  }

  CanKernel kernel_;
  ManualClock clock_;
  std::unique_ptr<drivers::SocketCanSource> source_;
  std::array<CanFrame, 100> frames_;
  Errc last_error_{Errc::kNotReady};
  std::int64_t newest_event_ns_{0};
  std::int64_t last_value_{0};
};

}  // namespace dampline::fault
