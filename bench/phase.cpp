// SPDX-License-Identifier: MIT
// The phase method's figures over many seeds as Markdown, and what a sample costs.
// `phase [RUNS]`; about a minute of processor time for 100 runs.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <vector>

#include "app/verify/phase/rows.hpp"
#include "app/verify/phase/studies.hpp"
#include "dampline/phase/view.hpp"
#include "sim_hw/noise.hpp"

namespace {

using namespace dampline;

/// Mean time of one call over `count` calls.
template <class Call>
double nanoseconds(std::size_t count, Call call) {
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < count; ++i) call(i);
  const std::chrono::duration<double, std::nano> spent = std::chrono::steady_clock::now() - start;
  return spent.count() / static_cast<double>(count);
}

std::vector<Motion> noisy_motion(std::size_t count) {
  sim::Random random{1, sim::Stream::kTrack};
  std::vector<Motion> out;
  for (std::size_t i = 0; i < count; ++i)
    out.push_back({.tick = static_cast<std::int64_t>(i),
                   .deflection_m = 1e-3 * random.normal(),
                   .velocity_mps = 2e-2 * random.normal(),
                   .relative_mps2 = 0.3 * random.normal()});
  return out;
}

void print_costs() {
  const std::vector<Motion> motion = noisy_motion(300000);
  const auto view = std::make_unique<PhaseView>(PhaseViewConfig{});
  const double whole = nanoseconds(motion.size(), [&](std::size_t i) { view->update(motion[i]); });
  PlanarityTest<1> planarity;
  const double plane = nanoseconds(motion.size(), [&](std::size_t i) {
    const Motion& m = motion[i];
    planarity.add({m.deflection_m, m.velocity_mps, m.relative_mps2}, 0.1 * static_cast<double>(i));
  });
  using Map = FrictionMap<app::kStudyNodes>;
  Map map = Map::make({-4e-3, 4e-3, 0.0}).value();
  const double friction = nanoseconds(motion.size(), [&](std::size_t i) {
    const Motion& m = motion[i];
    map.add({m.deflection_m, m.velocity_mps, m.relative_mps2}, 0.0);
  });
  fmt::print("### cost\n\n| update of | ns per call | bytes |\n|---|---|---|\n");
  fmt::print("| PhaseView: three pictures, period, sections (per sample) | {:.0f} | {} |\n", whole,
             sizeof(PhaseView));
  fmt::print("| PlanarityTest (per section point) | {:.0f} | {} |\n", plane, sizeof planarity);
  fmt::print("| FrictionMap, {} nodes (per section point) | {:.0f} | {} |\n", app::kStudyNodes,
             friction, sizeof map);
}

}  // namespace

int main(int argc, char** argv) {
  const int runs = argc > 1 ? std::atoi(argv[1]) : 100;
  if (runs < 1) {
    fmt::print(stderr, "phase: found '{}', expected a number of runs\n", argv[1]);
    return 2;
  }
  std::vector<app::PhaseRow> rows = app::resonance_rows();
  for (const auto& more : {app::planarity_rows(std::min(runs, 10)), app::linearity_rows(runs),
                           app::friction_rows(runs)})
    rows.insert(rows.end(), more.begin(), more.end());
  fmt::print("{}\n", app::markdown_of(rows));
  print_costs();
  return 0;
}
