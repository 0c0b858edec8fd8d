// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "bench/cache_misses.hpp"
#include "bench/chain.hpp"
#include "bench/large_array.hpp"
#include "bench/peers/timing.hpp"
#include "bench/ride.hpp"

namespace dampline::bench {

/// Of one truck and sample.
struct TruckCost {
  double ns;
  std::optional<double> cache_misses;  ///< none where the machine does not count them
};

/// Trucks of one process, frames to estimate. A truck takes a batch of samples, then the next truck
/// its own: 1 as if every sample were handed on at once, 32 as a logger that sends every 0.1 s.
class Fleet {
 public:
  using Truck = Chain<Parts::kEstimate>;
  static constexpr std::size_t kLongestBatch = 32;

  explicit Fleet(std::size_t trucks)
      : trucks_{trucks, [](void* place, std::size_t) { new (place) Truck; }} {
    // Past the 3.9 s after which every scale makes rows.
    for (int i = 0; i < 50; ++i) feed_all(kLongestBatch);
  }

  /// At least a whole block of every truck.
  [[nodiscard]] TruckCost cost(std::size_t batch) {
    const std::size_t samples = std::max<std::size_t>(608, 1'000'000 / trucks_.size() / 32 * 32);
    const CacheMisses counter;
    counter.start();
    const double start_ns = thread_time_ns();
    for (std::size_t i = 0; i < samples; i += batch) feed_all(batch);
    const double all = static_cast<double>(samples) * static_cast<double>(trucks_.size());
    TruckCost out{(thread_time_ns() - start_ns) / all, std::nullopt};
    if (const auto misses = counter.stop()) out.cache_misses = static_cast<double>(*misses) / all;
    return out;
  }

 private:
  void feed_all(std::size_t batch) noexcept {
    const auto frames = std::span{frames_}.first(batch);
    for (auto& instant : frames) instant = feed_.next();
    for (Truck& truck : trucks_)
      for (const auto& instant : frames) truck.push(instant);
  }

  LargeArray<Truck> trucks_;
  FrameFeed feed_;
  std::array<std::array<CanFrame, kChannels>, kLongestBatch> frames_{};
};

}  // namespace dampline::bench
