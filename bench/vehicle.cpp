// SPDX-License-Identifier: MIT
// The 18 cases of a freight car on two trucks, in the form of the result of Kisilowski and Urbanski
// (1987): the level of dry friction per case and its mean per load. `vehicle [SECONDS [SECTION]]`:
// length of a case (300) and number of the first section of line (1); some minutes for 300 s.
#include <fmt/format.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "bench/vehicle_case.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

using Row = std::array<Trucks, kModels>;

struct Results {
  std::vector<Case> cases;
  std::vector<Row> rows;
};

std::string text(const Estimate& e) { return fmt::format("{:.0f} +- {:.0f}", e.value, e.std); }

void print_ride(const Case& c) {
  fmt::print("| {} | {:.0f} | {} | {} |", c.laden() ? "laden" : "empty", c.speed_kmh,
             c.poor_track ? "poor" : "good", c.section);
}

void print_window_cases(const Results& results) {
  fmt::print("| load | speed, km/h | track | section |");
  for (const Model& model : models()) fmt::print(" {}: leading | trailing |", model.name);
  fmt::print("\n|--|--|--|--|--|--|--|--|--|--|\n");
  for (std::size_t i = 0; i < results.cases.size(); ++i) {
    print_ride(results.cases[i]);
    for (const Trucks& trucks : results.rows[i])
      for (const Found& found : trucks) fmt::print(" {} |", text(found[kWindow].force_n));
    fmt::print("\n");
  }
}

/// Mean of the trucks, and in how many of them the method calls itself trusted.
std::string density_text(const Trucks& trucks, Method method) {
  int trusted = 0;
  for (const Found& found : trucks) trusted += found[method].trusted ? 1 : 0;
  const Spread level = over_trucks(trucks, method);
  if (level.count() == 0) return "none";
  return fmt::format("{:.0f} ({})", level.mean(), trusted);
}

void print_density_cases(const Results& results) {
  fmt::print(
      "\nThe Fokker-Planck forms on the same records, mean of both trucks in N; in parentheses in "
      "how many of the two the method's own verdict is that it can be trusted:\n\n"
      "| load | speed, km/h | track | section |");
  for (const std::size_t m : {std::size_t{0}, kModels - 1})
    fmt::print(" {}: known input | weak | paper's |", models()[m].name);
  fmt::print("\n|--|--|--|--|--|--|--|--|--|--|\n");
  for (std::size_t i = 0; i < results.cases.size(); ++i) {
    print_ride(results.cases[i]);
    for (const std::size_t m : {std::size_t{0}, kModels - 1}) {
      for (const Method method : {kKnownInput, kWeak, kPaper})
        fmt::print(" {} |", density_text(results.rows[i][m], method));
    }
    fmt::print("\n");
  }
}

sim::TruckConfig truck_of(bool laden) { return laden ? sim::laden_truck() : sim::empty_truck(); }

double truth_n(bool laden) {
  return 0.5 * (truck_of(laden).friction_positive_n + truck_of(laden).friction_negative_n);
}

/// Every force scales with the mass that the identifier is told.
double own_mass_factor(bool laden) {
  return sim::masses_of({}, truck_of(laden)).own_kg / truck_of(laden).moving_mass_kg;
}

Estimate over_cases(const Results& results, std::size_t model, Method method, bool laden) {
  Spread spread;
  for (std::size_t i = 0; i < results.cases.size(); ++i) {
    if (results.cases[i].laden() != laden) continue;
    const Spread trucks = over_trucks(results.rows[i][model], method);
    if (trucks.count() > 0) spread.add(trucks.mean());
  }
  return {spread.mean(), spread.std()};
}

struct Line {
  std::string name;
  std::size_t model;
  Method method;
  bool own_mass;
};

std::vector<Line> lines() {
  std::vector<Line> all;
  for (std::size_t m = 0; m < kModels; ++m) {
    const std::string& name = models()[m].name;
    all.push_back({name, m, kWindow, false});
    if (models()[m].body_couples) all.push_back({name + ", own mass", m, kWindow, true});
  }
  for (const std::size_t m : {std::size_t{0}, kModels - 1}) {
    const std::string& name = models()[m].name;
    all.push_back({name + ", known input", m, kKnownInput, false});
    all.push_back({name + ", weak form", m, kWeak, false});
    all.push_back({name + ", paper's form", m, kPaper, false});
  }
  return all;
}

void print_means(const Results& results) {
  fmt::print(
      "\nMean level per load in N with the standard deviation of one case; the mass of a truck is "
      "m_frame + m_body / 2, or the one it feels itself, m_frame + m_body (1 + r) / 4:\n\n"
      "| model, method | laden | off the truth | empty | off the truth |\n|--|--|--|--|--|\n");
  for (const Line& line : lines()) {
    fmt::print("| {} |", line.name);
    for (const bool laden : {true, false}) {
      Estimate e = over_cases(results, line.model, line.method, laden);
      if (line.own_mass) e = {e.value * own_mass_factor(laden), e.std * own_mass_factor(laden)};
      fmt::print(" {} | {:+.1f} % |", text(e), 100.0 * (e.value / truth_n(laden) - 1.0));
    }
    fmt::print("\n");
  }
  fmt::print("| simulated | {:.0f} | | {:.0f} | |\n", truth_n(true), truth_n(false));
  fmt::print("| published F1, F2: half their sum | 7562, 9150: 8356 | | 3154, 2720: 2937 | |\n");
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 300.0;
  const auto section = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  fmt::print(
      "Level of dry friction Fc = (F1 + F2) / 2 in N with its stated standard deviation, {:.0f} s "
      "a "
      "case:\n\n",
      seconds);
  Results results{cases(section), {}};
  for (const Case& c : results.cases) {
    Row row;
    for (std::size_t m = 0; m < kModels; ++m) row[m] = find_levels(c, models()[m], seconds);
    results.rows.push_back(row);
  }
  print_window_cases(results);
  print_density_cases(results);
  print_means(results);
  return EXIT_SUCCESS;
}
