// SPDX-License-Identifier: MIT
// What one sample costs in every room of the core, and in the whole chain from CAN frames on; see
// bench/README.md.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "bench/chain.hpp"
#include "bench/ride.hpp"
#include "dampline/density/histogram.hpp"
#include "dampline/density/joint_histogram.hpp"
#include "dampline/motion/noise_meter.hpp"

namespace dampline::bench {
namespace {

/// Times `step()`, one sample a call.
template <class Step>
void time_samples(benchmark::State& state, std::int64_t warm_up_samples, Step step) {
  for (std::int64_t i = 0; i < warm_up_samples; ++i) step();
  while (state.KeepRunning()) step();
  state.SetItemsProcessed(state.iterations());
}

/// The feed by itself: what every figure below contains.
template <class Feed>
void feed(benchmark::State& state) {
  Feed source;
  time_samples(state, 0, [&] { benchmark::DoNotOptimize(source.next()); });
}

void decode(benchmark::State& state) {
  const auto assembler = std::make_unique<SampleAssembler>(frame_config());
  FrameFeed source;
  Sample sample;
  time_samples(state, 300, [&] {
    for (const CanFrame& frame : source.next()) assembler->push(frame);
    while (assembler->pop(sample)) benchmark::DoNotOptimize(sample);
  });
}

void screen(benchmark::State& state) {
  const auto screen = std::make_unique<SampleScreen>(chain_config().estimator.screen);
  SampleFeed source;
  Screened out;
  time_samples(state, 300, [&] { benchmark::DoNotOptimize(screen->push(source.next(), out)); });
}

void noise(benchmark::State& state) {
  const auto meter = std::make_unique<NoiseMeter>();
  SampleFeed source;
  time_samples(state, 300, [&] {
    meter->update(source.next().accel_mps2[0]);
    benchmark::DoNotOptimize(*meter);
  });
}

void motion_integral(benchmark::State& state) {
  DriftFreeIntegral integral{300.0};
  SampleFeed source;
  double out = 0.0;
  time_samples(state, 1200, [&] {
    benchmark::DoNotOptimize(integral.update(source.next().accel_mps2[0], out));
  });
}

/// Lift, velocity and deflection of the relative motion, as the Estimator forms them.
void motion(benchmark::State& state) {
  Fir<VelocityLift::kHalf> lift{VelocityLift{{}, 300.0}.taps()};
  DriftFreeIntegral velocity{300.0};
  DriftFreeIntegral deflection{300.0};
  SampleFeed source;
  time_samples(state, 1200, [&] {
    const auto a = source.next().accel_mps2;
    double lifted_mps2 = 0.0;
    double velocity_mps = 0.0;
    double deflection_m = 0.0;
    if (lift.update(2.0 * a[0] - a[1] - a[2], lifted_mps2) &&
        velocity.update(lifted_mps2, velocity_mps))
      benchmark::DoNotOptimize(deflection.update(velocity_mps, deflection_m));
  });
}

void density_histogram(benchmark::State& state) {
  Histogram<64> histogram{{.range = {.low = -0.05, .high = 0.05}}};
  HeardFeed source;
  time_samples(state, 0, [&] {
    histogram.update(source.next().result.motion.velocity_mps);
    benchmark::DoNotOptimize(histogram);
  });
}

void density_joint(benchmark::State& state) {
  const auto histogram = std::make_unique<JointHistogram<32, 32>>(
      JointHistogramConfig{.x = {.low = -2e-3, .high = 2e-3}, .y = {.low = -0.05, .high = 0.05}});
  HeardFeed source;
  time_samples(state, 0, [&] {
    const Motion m = source.next().result.motion;
    histogram->update(m.deflection_m, m.velocity_mps);
    benchmark::DoNotOptimize(*histogram);
  });
}

void density_all(benchmark::State& state) {
  const auto density = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{});
  HeardFeed source;
  time_samples(state, 9000, [&] { density->update(source.next().result.motion); });
}

/// The friction law's columns averaged between samples.
void wavelet_columns(benchmark::State& state) {
  const LawColumns law{kDefaultCurveNodesMps};
  LawAverage average;
  HeardFeed source;
  time_samples(state, 10, [&] {
    const Motion m = source.next().result.motion;
    benchmark::DoNotOptimize(average.update(law, m.velocity_mps, m.relative_mps2, 1.0 / 300.0));
  });
}

/// One row of a scale; there is one every stride(scale) samples.
void wavelet_row(benchmark::State& state) {
  const auto scale = static_cast<std::size_t>(state.range(0));
  const auto rows = std::make_unique<RowBuilder>(300.0);
  const LawColumns law{kDefaultCurveNodesMps};
  HeardFeed source;
  for (std::int64_t n = 0; n < 2048; ++n) {
    const Motion m = source.next().result.motion;
    rows->set_accelerations(n, m.frame_mps2, m.relative_mps2);
    rows->set_law(n, law.lanes(m.velocity_mps), false);
  }
  const int half = rows->bank().half(scale);
  std::int64_t centre = 2046 - half;
  while (state.KeepRunning()) {
    benchmark::DoNotOptimize(rows->still_share(scale, centre));
    benchmark::DoNotOptimize(rows->row(scale, centre));
  }
  state.counters["samples_per_row"] = rows->bank().stride(scale);
}

void phase_view(benchmark::State& state) {
  const auto phase = std::make_unique<PhaseView>(PhaseViewConfig{});
  HeardFeed source;
  time_samples(state, 18000, [&] { phase->update(source.next().result.motion); });
}

void guard(benchmark::State& state) {
  const auto guard = std::make_unique<Guard>(guard_config(chain_config()));
  SampleFeed source;
  time_samples(state, 9000, [&] { guard->update(source.next()); });
}

void effect_diagnosis(benchmark::State& state) {
  const auto diagnosis = std::make_unique<effect::Diagnosis>(chain_config().estimator);
  HeardFeed source;
  time_samples(state, 9000, [&] {
    const Heard heard = source.next();
    diagnosis->update(heard.sample, heard.result);
  });
}

void identifier(benchmark::State& state) {
  const auto identifier = std::make_unique<Estimator>(chain_config().estimator);
  SampleFeed source;
  time_samples(state, 27000, [&] { benchmark::DoNotOptimize(identifier->update(source.next())); });
}

template <Parts kParts>
void chain(benchmark::State& state) {
  const auto chain = std::make_unique<Chain<kParts>>();
  FrameFeed source;
  time_samples(state, 27000, [&] { chain->push(source.next()); });
  if (!chain->snapshot().valid) state.SkipWithError("nothing was identified");
}

BENCHMARK(feed<SampleFeed>)->Name("feed/samples");
BENCHMARK(feed<FrameFeed>)->Name("feed/frames");
BENCHMARK(feed<HeardFeed>)->Name("feed/motions");
BENCHMARK(decode)->Name("sample/decode");
BENCHMARK(screen)->Name("sample/screen");
BENCHMARK(noise)->Name("motion/noise");
BENCHMARK(motion_integral)->Name("motion/integral");
BENCHMARK(motion)->Name("motion/velocity and deflection");
BENCHMARK(density_histogram)->Name("density/histogram");
BENCHMARK(density_joint)->Name("density/joint");
BENCHMARK(density_all)->Name("density/all");
BENCHMARK(wavelet_columns)->Name("wavelet/columns");
BENCHMARK(wavelet_row)->Name("wavelet/row")->DenseRange(0, 4)->ArgName("scale");
BENCHMARK(phase_view)->Name("phase/view");
BENCHMARK(guard)->Name("guard/update");
BENCHMARK(effect_diagnosis)->Name("effect/diagnosis");
BENCHMARK(identifier)->Name("identifier/update");
BENCHMARK(chain<kFramesToEstimate>)->Name("chain/estimate");
BENCHMARK(chain<kFramesToDensities>)->Name("chain/densities");
BENCHMARK(chain<kIdentifyParts>)->Name("chain/identify");
BENCHMARK(chain<kExplainParts>)->Name("chain/explain");

}  // namespace
}  // namespace dampline::bench

BENCHMARK_MAIN();
