// SPDX-License-Identifier: MIT
// What one sample costs where deflection and force are measured; see bench/README.md.
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include "published/wavelet/coarse_rows.hpp"
#include "published/wavelet/estimates.hpp"
#include "published/wavelet/model_selection.hpp"

namespace dampline {
namespace {

using Element = TermList<Viscous, Spring, CubicSpring>;
using Duffing = SingleModel<Element>;
using Chain = ChainModel<Element, Element>;
using DryElement = TermList<Viscous, Spring, Friction<>>;
using DryChain = ChainModel<DryElement, DryElement>;

constexpr double kStepS = 1e-3;

/// A motion of two tones per mass; its force does not matter to the cost.
template <class M>
std::vector<MotionSample<M::kDof>> motion() {
  std::vector<MotionSample<M::kDof>> out(4096);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double t = kStepS * static_cast<double>(i);
    for (std::size_t d = 0; d < out[i].deflection_m.size(); ++d) {
      const double x = std::sin(25.0 * t) + 0.4 * std::sin(9.0 * t + static_cast<double>(d));
      out[i].deflection_m[d] = x * static_cast<double>(d + 1);
      out[i].force_n[d] = x;
    }
  }
  return out;
}

template <class Rows, class M>
Rows make() {
  MotionRowsConfig<M::kDof> config{.step_s = kStepS};
  config.mass_kg.fill(12.0);
  return Rows::make(config, M{}).value();
}

/// One sample: the row, and each of its equations into the information.
template <class Rows, class M>
void sample(benchmark::State& state) {
  const auto samples = motion<M>();
  Rows rows = make<Rows, M>();
  MotionRow<M> row;
  RecursiveEstimate<M::kUnknowns> estimate;
  std::size_t i = 0;
  while (state.KeepRunning()) {
    if (rows.push(samples[i], row) && row.usable) {
      for (int d = 0; d < M::kDof; ++d) estimate.absorb(row.equation(d));
    }
    i = (i + 1) % samples.size();
  }
  benchmark::DoNotOptimize(estimate.information().at(0, 0));
  state.SetItemsProcessed(state.iterations());
}

/// One estimate from the sliding window of four blocks, and one choice of terms.
template <class M>
struct Filled {
  FactorRing<M::kUnknowns, 4> ring{8};
  ModelSelection<M> selection;

  Filled() {
    const auto samples = motion<M>();
    auto rows = make<MotionRows<D12, M>, M>();
    MotionRow<M> row;
    PerDof<M::kDof> mass_kg{};
    mass_kg.fill(12.0);
    for (const auto& sample : samples) {
      if (!rows.push(sample, row) || !row.usable) continue;
      for (int d = 0; d < M::kDof; ++d) ring.absorb(row.equation(d));
      selection.absorb(row, mass_kg);
    }
  }
};

void window(benchmark::State& state) {
  Filled<Chain> filled;
  while (state.KeepRunning()) benchmark::DoNotOptimize(filled.ring.update());
}

void choice(benchmark::State& state) {
  const Filled<Chain> filled;
  while (state.KeepRunning()) benchmark::DoNotOptimize(filled.selection.choose());
}

BENCHMARK(sample<MotionRows<D8, Duffing>, Duffing>)->Name("sample/duffing/D8");
BENCHMARK(sample<MotionRows<D12, Duffing>, Duffing>)->Name("sample/duffing/D12");
BENCHMARK(sample<MotionRows<D16, Duffing>, Duffing>)->Name("sample/duffing/D16");
BENCHMARK(sample<CoarseRows<D12, Duffing, 2>, Duffing>)->Name("sample/duffing/D12 level -2");
BENCHMARK(sample<MotionRows<D12, Chain>, Chain>)->Name("sample/chain of two/D12");
BENCHMARK(sample<MotionRows<D12, DryChain>, DryChain>)->Name("sample/chain of two, dry/D12");
BENCHMARK(window)->Name("window of 32 rows, solved/chain of two");
BENCHMARK(choice)->Name("choice of terms/chain of two");

}  // namespace
}  // namespace dampline

BENCHMARK_MAIN();
