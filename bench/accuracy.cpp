// SPDX-License-Identifier: MIT
// The accuracy tables of the README: simulated cars whose parameters are known, fresh seeds, every
// figure with its bound. `accuracy [SEEDS [FIRST_SEED]]`; about a minute for 12 seeds.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy_case.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

const std::vector<double> kLengthsS{20.0, 60.0, 300.0};

struct Seeds {
  std::uint64_t first{1001};
  int count{12};
};

/// A largest value beyond its bound (0: none) is marked.
std::string text(const Spread& spread, double bound) {
  return spread.percent(2) + (bound > 0.0 && spread.largest > bound ? " (!)" : "");
}

struct Cell {
  Spread coulomb, stiffness, false_viscous, curve;
  int inside{0};
  int lower_bound{0};
  void add(const Errors& e) {
    coulomb.add(e.coulomb);
    stiffness.add(e.stiffness);
    false_viscous.add(e.false_viscous);
    curve.add(e.curve);
    inside +=
        (std::abs(e.coulomb_sigmas) <= 2.0 ? 1 : 0) + (std::abs(e.stiffness_sigmas) <= 2.0 ? 1 : 0);
    lower_bound += e.snapshot.std_is_lower_bound ? 1 : 0;
  }
};

struct Row {
  std::vector<Cell> at = std::vector<Cell>(kLengthsS.size());
  Spread velocity, deflection;
};

Row run(const AccuracyCase& c, const Seeds& seeds, const EstimatorConfig& config = {}) {
  Row row;
  for (int i = 0; i < seeds.count; ++i) {
    const RunErrors r = run_case(c, seeds.first + static_cast<std::uint64_t>(i), kLengthsS, config);
    for (std::size_t l = 0; l < r.at.size(); ++l) row.at[l].add(r.at[l]);
    row.velocity.add(r.velocity);
    row.deflection.add(r.deflection);
  }
  return row;
}

/// Bounds in fractions; 0: none stated.
struct Bounds {
  double coulomb, stiffness, false_viscous, curve;
};
Bounds bounds(std::size_t length, bool laden) {
  if (length == 0) return {0.015, 0.0, 0.0, 0.0};
  if (length == 1) return {0.01, 0.03, 0.0, 0.035};
  return {0.004, laden ? 0.013 : 0.02, 0.006, 0.026};
}

void standard_table(const Seeds& seeds, std::vector<int>& inside) {
  fmt::print("Errors in %, mean / largest over {} seeds; (!) marks a figure beyond its bound.\n\n",
             seeds.count);
  fmt::print(
      "| condition | after | Fc | stiffness | false viscous | curve | velocity | deflection |\n");
  fmt::print("|--|--|--|--|--|--|--|--|\n");
  for (const AccuracyCase& c : standard_cases()) {
    const Row row = run(c, seeds);
    for (std::size_t l = 0; l < kLengthsS.size(); ++l) {
      const Bounds b = bounds(l, c.name.starts_with("laden"));
      const Cell& cell = row.at[l];
      const bool last = l + 1 == kLengthsS.size();
      fmt::print("| {} | {:.0f} s | {} | {} | {} | {} | {} | {} |\n", c.name, kLengthsS[l],
                 text(cell.coulomb, b.coulomb), text(cell.stiffness, b.stiffness),
                 text(cell.false_viscous, b.false_viscous), text(cell.curve, b.curve),
                 last ? text(row.velocity, 0.09) : "", last ? text(row.deflection, 0.0) : "");
      inside[l] += cell.inside;
    }
  }
}

void coverage_table(const Seeds& seeds, const std::vector<int>& inside) {
  const int total = 2 * 4 * seeds.count;
  fmt::print(
      "\nLevel and stiffness within two stated standard deviations, all conditions (90 to 99 % "
      "wanted):\n\n");
  fmt::print("| after | within | of |\n|--|--|--|\n");
  for (std::size_t l = 0; l < kLengthsS.size(); ++l) {
    fmt::print("| {:.0f} s | {:.1f} % | {} |\n", kLengthsS[l], 100.0 * inside[l] / total, total);
  }
}

using Change = std::function<void(AccuracyCase&, EstimatorConfig&)>;

void changed_table(const std::string& title, double coulomb_bound, const Seeds& seeds,
                   const Change& change, const char* only = "") {
  fmt::print(
      "\n{}\n\n| condition | Fc | stiffness | false viscous | curve | lower bound stated "
      "|\n|--|--|--|--|--|--|\n",
      title);
  for (AccuracyCase c : standard_cases()) {
    if (!c.name.ends_with(only)) continue;
    EstimatorConfig config;
    change(c, config);
    const Row row = run(c, seeds, config);
    const Cell& cell = row.at.back();
    fmt::print("| {} | {} | {} | {} | {} | {} of {} |\n", c.name, text(cell.coulomb, coulomb_bound),
               text(cell.stiffness, 0.0), text(cell.false_viscous, 0.0), text(cell.curve, 0.0),
               cell.lower_bound, seeds.count);
  }
}

void asymmetry_table(const Seeds& seeds) {
  fmt::print(
      "\nThe same friction split unevenly, (7562, 9150) N, and evenly, (8356, 8356) N; laden 80, "
      "300 s:\n\n");
  Spread coulomb;
  Spread stiffness;
  AccuracyCase uneven = standard_cases().front();
  AccuracyCase even = uneven;
  even.simulation.truck.friction_positive_n = even.simulation.truck.friction_negative_n = 8356.0;
  for (int i = 0; i < seeds.count; ++i) {
    const auto seed = seeds.first + static_cast<std::uint64_t>(i);
    const Errors a = run_case(uneven, seed, {300.0}).at[0];
    const Errors b = run_case(even, seed, {300.0}).at[0];
    coulomb.add(a.coulomb - b.coulomb);
    stiffness.add(a.stiffness - b.stiffness);
  }
  fmt::print("| difference in % | Fc | stiffness |\n|--|--|--|\n| mean / largest | {} | {} |\n",
             text(coulomb, 0.005), text(stiffness, 0.005));
}

void harder_tables(const Seeds& seeds) {
  changed_table("Standstill of 60 s in the middle, 300 s:", 0.004, seeds,
                [](AccuracyCase& c, EstimatorConfig&) {
                  c.simulation.speed.standstills[0] = {120.0, 180.0};
                });
  changed_table(
      "Speed changes from 80 to 60 km/h in the middle, 300 s:", 0.004, seeds,
      [](AccuracyCase& c, EstimatorConfig&) {
        c.simulation.speed.change_time_s = 150.0;
        c.simulation.speed.changed_speed_mps = 60.0 / 3.6;
      },
      "80");
  changed_table("Five times the sensor noise, 300 s:", 0.03, seeds,
                [](AccuracyCase& c, EstimatorConfig&) { c.simulation.sensors.noise_mps2 = 0.1; });
  changed_table("Four times the friction, 300 s:", 0.04, seeds,
                [](AccuracyCase& c, EstimatorConfig&) { c.simulation.truck.friction_scale = 4.0; });
}

void choice_tables(const Seeds& seeds) {
  changed_table("Standard, 300 s, without the lift of fast velocity:", 0.004, seeds,
                [](AccuracyCase&, EstimatorConfig& i) { i.anti_alias.corner_hz = 0.0; });
  changed_table("Standard, 300 s, velocity corner 1.0 Hz:", 0.004, seeds,
                [](AccuracyCase&, EstimatorConfig& i) { i.velocity_corner_hz = 1.0; });
}

}  // namespace

int main(int argc, char** argv) {
  Seeds seeds;
  if (argc > 1) seeds.count = std::max(1, std::atoi(argv[1]));
  if (argc > 2) seeds.first = static_cast<std::uint64_t>(std::atoll(argv[2]));
  std::vector<int> inside(kLengthsS.size());
  standard_table(seeds, inside);
  coverage_table(seeds, inside);
  asymmetry_table(seeds);
  harder_tables(seeds);
  choice_tables(seeds);
  return EXIT_SUCCESS;
}
