// SPDX-License-Identifier: MIT
// Two minutes of a laden ride over and over, as the benchmarks of the sample path take it: samples,
// frames, and samples with what the Estimator makes of them. Ticks, times and counters go on.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "dampline/damping/estimator.hpp"
#include "sim_hw/nodes.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::bench {

/// A whole number of rounds of the nodes' counters, 123 s.
inline constexpr std::int64_t kRideTicks = 9 * static_cast<std::int64_t>(sim::kCounterModulus);
inline constexpr std::int64_t kRideNs = kRideTicks * 10'000'000 / 3;

/// A vector that begins anew when it ends.
template <class T>
class Round {
 public:
  explicit Round(const std::vector<T>& items) noexcept : items_{&items} {}
  [[nodiscard]] T next() noexcept {
    const T item = (*items_)[position_];
    if (++position_ == items_->size()) {
      position_ = 0;
      ++rounds_;
    }
    return item;
  }
  /// Of the item that next() will give.
  [[nodiscard]] std::int64_t rounds() const noexcept { return rounds_; }

 private:
  const std::vector<T>* items_;
  std::size_t position_{0};
  std::int64_t rounds_{0};
};

struct Recorded {
  std::vector<Sample> samples;
  std::vector<std::array<CanFrame, kChannels>> frames;
};

inline const Recorded& recorded() {
  static const Recorded made = [] {
    sim::Simulation simulation{sim::reference_run(sim::Load::kLaden, 80.0, 1)};
    sim::SensorNodes nodes{{}, 1};
    Recorded out;
    for (std::int64_t i = 0; i < kRideTicks; ++i) {
      const sim::SimulatedSample sample = simulation.next();
      out.samples.push_back(sim::to_sample(sample));
      out.frames.push_back(nodes.pack(sample));
    }
    return out;
  }();
  return made;
}

class SampleFeed {
 public:
  [[nodiscard]] Sample next() noexcept {
    Sample sample = round_.next();
    sample.tick = tick_;
    sample.time_ns = tick_ * 10'000'000 / 3;
    ++tick_;
    return sample;
  }

 private:
  Round<Sample> round_{recorded().samples};
  std::int64_t tick_{0};
};

class FrameFeed {
 public:
  [[nodiscard]] std::array<CanFrame, kChannels> next() noexcept {
    const std::int64_t shift_ns = round_.rounds() * kRideNs;
    auto frames = round_.next();
    for (CanFrame& frame : frames) frame.time_ns += shift_ns;
    return frames;
  }

 private:
  Round<std::array<CanFrame, kChannels>> round_{recorded().frames};
};

/// A sample and what the Estimator returned for it.
struct Heard {
  Sample sample;
  UpdateResult result;
};

inline const std::vector<Heard>& heard() {
  static const std::vector<Heard> made = [] {
    const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
    SampleFeed feed;
    for (std::int64_t i = 0; i < kRideTicks; ++i)
      static_cast<void>(identifier->update(feed.next()));
    std::vector<Heard> out;
    for (std::int64_t i = 0; i < kRideTicks; ++i) {
      const Sample sample = feed.next();
      out.push_back({sample, identifier->update(sample)});
    }
    return out;
  }();
  return made;
}

class HeardFeed {
 public:
  [[nodiscard]] Heard next() noexcept {
    const std::int64_t rounds = round_.rounds();
    Heard heard = round_.next();
    heard.sample.tick += rounds * kRideTicks;
    heard.sample.time_ns += rounds * kRideNs;
    heard.result.motion.tick += rounds * kRideTicks;
    return heard;
  }

 private:
  Round<Heard> round_{heard()};
};

}  // namespace dampline::bench
