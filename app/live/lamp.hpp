// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>

#include "hal/digital_output.hpp"

namespace dampline::app {

enum class LampState : std::uint8_t { kOff, kIdentifying, kDegraded, kFault };

/// Whether the lamp is lit at that moment, so that a person tells the states apart at a glance:
///   identifying  steady
///   degraded     slow: 1 s on, 1 s off
///   fault        quick: four times a second
/// A lamp that is dark for more than a second says that the program does not run.
[[nodiscard]] constexpr bool lamp_lit(LampState state, std::int64_t monotonic_ns) noexcept {
  constexpr std::int64_t kSlowHalfNs = 1'000'000'000;
  constexpr std::int64_t kQuickHalfNs = 125'000'000;
  switch (state) {
    case LampState::kOff:
      return false;
    case LampState::kIdentifying:
      return true;
    case LampState::kDegraded:
      return monotonic_ns / kSlowHalfNs % 2 == 0;
    case LampState::kFault:
      return monotonic_ns / kQuickHalfNs % 2 == 0;
  }
  return false;
}

/// Drives the lamp, and only when it has to change. A lamp that fails is tried again once a second:
/// it never stops the run.
class StatusLamp {
 public:
  /// Null: there is no lamp, and nothing is done.
  explicit StatusLamp(std::unique_ptr<hal::DigitalOutput> output) noexcept;
  StatusLamp(const StatusLamp&) = delete;
  StatusLamp& operator=(const StatusLamp&) = delete;
  ~StatusLamp();  ///< switches it off
  /// Call some times a second; every 60 ms or more often keeps the quick pattern even.
  void show(LampState state, std::int64_t monotonic_ns) noexcept;
  [[nodiscard]] std::uint64_t failures() const noexcept { return failures_; }

 private:
  std::unique_ptr<hal::DigitalOutput> output_;
  std::optional<bool> lit_;  // absent: not known
  std::int64_t retry_ns_{0};
  std::uint64_t failures_{0};
};

}  // namespace dampline::app
