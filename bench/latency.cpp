// SPDX-License-Identifier: MIT
// How the time of a sample is distributed, from its frames to the estimate and to the candidates'
// sums; and what it asks of the system meanwhile. `latency [--csv FILE] [--json FILE]`; half a
// minute. See bench/README.md.
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "bench/chain.hpp"
#include "bench/ride.hpp"
#include "tests/proof/heap_hook.hpp"

namespace dampline::bench {
namespace {

constexpr std::int64_t kWarmUp = 27'000;
constexpr std::int64_t kSamples = 1'000'000;

struct Times {
  std::vector<std::int32_t> ns;  // sorted
  std::uint64_t heap_calls{0};   // while they were measured
  long page_faults{0};
};

long page_faults() noexcept {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

/// The time of nothing, which every time below contains.
std::int64_t clock_ns() {
  const auto start = std::chrono::steady_clock::now();
  std::chrono::steady_clock::time_point end;
  for (int i = 0; i < 1000; ++i) end = std::chrono::steady_clock::now();
  return std::chrono::nanoseconds{end - start}.count() / 1000;
}

template <Parts kParts>
Times measure() {
  const auto chain = std::make_unique<Chain<kParts>>();
  FrameFeed feed;
  for (std::int64_t i = 0; i < kWarmUp; ++i) chain->push(feed.next());
  Times times{.ns = std::vector<std::int32_t>(static_cast<std::size_t>(kSamples))};
  const long faults = page_faults();
  const proof::HeapWatch watch;
  for (std::int32_t& time : times.ns) {
    const auto frames = feed.next();
    const auto start = std::chrono::steady_clock::now();
    chain->push(frames);
    const auto end = std::chrono::steady_clock::now();
    time = static_cast<std::int32_t>(std::chrono::nanoseconds{end - start}.count());
  }
  times.heap_calls = proof::HeapWatch::calls();
  times.page_faults = page_faults() - faults;
  std::sort(times.ns.begin(), times.ns.end());
  return times;
}

std::int32_t quantile(const Times& times, double share) {
  const auto place = static_cast<std::size_t>(share * static_cast<double>(times.ns.size()));
  return times.ns[std::min(place, times.ns.size() - 1)];
}

/// Bins of a sixteenth of an octave.
void write_csv(std::ofstream& file, std::string_view name, const std::vector<std::int32_t>& times) {
  const auto bin_of = [](std::int32_t ns) {
    return static_cast<int>(16.0 * std::log2(static_cast<double>(std::max(ns, 1))));
  };
  for (auto first = times.begin(); first != times.end();) {
    const int bin = bin_of(*first);
    const auto last =
        std::find_if(first, times.end(), [&](std::int32_t ns) { return bin_of(ns) != bin; });
    file << fmt::format("{},{:.1f},{:.1f},{}\n", name, std::exp2(bin / 16.0),
                        std::exp2((bin + 1) / 16.0), last - first);
    first = last;
  }
}

int run(int argc, char** argv) {
  std::ofstream csv;
  std::string json;
  for (int i = 1; i + 1 < argc; i += 2) {
    if (std::string_view{argv[i]} == "--csv") csv.open(argv[i + 1]);
    if (std::string_view{argv[i]} == "--json") json = argv[i + 1];
  }
  if (csv.is_open()) csv << "chain,from_ns,to_ns,samples\n";
  nlohmann::json out;
  bool quiet = true;
  fmt::print(
      "Reading the clock takes {} ns of each\n\n"
      "| ns per sample, {} samples | p50 | p90 | p99 | p99.9 | largest | calls of the heap | page "
      "faults |\n|--|--|--|--|--|--|--|--|\n",
      clock_ns(), kSamples);
  const auto report = [&](const char* name, const Times& times) {
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", name, quantile(times, 0.5),
               quantile(times, 0.9), quantile(times, 0.99), quantile(times, 0.999), times.ns.back(),
               times.heap_calls, times.page_faults);
    quiet = quiet && times.heap_calls == 0 && times.page_faults == 0;
    std::fflush(stdout);
    out["latency_ns"].push_back({{"name", name},
                                 {"p50", quantile(times, 0.5)},
                                 {"p90", quantile(times, 0.9)},
                                 {"p99", quantile(times, 0.99)},
                                 {"p99.9", quantile(times, 0.999)},
                                 {"max", times.ns.back()},
                                 {"heap_calls", times.heap_calls},
                                 {"page_faults", times.page_faults}});
    if (csv.is_open()) write_csv(csv, name, times.ns);
  };
  report("to the estimate", measure<kFramesToEstimate>());
  report("and densities", measure<kFramesToDensities>());
  report("and phase and guards", measure<kIdentifyParts>());
  report("and every candidate's sums", measure<kExplainParts>());
  if (!json.empty()) std::ofstream{json} << out.dump(2) << '\n';
  return quiet ? 0 : 1;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
