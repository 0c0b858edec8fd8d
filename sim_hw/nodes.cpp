// SPDX-License-Identifier: MIT
#include "sim_hw/nodes.hpp"

#include <algorithm>
#include <cmath>

namespace dampline::sim {

SensorNodes::SensorNodes(const NodeConfig& config, std::uint64_t seed)
    : config_(config), random_(seed, Stream::kNodes) {
  for (std::uint32_t& first : first_counter_) {
    first = static_cast<std::uint32_t>(random_.bits() % kCounterModulus);
  }
}

std::array<CanFrame, kChannels> SensorNodes::pack(const SimulatedSample& sample) noexcept {
  constexpr double kLargestJitterS = 90e-6;
  // 10^9 / 300 ns per tick, without rounding that adds up
  const std::int64_t sampled_ns = config_.start_time_ns + sample.tick * 10'000'000 / 3;
  std::array<CanFrame, kChannels> frames{};
  for (std::size_t c = 0; c < kChannels; ++c) {
    const double jitter_s =
        std::clamp(config_.jitter_s * random_.normal(), -kLargestJitterS, kLargestJitterS);
    const auto accel = static_cast<std::uint32_t>(sample.counts[c]) & 0xfffU;
    const auto counter = static_cast<std::uint32_t>(
        (static_cast<std::uint64_t>(sample.tick) + first_counter_[c]) % kCounterModulus);
    CanFrame& frame = frames[c];
    frame.time_ns = sampled_ns + std::llround((config_.arrival_s[c] + jitter_s) * 1e9);
    frame.id = config_.id[c];
    frame.length = 4;
    frame.data[0] = static_cast<std::uint8_t>(accel & 0xffU);
    frame.data[1] = static_cast<std::uint8_t>((accel >> 8U) | ((counter & 0xfU) << 4U));
    frame.data[2] = static_cast<std::uint8_t>(counter >> 4U);
    frame.data[3] = static_cast<std::uint8_t>((sample.saturated >> c) & 1U);
  }
  std::ranges::stable_sort(frames, {}, &CanFrame::time_ns);
  return frames;
}

}  // namespace dampline::sim
