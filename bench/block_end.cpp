// SPDX-License-Identifier: MIT
// What the end of a block costs, which the sample path spreads over the samples that follow, and
// what an answer costs that is asked for; see bench/README.md.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "bench/chain.hpp"
#include "bench/ride.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::bench {
namespace {

/// One row of 21 columns into the information of its block.
void absorb_row(benchmark::State& state) {
  const auto store = std::make_unique<BlockStore>(BlockStore::Config{});
  std::array<GalerkinRow, 64> rows;
  double x = 0.0;
  for (GalerkinRow& row : rows)
    for (int i = 0; i < kRowColumns; ++i) row[i] = std::sin(x += 1.7 + i);
  std::size_t next = 0;
  while (state.KeepRunning()) {
    store->absorb(0, 2, rows[next++ % rows.size()]);
    benchmark::DoNotOptimize(*store);
  }
}

/// All the work that a closed block leaves, at once. In the sample path it is kMergesPerStep rows a
/// sample.
void block_end(benchmark::State& state) {
  const auto store = std::make_unique<BlockStore>(
      BlockStore::Config{.memory = static_cast<Memory>(state.range(0)), .memory_blocks = 60.0});
  std::int64_t block = 0;
  const auto fill = [&] {
    GalerkinRow row;
    double x = 0.0;
    for (std::size_t s = 0; s < kScales; ++s) {
      for (int n = 0; n < 40; ++n) {
        for (int i = 0; i < kRowColumns; ++i) row[i] = std::sin(x += 1.7 + i);
        store->absorb(block, s, row);
      }
    }
  };
  for (; block < 70; ++block) {
    fill();
    store->close(block);
    store->finish();
  }
  while (state.KeepRunning()) {
    state.PauseTiming();
    fill();
    state.ResumeTiming();
    store->close(block++);
    store->finish();
  }
}

/// What `answer` costs after so many seconds of a ride.
template <class Answer>
void after(benchmark::State& state, Answer answer) {
  const auto chain = std::make_unique<Chain<kExplainParts>>();
  SampleFeed feed;
  for (std::int64_t i = 0; i < 300 * state.range(0); ++i) chain->push(feed.next());
  answer(state, *chain);
}

void snapshot(benchmark::State& state) {
  after(state, [](auto& s, auto& chain) {
    while (s.KeepRunning()) benchmark::DoNotOptimize(chain.snapshot());
  });
}

void densities(benchmark::State& state) {
  after(state, [](auto& s, auto& chain) {
    while (s.KeepRunning()) benchmark::DoNotOptimize(chain.density().estimates(37200.0, 5.26e6));
  });
}

void phase_snapshot(benchmark::State& state) {
  after(state, [](auto& s, auto& chain) {
    const auto out = std::make_unique<PhaseSnapshot>();
    while (s.KeepRunning()) {
      chain.phase().snapshot(*out);
      benchmark::DoNotOptimize(*out);
    }
  });
}

void explanation(benchmark::State& state) {
  after(state, [](auto& s, auto& chain) {
    const auto explainer = std::make_unique<effect::Explainer>();
    while (s.KeepRunning()) benchmark::DoNotOptimize(chain.explanation(*explainer, {}));
  });
}

BENCHMARK(absorb_row)->Name("estimate/row");
BENCHMARK(block_end)->Name("estimate/block end")->DenseRange(0, 2)->ArgName("memory");
BENCHMARK(snapshot)->Name("answer/snapshot")->Arg(120)->ArgName("after_s");
BENCHMARK(densities)->Name("answer/densities")->Arg(120)->ArgName("after_s");
BENCHMARK(phase_snapshot)->Name("answer/phase")->Arg(120)->ArgName("after_s");
BENCHMARK(explanation)->Name("answer/explanation")->Arg(120)->ArgName("after_s");

}  // namespace
}  // namespace dampline::bench

BENCHMARK_MAIN();
