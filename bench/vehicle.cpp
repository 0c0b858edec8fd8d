// SPDX-License-Identifier: MIT
// The 18 cases of a freight car on two trucks, in the form of the result of Kisilowski and Urbanski
// (1987): the level of dry friction per case and its mean per load. `vehicle [SECONDS [SECTION]]`:
// length of a case (300) and number of the first section of line (1); three minutes for 300 s.
#include "sim_hw/vehicle.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "dampline/identifier.hpp"
#include "sim_hw/presets.hpp"
#include "sim_hw/simulation.hpp"

namespace {

using namespace dampline;

/// Two loads, three rides, three sections of line.
struct Case {
  sim::Load load;
  double speed_kmh;
  bool poor_track;
  std::uint64_t section;
  [[nodiscard]] bool laden() const { return load == sim::Load::kLaden; }
};

std::vector<Case> cases(std::uint64_t first_section) {
  std::vector<Case> all;
  for (const auto load : {sim::Load::kLaden, sim::Load::kEmpty}) {
    for (const auto& [speed_kmh, poor] : {std::pair{60.0, false}, {80.0, false}, {80.0, true}}) {
      for (std::uint64_t i = 0; i < 3; ++i)
        all.push_back({load, speed_kmh, poor, first_section + i});
    }
  }
  return all;
}

/// How much of equation 1 is simulated.
struct Model {
  std::string name;
  bool body_couples;  // the body's mass is not at the pivots
  bool frames_pitch;  // the frames have inertia
};

const std::array<Model, 3>& models() {
  static const std::array<Model, 3> all{{{"equation 2: trucks apart", false, false},
                                         {"body couples the trucks", true, false},
                                         {"four degrees of freedom", true, true}}};
  return all;
}

sim::SimulationConfig simulation_of(const Case& c, const Model& model, sim::TruckPosition truck) {
  sim::SimulationConfig config = sim::reference_run(c.load, c.speed_kmh, c.section);
  if (c.poor_track) config.track.amplitude_m_rad = sim::kTrackAmplitudeHigh;
  sim::VehicleConfig vehicle;
  if (!model.body_couples) vehicle.gyration_radius_m = vehicle.half_pivot_distance_m;
  vehicle.instrumented = truck;
  config.vehicle = vehicle;
  if (model.frames_pitch) config.truck.modes.pitch_inertia_kgm2 = sim::kFramePitchInertiaKgm2;
  return config;
}

/// The level that the shipped identifier finds from one truck's three accelerometers, with the mass
/// m_frame + m_body / 2.
Estimate level_of(const sim::SimulationConfig& config, double seconds) {
  IdentifierConfig identifier_config;
  identifier_config.moving_mass_kg = config.truck.moving_mass_kg;
  const auto identifier = std::make_unique<Identifier>(identifier_config);
  sim::Simulation simulation{config};
  const auto samples = std::llround(seconds * sim::kSampleRateHz);
  for (std::int64_t i = 0; i < samples; ++i)
    static_cast<void>(identifier->update(sim::to_sample(simulation.next())));
  identifier->finish();
  return identifier->snapshot().coulomb_n;
}

struct Levels {
  Estimate leading, trailing;
  [[nodiscard]] Estimate mean() const {
    return {0.5 * (leading.value + trailing.value), 0.5 * std::hypot(leading.std, trailing.std)};
  }
};

Levels identify(const Case& c, const Model& model, double seconds) {
  return {level_of(simulation_of(c, model, sim::TruckPosition::kLeading), seconds),
          level_of(simulation_of(c, model, sim::TruckPosition::kTrailing), seconds)};
}

using Row = std::array<Levels, 3>;  // by model

std::string text(const Estimate& e) { return fmt::format("{:.0f} +- {:.0f}", e.value, e.std); }

void print_cases(const std::vector<Case>& all, const std::vector<Row>& rows) {
  fmt::print("| load | speed, km/h | track | section |");
  for (const Model& model : models()) fmt::print(" {}: leading | trailing |", model.name);
  fmt::print("\n|--|--|--|--|--|--|--|--|--|--|\n");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Case& c = all[i];
    fmt::print("| {} | {:.0f} | {} | {} |", c.laden() ? "laden" : "empty", c.speed_kmh,
               c.poor_track ? "poor" : "good", c.section);
    for (const Levels& levels : rows[i])
      fmt::print(" {} | {} |", text(levels.leading), text(levels.trailing));
    fmt::print("\n");
  }
}

/// Mean over the cases of one load and the standard deviation of one case.
Estimate over_cases(const std::vector<Case>& all, const std::vector<Row>& rows, std::size_t model,
                    bool laden) {
  double sum = 0.0;
  double squares = 0.0;
  double count = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].laden() != laden) continue;
    const double level = rows[i][model].mean().value;
    sum += level;
    squares += level * level;
    count += 1.0;
  }
  const double mean = sum / count;
  return {mean, std::sqrt((squares - count * mean * mean) / (count - 1.0))};
}

sim::TruckConfig truck_of(bool laden) { return laden ? sim::laden_truck() : sim::empty_truck(); }

double truth_n(bool laden) {
  return 0.5 * (truck_of(laden).friction_positive_n + truck_of(laden).friction_negative_n);
}

/// Every force scales with the mass that the identifier is told.
double own_mass_factor(bool laden) {
  return sim::masses_of({}, truck_of(laden)).own_kg / truck_of(laden).moving_mass_kg;
}

void print_mean(const std::vector<Case>& all, const std::vector<Row>& rows, std::size_t model,
                bool own_mass) {
  fmt::print("| {}{} |", models()[model].name, own_mass ? ", own mass" : "");
  for (const bool laden : {true, false}) {
    Estimate e = over_cases(all, rows, model, laden);
    if (own_mass) e = {e.value * own_mass_factor(laden), e.std * own_mass_factor(laden)};
    fmt::print(" {} | {:+.1f} % |", text(e), 100.0 * (e.value / truth_n(laden) - 1.0));
  }
  fmt::print("\n");
}

void print_means(const std::vector<Case>& all, const std::vector<Row>& rows) {
  fmt::print(
      "\nMean level per load in N with the standard deviation of one case; the mass of a truck is "
      "m_frame + m_body / 2, or the one it feels itself, m_frame + m_body (1 + r) / 4:\n\n"
      "| model | laden | off the truth | empty | off the truth |\n|--|--|--|--|--|\n");
  for (std::size_t m = 0; m < models().size(); ++m) {
    print_mean(all, rows, m, false);
    if (models()[m].body_couples) print_mean(all, rows, m, true);
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
  const std::vector<Case> all = cases(section);
  std::vector<Row> rows;
  for (const Case& c : all) {
    Row row;
    for (std::size_t m = 0; m < row.size(); ++m) row[m] = identify(c, models()[m], seconds);
    rows.push_back(row);
  }
  print_cases(all, rows);
  print_means(all, rows);
  return EXIT_SUCCESS;
}
