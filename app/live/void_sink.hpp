// SPDX-License-Identifier: MIT
#pragma once
#include "hal/record_sink.hpp"

namespace dampline::app {

/// Where a run that keeps no black box writes its frames.
class VoidSink final : public hal::RecordSink {
 private:
  void do_write(const CanFrame& /*frame*/) noexcept override {}
  void do_write(const hal::Event& /*event*/) noexcept override {}
  void do_tick(std::int64_t /*monotonic_ns*/) noexcept override {}
  void do_rotate() noexcept override {}
  void do_close() noexcept override {}
  [[nodiscard]] hal::RecordHealth do_health() const noexcept override { return {}; }
};

}  // namespace dampline::app
