// SPDX-License-Identifier: MIT
#include "sim_hw/sensors.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::sim {
namespace {

constexpr double kSampleS = 1.0 / 300.0;

SectionChain make_drift(double time_s) {
  const double rate = 1.0 / time_s;
  const Section section{2.0 * rate, rate * rate, 1.0};
  return {&section, 1, kSampleS};
}

SectionChain make_lateral() {
  const double omega = 2.0 * std::numbers::pi * 2.0;
  const Section section{0.4 * omega, omega * omega, 1.0};
  return {&section, 1, kSampleS};
}

/// sqrt of the variance integral of 1 / (s^2 + 2 d w s + w^2): 1 / sqrt(4 d w^3) for unit noise.
double section_rms(double damping, double stiffness) {
  return 1.0 / std::sqrt(2.0 * damping * stiffness);
}

}  // namespace

Sensors::Sensors(const SensorConfig& config, std::uint64_t seed)
    : config_(config),
      random_(seed, Stream::kSensors),
      lateral_random_(seed, Stream::kLateral),
      drift_{make_drift(config.drift_time_s), make_drift(config.drift_time_s),
             make_drift(config.drift_time_s)},
      drift_gain_(config.drift_mps2 /
                  section_rms(2.0 / config.drift_time_s,
                              1.0 / (config.drift_time_s * config.drift_time_s))),
      lateral_(make_lateral()),
      tilted_(std::ranges::any_of(config.tilt_rad, [](double tilt) { return tilt != 0.0; })) {
  const double omega = 4.0 * std::numbers::pi;
  lateral_gain_ = config.lateral_mps2 / section_rms(0.4 * omega, omega * omega);
  for (double& bias : bias_mps2_) bias = config.bias_mps2 * random_.normal();
  const auto settle = static_cast<int>(5.0 * config.drift_time_s / kSampleS);
  for (int i = 0; i < settle; ++i) {
    for (SectionChain& drift : drift_) drift.advance(random_.normal());
  }
}

std::int16_t Sensors::convert_one(std::size_t channel, double accel_mps2, double time_s) noexcept {
  drift_[channel].advance(random_.normal());
  double value = accel_mps2 * (1.0 + config_.gain_error[channel]) + bias_mps2_[channel] +
                 drift_gain_ * drift_[channel].value() + config_.noise_mps2 * random_.normal();
  if (const double limit = config_.limit_mps2[channel]; limit > 0.0) {
    value = std::clamp(value, -limit, limit);
  }
  const double counts = std::nearbyint(value / count_scale_mps2(config_.range_mps2[channel]));
  const bool stuck =
      time_s >= config_.stuck_start_s[channel] && time_s < config_.stuck_end_s[channel];
  if (!stuck) {
    last_[channel] = static_cast<std::int16_t>(
        std::clamp(counts, static_cast<double>(kMinCount), static_cast<double>(kMaxCount)));
  }
  return last_[channel];
}

std::array<std::int16_t, kChannels> Sensors::convert(
    const std::array<double, kChannels>& accel_mps2, double time_s) noexcept {
  std::array<std::int16_t, kChannels> counts{};
  if (tilted_) lateral_.advance(lateral_random_.normal());
  for (std::size_t c = 0; c < kChannels; ++c) {
    double value = accel_mps2[c];
    if (tilted_) {
      value = std::cos(config_.tilt_rad[c]) * value +
              std::sin(config_.tilt_rad[c]) * lateral_gain_ * lateral_.value();
    }
    counts[c] = convert_one(c, value, time_s);
  }
  return counts;
}

}  // namespace dampline::sim
