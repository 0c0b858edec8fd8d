// SPDX-License-Identifier: MIT
// How many trucks one core identifies at 300 Hz: frames of N trucks through N assemblers and N
// identifiers, first as fast as possible, then paced at real time; see bench/README.md.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <vector>

#include "app/live/lateness.hpp"
#include "app/record/frames.hpp"
#include "bench/fleet.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/sample/assembler.hpp"
#include "drivers/os/system_clock.hpp"
#include "sim_hw/simulated_source.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline {
namespace {

constexpr std::int64_t kRideTicks = std::int64_t{60} * 300;
constexpr std::int64_t kPeriodNs = 1'000'000'000 / 300;

struct Truck {
  explicit Truck(std::size_t number)
      : assembler{app::can_channels({})},
        identifier{EstimatorConfig{}},
        phase{static_cast<std::int64_t>(number) * 7919 % kRideTicks} {}
  SampleAssembler assembler;
  Estimator identifier;
  std::int64_t phase;  // so that not all blocks end at once
};

/// One minute of frames, three a tick.
std::vector<CanFrame> make_ride() {
  sim::SimulatedSource source{sim::reference_run(sim::Load::kLaden, 80.0, 1), kRideTicks};
  std::vector<CanFrame> frames;
  std::vector<CanFrame> batch(3);
  for (auto count = source.read(batch); count.ok(); count = source.read(batch))
    frames.insert(frames.end(), batch.begin(),
                  batch.begin() + static_cast<std::ptrdiff_t>(count.value()));
  return frames;
}

class Fleet {
 public:
  Fleet(const std::vector<CanFrame>& ride, std::size_t trucks)
      : ride_{ride}, trucks_{trucks, [](void* place, std::size_t number) {
                               new (place) Truck{number};
                             }} {}
  /// The next tick of every truck.
  void tick() {
    Sample sample;
    for (Truck& truck : trucks_) {
      const std::int64_t tick = (tick_ + truck.phase) % kRideTicks;
      for (std::size_t c = 0; c < kChannels; ++c)
        truck.assembler.push(ride_[static_cast<std::size_t>(tick) * kChannels + c]);
      while (truck.assembler.pop(sample)) static_cast<void>(truck.identifier.update(sample));
    }
    ++tick_;
  }

 private:
  const std::vector<CanFrame>& ride_;
  bench::LargeArray<Truck> trucks_;
  std::int64_t tick_{0};
};

double cpu_s() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

/// Processor time of one truck for a second of its life, in microseconds.
double free_run_us(Fleet& fleet, std::size_t trucks) {
  const std::int64_t ticks = std::max<std::int64_t>(600, 600'000 / static_cast<int>(trucks));
  const double start_s = cpu_s();
  for (std::int64_t i = 0; i < ticks; ++i) fleet.tick();
  const double truck_seconds = static_cast<double>(ticks) * static_cast<double>(trucks) / 300.0;
  return 1e6 * (cpu_s() - start_s) / truck_seconds;
}

/// Real time for some seconds: how late a tick's results are.
app::Lateness paced(Fleet& fleet, const hal::Clock& clock, double seconds, std::uint64_t& slips) {
  app::Lateness lateness;
  const auto ticks = static_cast<std::int64_t>(300.0 * seconds);
  const std::int64_t start_ns = clock.monotonic_ns();
  for (std::int64_t i = 0; i < ticks; ++i) {
    const std::int64_t due_ns = start_ns + i * kPeriodNs;
    clock.sleep_until(due_ns);
    fleet.tick();
    const std::int64_t late_ns = clock.monotonic_ns() - due_ns;
    lateness.add(late_ns);
    if (late_ns > kPeriodNs) ++slips;
  }
  return lateness;
}

int run(double seconds) {
  const drivers::SystemClock clock;
  const std::vector<CanFrame> ride = make_ride();
  fmt::print(
      "| trucks | processor time a truck and second, us | share of one core | memory, MiB | "
      "paced: p50 / p99 / largest lateness, ms | ticks late by a period |\n"
      "|--|--|--|--|--|--|\n");
  for (const std::size_t trucks : {1U, 10U, 100U, 500U, 1000U, 2000U, 4000U}) {
    Fleet fleet{ride, trucks};
    for (int i = 0; i < 900; ++i) fleet.tick();
    const double each_us = free_run_us(fleet, trucks);
    const double share = 1e-6 * each_us * static_cast<double>(trucks);
    const double memory_mib = static_cast<double>(trucks * sizeof(Truck)) / (1024.0 * 1024.0);
    std::string pacing = "| not tried | |";
    if (share < 1.5) {
      std::uint64_t slips = 0;
      const app::Lateness late = paced(fleet, clock, seconds, slips);
      const auto ms = [](std::uint64_t ns) { return 1e-6 * static_cast<double>(ns); };
      pacing = fmt::format("| {:.2f} / {:.2f} / {:.1f} | {} of {} |", ms(late.quantile_ns(0.5)),
                           ms(late.quantile_ns(0.99)), ms(late.max_ns()), slips, late.count());
    }
    fmt::print("| {} | {:.1f} | {:.2f} % | {:.1f} {}\n", trucks, each_us, 100.0 * share, memory_mib,
               pacing);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace dampline

int main(int argc, char** argv) { return dampline::run(argc > 1 ? std::atof(argv[1]) : 10.0); }
