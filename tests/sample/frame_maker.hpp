// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "dampline/sample/assembler.hpp"

namespace dampline::test {

/// Three nodes as a test sees them: 12-bit values that tell their own tick, so that a sample can be
/// checked without asking the assembler anything.
struct Nodes {
  unsigned counter_bits{8};
  double rate_hz{300.0};
  std::int64_t start_ns{1'600'000'000'000'000'000};

  [[nodiscard]] AssemblerConfig config() const {
    AssemblerConfig all;
    all.sample_rate_hz = rate_hz;
    for (std::size_t c = 0; c < kChannels; ++c) {
      ChannelConfig& channel = all.channels[c];
      channel.id = static_cast<std::uint32_t>(0x100 + c);
      channel.accel = {.start_bit = 0, .length = 12, .is_signed = true, .scale = 0.01};
      channel.has_counter = counter_bits > 0;
      channel.counter = {.start_bit = 16,
                         .length = static_cast<std::uint8_t>(std::max(counter_bits, 1U))};
    }
    return all;
  }
  /// Differs between channels and between neighbouring ticks; repeats after 1999 ticks.
  [[nodiscard]] static std::int64_t code(std::size_t channel, std::int64_t tick) {
    return (tick * 7 + static_cast<std::int64_t>(channel) * 500) % 1999 - 999;
  }
  [[nodiscard]] static double value(std::size_t channel, std::int64_t tick) {
    return static_cast<double>(code(channel, tick)) * 0.01;
  }
  [[nodiscard]] std::int64_t time_of(std::int64_t tick) const {
    return start_ns +
           static_cast<std::int64_t>(std::llround(static_cast<double>(tick) * 1e9 / rate_hz));
  }
  /// counter_shift: what a restarted node's counter is off by.
  [[nodiscard]] CanFrame frame(std::size_t channel, std::int64_t tick, std::int64_t delay_ns = 0,
                               std::int64_t counter_shift = 0) const {
    CanFrame made;
    made.id = static_cast<std::uint32_t>(0x100 + channel);
    made.time_ns = time_of(tick) + static_cast<std::int64_t>(channel) * 200'000 + delay_ns;
    made.length = 8;
    const auto raw = static_cast<std::uint64_t>(code(channel, tick)) & 0xFFFU;
    const auto counter = static_cast<std::uint64_t>(tick + counter_shift);
    made.data[0] = static_cast<std::uint8_t>(raw & 0xFFU);
    made.data[1] = static_cast<std::uint8_t>(raw >> 8U);
    for (std::size_t i = 0; i < 6; ++i)
      made.data[2 + i] = static_cast<std::uint8_t>(counter >> (8 * i));
    return made;
  }
};

/// In the order of their times, as a source delivers them.
inline void sort_by_time(std::vector<CanFrame>& frames) {
  std::stable_sort(frames.begin(), frames.end(),
                   [](const CanFrame& a, const CanFrame& b) { return a.time_ns < b.time_ns; });
}

inline std::vector<Sample> assemble(SampleAssembler& assembler,
                                    const std::vector<CanFrame>& frames) {
  std::vector<Sample> samples;
  Sample sample;
  for (const CanFrame& frame : frames) {
    assembler.push(frame);
    while (assembler.pop(sample)) samples.push_back(sample);
  }
  assembler.flush();
  while (assembler.pop(sample)) samples.push_back(sample);
  return samples;
}

/// How many samples mix instants, or carry a tick that is off from the first one's.
inline int wrong_samples(const std::vector<Sample>& samples, std::int64_t first_true_tick) {
  int wrong = 0;
  for (const Sample& sample : samples) {
    const std::int64_t tick = sample.tick - samples.front().tick + first_true_tick;
    for (std::size_t c = 0; c < kChannels; ++c) {
      if (std::abs(sample.accel_mps2[c] - Nodes::value(c, tick)) > 1e-9) {
        ++wrong;
        break;
      }
    }
  }
  return wrong;
}

/// All frames of the nodes from one tick up to another.
inline std::vector<CanFrame> run(const Nodes& nodes, std::int64_t from, std::int64_t to) {
  std::vector<CanFrame> frames;
  for (std::int64_t tick = from; tick < to; ++tick) {
    for (std::size_t c = 0; c < kChannels; ++c) frames.push_back(nodes.frame(c, tick));
  }
  return frames;
}

}  // namespace dampline::test
