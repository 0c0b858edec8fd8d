// SPDX-License-Identifier: MIT
#include "app/live/lamp.hpp"

#include <utility>

namespace dampline::app {

StatusLamp::StatusLamp(std::unique_ptr<hal::DigitalOutput> output) noexcept
    : output_{std::move(output)} {}

StatusLamp::~StatusLamp() {
  if (output_ && lit_ != false) static_cast<void>(output_->set(false));
}

void StatusLamp::show(LampState state, std::int64_t monotonic_ns) noexcept {
  constexpr std::int64_t kRetryNs = 1'000'000'000;
  const bool wanted = lamp_lit(state, monotonic_ns);
  if (!output_ || lit_ == wanted) return;
  if (failures_ > 0 && !lit_ && monotonic_ns < retry_ns_) return;
  if (output_->set(wanted).ok()) {
    lit_ = wanted;
    return;
  }
  lit_.reset();
  ++failures_;
  retry_ns_ = monotonic_ns + kRetryNs;
}

}  // namespace dampline::app
