// SPDX-License-Identifier: MIT
// What one sample costs, and one snapshot; see bench/README.md.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "dampline/damping/estimator.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

std::vector<Sample> make_ride(std::size_t samples) {
  sim::Simulation simulation{sim::SimulationConfig{}};
  std::vector<Sample> ride;
  ride.reserve(samples);
  while (ride.size() < samples) ride.push_back(sim::to_sample(simulation.next()));
  return ride;
}

/// Two minutes of a laden ride, over and over; ticks go on.
class Feed {
 public:
  Sample next() noexcept {
    Sample sample = ride()[position_];
    position_ = (position_ + 1) % ride().size();
    sample.tick = tick_++;
    return sample;
  }

 private:
  static const std::vector<Sample>& ride() {
    static const std::vector<Sample> made = make_ride(std::size_t{120} * sim::kSampleRateHz);
    return made;
  }
  std::size_t position_{0};
  std::int64_t tick_{0};
};

EstimatorConfig config_with(Memory memory) {
  EstimatorConfig config;
  config.memory = memory;
  config.memory_s = memory == Memory::kInfinite ? 0.0 : 120.0;
  return config;
}

void update(benchmark::State& state, Memory memory) {
  const auto identifier = std::make_unique<Estimator>(config_with(memory));
  Feed feed;
  for (int i = 0; i < 90 * sim::kSampleRateHz; ++i) {
    static_cast<void>(identifier->update(feed.next()));
  }
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(identifier->update(feed.next()));
  }
  state.SetItemsProcessed(state.iterations());
  const auto samples = static_cast<double>(state.iterations());
  state.counters["times_real_time"] =
      benchmark::Counter(samples / sim::kSampleRateHz, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(update, infinite_memory, Memory::kInfinite);
BENCHMARK_CAPTURE(update, window, Memory::kWindow);
BENCHMARK_CAPTURE(update, forgetting, Memory::kForgetting);

void snapshot(benchmark::State& state) {
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  Feed feed;
  for (int i = 0; i < state.range(0) * sim::kSampleRateHz; ++i) {
    static_cast<void>(identifier->update(feed.next()));
  }
  while (state.KeepRunning()) benchmark::DoNotOptimize(identifier->snapshot());
}
BENCHMARK(snapshot)->Arg(60)->Arg(300)->ArgName("after_s")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace dampline

BENCHMARK_MAIN();
