// SPDX-License-Identifier: MIT
#include "tests/bus/sensors.hpp"

#include <sched.h>

#include <algorithm>
#include <thread>

namespace dampline::bus {
namespace {
constexpr std::chrono::nanoseconds kPeriod{1'000'000'000 / Sensors::kRateHz};
constexpr std::int64_t kTogether = 30;  // instants that one system call hands on

/// This thread alone goes before a reader in real-time scheduling; what it starts does not.
void go_first() {
  sched_param first{};
  first.sched_priority = 60;
  ::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &first);
}

}  // namespace

Sensors::Sensors(RawSender& bus) : bus_{bus} {}

CanFrame Sensors::frame(std::size_t channel) const noexcept {
  // Any motion will do; what counts is that every frame differs from its neighbours.
  const std::int64_t code =
      motion ? codes_[channel] : (instant_ * 37 + 11 * static_cast<int>(channel)) % 400;
  const auto accel = static_cast<std::uint32_t>(code) & 0xFFFU;
  const auto counter = static_cast<std::uint32_t>(counter_[channel]) & 0xFFFU;
  const std::uint32_t word = accel | counter << 12U;
  return {.id = static_cast<std::uint32_t>(0x310 + channel),
          .length = 4,
          .data = {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8U),
                   static_cast<std::uint8_t>(word >> 16U)}};
}

void Sensors::make_instant(std::vector<CanFrame>& frames) {
  if (motion) codes_ = motion();
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (instant_ < off_until_[c]) continue;
    const CanFrame made = frame(c);
    ++counter_[c];
    ++made_;
    if (!fate) {
      frames.push_back(made);
      continue;
    }
    const std::vector<CanFrame> arriving = fate(c, made);
    frames.insert(frames.end(), arriving.begin(), arriving.end());
  }
  ++instant_;
}

void Sensors::run(std::chrono::duration<double> time) {
  const auto instants = static_cast<std::int64_t>(time.count() * kRateHz);
  if (batch > 1) go_first();
  const auto now = std::chrono::steady_clock::now();
  if (instant_ == 0 || now - due_ > std::chrono::milliseconds{50}) due_ = now;  // they did not run
  for (std::int64_t i = 0; i < instants; i += batch) {
    const std::int64_t together = std::min(batch, instants - i);
    due_ += together * kPeriod;
    std::this_thread::sleep_until(due_);
    burst(together);
  }
}

void Sensors::burst(std::int64_t instants) {
  std::vector<CanFrame> frames;
  for (std::int64_t i = 0; i < instants; ++i) {
    make_instant(frames);
    if (i + 1 < instants && (i + 1) % kTogether != 0) continue;
    refused_ += frames.size() - bus_.send(frames);
    frames.clear();
  }
}

void Sensors::restart_node(std::size_t channel, std::int64_t instants_off) {
  counter_[channel] = 0;
  off_until_[channel] = instant_ + instants_off;
}

}  // namespace dampline::bus
