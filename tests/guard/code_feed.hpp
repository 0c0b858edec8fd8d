// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "dampline/guard/guard.hpp"
#include "sim_hw/noise.hpp"

namespace dampline {

inline constexpr double kStepMps2 = 0.005;

inline GuardConfig coded(double rate_hz = 300.0) {
  GuardConfig config;
  config.sample_rate_hz = rate_hz;
  config.step_mps2.fill(kStepMps2);
  return config;
}

/// Three channels of normal codes, too weak for the guards that need motion.
class Codes {
 public:
  explicit Codes(const GuardConfig& config = coded())
      : guard_{std::make_unique<Guard>(config)}, rate_hz_{config.sample_rate_hz} {}

  using Change = std::function<void(Sample&)>;
  void run(
      std::int64_t samples, const Change& change = [](Sample&) {}) {
    for (std::int64_t i = 0; i < samples; ++i) {
      Sample sample;
      sample.tick = tick_++;
      sample.time_ns = std::llround(1e9 * static_cast<double>(sample.tick) / rate_hz_);
      for (double& accel : sample.accel_mps2) accel = code(std::llround(40.0 * random_.normal()));
      change(sample);
      guard_->update(sample);
    }
  }
  static double code(std::int64_t number) { return kStepMps2 * static_cast<double>(number); }
  void skip(std::int64_t ticks) { tick_ += ticks; }
  Guard& guard() { return *guard_; }
  [[nodiscard]] std::int64_t tick() const { return tick_; }
  [[nodiscard]] std::span<const Fault> faults() const { return guard_->faults(); }
  [[nodiscard]] const Fault* find(FaultKind kind) const {
    for (const Fault& fault : faults())
      if (fault.kind == kind) return &fault;
    return nullptr;
  }
  [[nodiscard]] bool spoils(FaultKind kind, std::int64_t tick) const {
    return (guard_->spoilt(tick, tick) >> static_cast<unsigned>(kind) & 1U) != 0;
  }

 private:
  std::unique_ptr<Guard> guard_;
  double rate_hz_;
  std::int64_t tick_{0};
  sim::Random random_{12, sim::Stream::kSensors};
};

}  // namespace dampline
