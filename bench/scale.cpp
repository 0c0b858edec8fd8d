// SPDX-License-Identifier: MIT
// How the cost of a sample grows: with the number of terms, of segments of a broken line, of trucks
// in one process, and with the length of the window; and how far it is from what the core can do.
// `scale [--json FILE]`; a minute. See bench/README.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "bench/chain.hpp"
#include "bench/fleet.hpp"
#include "bench/peers/rows.hpp"
#include "bench/ride.hpp"
#include "published/wavelet/estimates.hpp"

namespace dampline::bench {
namespace {

constexpr int kRounds = 5;

template <class Work>
double best_ns(Work work) {
  std::vector<Contestant> one{{"", work}};
  race(one, kRounds);
  return one[0].best_ns;
}

/// What this core can do: multiplications and additions a nanosecond on two doubles at once, as the
/// build's instruction set has them, from registers.
double flops_per_ns() {
  using Two = double __attribute__((vector_size(16)));
  constexpr int kTurns = 2'000'000;
  double sink = 0.0;
  const double ns = best_ns([&sink] {
    const Two a = Two{} + (1.0 + 1e-9);
    const Two b = Two{} + 1e-9;
    Two s0 = a, s1 = a, s2 = a, s3 = a, s4 = a, s5 = a, s6 = a, s7 = a;
    for (int i = 0; i < kTurns; ++i) {
      s0 = s0 * a + b;
      s1 = s1 * a + b;
      s2 = s2 * a + b;
      s3 = s3 * a + b;
      s4 = s4 * a + b;
      s5 = s5 * a + b;
      s6 = s6 * a + b;
      s7 = s7 * a + b;
    }
    const Two all = s0 + s1 + s2 + s3 + s4 + s5 + s6 + s7;
    sink += all[0] + all[1];
  });
  return sink > 0.0 ? 8.0 * 4.0 * kTurns / ns : 0.0;
}

/// Instructions a nanosecond at most: additions of which none waits for its neighbours. 0 where
/// their encoding is not known.
double instructions_per_ns() {
#ifdef __x86_64__
  constexpr int kTurns = 1'000'000;
  const double ns = best_ns([] {
    std::uint64_t a = 0, b = 0, c = 0, d = 0, e = 0, f = 0;
    for (int i = 0; i < kTurns; ++i)
      asm volatile(
          "add $1, %0\n add $1, %1\n add $1, %2\n add $1, %3\n add $1, %4\n add $1, %5\n"
          "add $1, %0\n add $1, %1\n add $1, %2\n add $1, %3\n add $1, %4\n add $1, %5\n"
          "add $1, %0\n add $1, %1\n add $1, %2\n add $1, %3\n add $1, %4\n add $1, %5\n"
          : "+r"(a), "+r"(b), "+r"(c), "+r"(d), "+r"(e), "+r"(f));
  });
  return 18.0 * kTurns / ns;
#else
  return 0.0;
#endif
}

/// Bytes a nanosecond read and written over `bytes` of memory.
double bytes_per_ns(std::size_t bytes) {
  std::vector<double> from(bytes / sizeof(double) / 2, 1.0);
  std::vector<double> into(from.size());
  const int turns = static_cast<int>(std::max<std::size_t>(1, 64'000'000 / bytes));
  double factor = 1.0;
  const double ns = best_ns([&] {
    for (int t = 0; t < turns; ++t) {
      factor += 1e-9;
      for (std::size_t i = 0; i < from.size(); ++i) into[i] = factor * from[i];
    }
  });
  return into.back() > 0.0 ? static_cast<double>(bytes) * turns / ns : 0.0;
}

struct Limit {
  double instructions_per_ns;
  double flops_per_ns;
  double near_bytes_per_ns;  // 16 KiB, the first cache
  double far_bytes_per_ns;   // 256 MiB, memory
};

template <int N>
double row_ns(const std::vector<Column<N>>& x, const std::vector<double>& y) {
  return best_ns([&] {
           RecursiveEstimate<N> estimate;
           typename RecursiveEstimate<N>::Factor::Row row;
           for (std::size_t i = 0; i < x.size(); ++i) {
             row << x[i], y[i];
             estimate.absorb(row);
           }
           volatile double keep = estimate.information().at(0, 0);
           static_cast<void>(keep);
         }) /
         static_cast<double>(x.size());
}

/// Reflections of panels of K rows on C columns: (2 K + 2) C^2 flops for each panel, and the
/// factor's C^2 / 2 numbers and the panel's K C / 2 in the mean, read and written at each column.
template <int N>
void print_terms(const Limit& limit, double ns, const char* what, nlohmann::json& out) {
  constexpr double kColumns = N + 1;
  constexpr double kPanel = RecursiveEstimate<N>::kPanel;
  constexpr double kFlops = (2.0 * kPanel + 2.0) * kColumns * kColumns / kPanel;
  constexpr double kBytes = 16.0 * kColumns * kColumns * (0.5 + 0.5 * kPanel) / kPanel;
  const double least_ns = std::max(kFlops / limit.flops_per_ns, kBytes / limit.near_bytes_per_ns);
  fmt::print("| {} | {} | {:.0f} | {:.3f} | {:.0f} | {:.0f} | {:.0f} | {:.1f} |\n", what, N, ns,
             ns / (kColumns * kColumns), kFlops, kBytes, least_ns, ns / least_ns);
  std::fflush(stdout);
  out["terms"].push_back({{"rows", what},
                          {"terms", N},
                          {"ns_per_row", ns},
                          {"flops", kFlops},
                          {"bytes", kBytes},
                          {"least_ns", least_ns}});
}

template <int N>
void terms(const Limit& limit, nlohmann::json& out) {
  const Problem<N> problem{6'000};
  print_terms<N>(limit, row_ns<N>(problem.x, problem.y), "dense", out);
}

/// Spring, damper and a broken line with S segments in rows: hats over the velocity of the ride.
template <int S>
void segments(const Limit& limit, nlohmann::json& out) {
  constexpr int kUnknowns = S + 2;
  std::vector<Column<kUnknowns>> x;
  std::vector<double> y;
  for (std::size_t i = 0; i < 6'000; ++i) {
    const Motion& m = heard()[9'000 + i].result.motion;
    Column<kUnknowns> row = Column<kUnknowns>::Zero();
    const double place = std::clamp((m.velocity_mps / 0.05 + 1.0) * 0.5 * (S - 1), 0.0, S - 1.001);
    const int left = static_cast<int>(place);
    row[left] = 1.0 - (place - left);
    row[left + 1] = place - left;
    row[S] = m.deflection_m;
    row[S + 1] = m.relative_mps2;
    x.push_back(row);
    y.push_back(m.frame_mps2);
  }
  print_terms<kUnknowns>(limit, row_ns<kUnknowns>(x, y), "broken line, two more", out);
}

/// How many trucks, and how many samples of one in a row.
void trucks(const Limit& limit, nlohmann::json& out) {
  const double mib = static_cast<double>(sizeof(Fleet::Truck)) / (1024.0 * 1024.0);
  fmt::print(
      "\n| trucks | memory, MiB | samples of one in a row | ns per truck and sample | times one "
      "truck | misses of the last cache per truck and sample |\n|--|--|--|--|--|--|\n");
  std::map<std::size_t, double> one_ns;
  for (const std::size_t count : {1U, 100U, 1'000U, 10'000U}) {
    Fleet fleet{count};
    for (const std::size_t batch : {std::size_t{1}, std::size_t{8}, Fleet::kLongestBatch}) {
      const TruckCost cost = fleet.cost(batch);
      const double times_one = cost.ns / one_ns.emplace(batch, cost.ns).first->second;
      const double all_mib = mib * static_cast<double>(count);
      fmt::print(
          "| {} | {:.1f} | {} | {:.0f} | {:.2f} | {} |\n", count, all_mib, batch, cost.ns,
          times_one,
          cost.cache_misses ? fmt::format("{:.1f}", *cost.cache_misses) : "not counted here");
      std::fflush(stdout);
      out["trucks"].push_back({{"trucks", count},
                               {"mib", all_mib},
                               {"in_a_row", batch},
                               {"ns_per_sample", cost.ns},
                               {"times_one", times_one},
                               {"cache_misses_per_sample", nullptr}});
      if (cost.cache_misses) out["trucks"].back()["cache_misses_per_sample"] = *cost.cache_misses;
    }
  }
  fmt::print("Memory gives {:.1f} bytes a ns, the first cache {:.1f}\n", limit.far_bytes_per_ns,
             limit.near_bytes_per_ns);
}

void windows(nlohmann::json& out) {
  fmt::print("\n| memory | ns per sample of Estimator::update |\n|--|--|\n");
  const auto measure = [&out](const char* name, Memory memory, double seconds) {
    EstimatorConfig config = chain_config().estimator;
    config.memory = memory;
    if (memory != Memory::kInfinite) config.memory_s = seconds;
    const auto identifier = std::make_unique<Estimator>(config);
    SampleFeed feed;
    for (int i = 0; i < 60'000; ++i) static_cast<void>(identifier->update(feed.next()));
    const double ns = best_ns([&] {
                        for (int i = 0; i < 30'000; ++i)
                          static_cast<void>(identifier->update(feed.next()));
                      }) /
                      30'000.0;
    fmt::print("| {} | {:.0f} |\n", name, ns);
    out["windows"].push_back({{"memory", name}, {"ns_per_sample", ns}});
  };
  measure("everything", Memory::kInfinite, 0.0);
  measure("window of 30 s", Memory::kWindow, 30.0);
  measure("window of 300 s", Memory::kWindow, 300.0);
  measure("window of 3600 s", Memory::kWindow, 3600.0);
  measure("forgetting, 60 s", Memory::kForgetting, 60.0);
}

int run(int argc, char** argv) {
  nlohmann::json out;
  const Limit limit{instructions_per_ns(), flops_per_ns(), bytes_per_ns(16'384),
                    bytes_per_ns(std::size_t{256} << 20U)};
  fmt::print(
      "This core: {:.1f} instructions a ns, {:.1f} flops from registers; bytes a ns {:.1f} in 16 "
      "KiB, {:.1f} in "
      "256 MiB\n\n",
      limit.instructions_per_ns, limit.flops_per_ns, limit.near_bytes_per_ns,
      limit.far_bytes_per_ns);
  out["limit"] = {{"instructions_per_ns", limit.instructions_per_ns},
                  {"flops_per_ns", limit.flops_per_ns},
                  {"bytes_per_ns_16_KiB", limit.near_bytes_per_ns},
                  {"bytes_per_ns_256_MiB", limit.far_bytes_per_ns}};
  fmt::print(
      "| rows | unknowns n | ns per row | ns / (n + 1)^2 | flops | bytes | least ns by these "
      "| times that |\n|--|--|--|--|--|--|--|--|\n");
  terms<8>(limit, out);
  terms<16>(limit, out);
  terms<32>(limit, out);
  terms<64>(limit, out);
  segments<4>(limit, out);
  segments<8>(limit, out);
  segments<20>(limit, out);
  segments<40>(limit, out);
  trucks(limit, out);
  windows(out);
  if (argc == 3 && std::string_view{argv[1]} == "--json")
    std::ofstream{argv[2]} << out.dump(2) << '\n';
  return 0;
}

}  // namespace
}  // namespace dampline::bench

int main(int argc, char** argv) { return dampline::bench::run(argc, argv); }
