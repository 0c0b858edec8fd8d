// SPDX-License-Identifier: MIT
// The 18 cases of a freight car on two trucks, in the form of the result of Kisilowski and Urbanski
// (1987): the level of dry friction per case and its mean per load. `vehicle [SECONDS [SECTION]]`:
// length of a case (300) and number of the first section of line (1); some minutes for 300 s.
#include "sim_hw/vehicle.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/errors.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/density/fokker_planck.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::bench {

/// Two loads, three rides, three sections of line.
struct Case {
  sim::Load load;
  double speed_kmh;
  bool poor_track;
  std::uint64_t section;
  [[nodiscard]] bool laden() const { return load == sim::Load::kLaden; }
};

inline std::vector<Case> cases(std::uint64_t first_section) {
  std::vector<Case> all;
  for (const auto load : {sim::Load::kLaden, sim::Load::kEmpty}) {
    for (const auto& [speed_kmh, poor] : {std::pair{60.0, false}, {80.0, false}, {80.0, true}}) {
      for (std::uint64_t i = 0; i < 3; ++i)
        all.push_back({load, speed_kmh, poor, first_section + i});
    }
  }
  return all;
}

inline constexpr std::size_t kModels = 3;
/// How much of equation 1 is simulated.
struct Model {
  std::string name;
  bool body_couples;  // the body's mass is not at the pivots
  bool frames_pitch;  // the frames have inertia
};

inline const std::array<Model, kModels>& models() {
  static const std::array<Model, kModels> all{{{"equation 2: trucks apart", false, false},
                                               {"body couples the trucks", true, false},
                                               {"four degrees of freedom", true, true}}};
  return all;
}

inline sim::SimulationConfig simulation_of(const Case& c, const Model& model,
                                           sim::TruckPosition truck) {
  sim::SimulationConfig config = sim::reference_run(c.load, c.speed_kmh, c.section);
  if (c.poor_track) config.track.amplitude_m_rad = sim::kTrackAmplitudeHigh;
  sim::VehicleConfig vehicle;
  if (!model.body_couples) vehicle.gyration_radius_m = vehicle.half_pivot_distance_m;
  vehicle.instrumented = truck;
  config.vehicle = vehicle;
  if (model.frames_pitch) config.truck.modes.pitch_inertia_kgm2 = sim::kFramePitchInertiaKgm2;
  return config;
}

/// What is compared: the shipped window estimate and the Fokker-Planck forms.
enum Method : std::size_t { kWindow, kKnownInput, kWeak, kPaper, kMethods };

struct Level {
  Estimate force_n;
  bool has_number{false};
  bool trusted{false};
};
using Found = std::array<Level, kMethods>;

inline Level level_of(const MethodResult& result) {
  return {result.level_n, result.verdict.has_number, result.verdict.trusted};
}

/// The levels from one truck's three accelerometers; the mass is m_frame + m_body / 2 and, for the
/// Fokker-Planck forms, the stiffness is known, as in the paper.
inline Found find_levels(const sim::SimulationConfig& config, double seconds) {
  const sim::TruckConfig& truck = config.truck;
  EstimatorConfig identifier_config;
  identifier_config.moving_mass_kg = truck.moving_mass_kg;
  const auto identifier = std::make_unique<Estimator>(identifier_config);
  const auto densities = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{});
  sim::Simulation simulation{config};
  const auto samples = std::llround(seconds * sim::kSampleRateHz);
  for (std::int64_t i = 0; i < samples; ++i) {
    const UpdateResult result = identifier->update(sim::to_sample(simulation.next()));
    if (result.has_motion) densities->update(result.motion);
  }
  identifier->finish();
  const Snapshot snapshot = identifier->snapshot();
  const FokkerPlanckEstimates estimates =
      densities->estimates(truck.moving_mass_kg, truck.stiffness_npm);
  return {Level{snapshot.coulomb_n, snapshot.valid, snapshot.valid},
          level_of(estimates.known_input), level_of(estimates.weak), level_of(estimates.paper)};
}

using Trucks = std::array<Found, 2>;  // leading, trailing

inline Trucks find_levels(const Case& c, const Model& model, double seconds) {
  return {find_levels(simulation_of(c, model, sim::TruckPosition::kLeading), seconds),
          find_levels(simulation_of(c, model, sim::TruckPosition::kTrailing), seconds)};
}

/// A case's level is the mean of its trucks'.
inline Spread over_trucks(const Trucks& trucks, Method method) {
  Spread spread;
  for (const Found& found : trucks)
    if (found[method].has_number) spread.add(found[method].force_n.value);
  return spread;
}

}  // namespace dampline::bench

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
