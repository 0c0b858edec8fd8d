// SPDX-License-Identifier: MIT
// The 18 cases of a freight car on two trucks, in the form of the result of Kisilowski and Urbanski
// (1987): the level of dry friction per case and its mean per load. `vehicle [SECONDS [SECTION]]`:
// length of a case (100) and number of the first section of line (1); three minutes for 100 s.
#include "sim_hw/vehicle.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/explanation.hpp"
#include "bench/errors.hpp"
#include "dampline/identifier.hpp"
#include "sim_hw/simulation.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

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

/// What is compared: equation 2 on a truck alone, and on a truck of the whole car, which pitches
/// and is pushed by the other one: as it is, explained, with two more accelerometers, and by the
/// Fokker-Planck forms.
enum Method : std::size_t { kAlone, kWindow, kExplained, kExtras, kKnownInput, kWeak, kPaper };
constexpr std::array<const char*, kPaper + 1> kNames{"equation 2: a truck alone",
                                                     "whole car",
                                                     "whole car, explained",
                                                     "whole car, five sensors",
                                                     "known input",
                                                     "weak form",
                                                     "paper's form"};

struct Level {
  Estimate force_n{}, stiffness_npm{};
  bool has_number{true};
  bool trusted{true};
};
using Found = std::array<Level, kNames.size()>;
using Trucks = std::array<Found, 2>;  // leading, trailing

sim::SimulationConfig ride(const Case& c) {
  sim::SimulationConfig config = sim::reference_run(c.load, c.speed_kmh, c.section);
  if (c.poor_track) config.track.amplitude_m_rad = sim::kTrackAmplitudeHigh;
  return config;
}

Level level_of(const Snapshot& s) { return {s.coulomb_n, s.stiffness_npm, s.valid, s.valid}; }
Level level_of(const MethodResult& result) {
  return {result.level_n, {}, result.verdict.has_number, result.verdict.trusted};
}

using Identifying = BasicIdentifier<kIdentifyParts>;

struct Densities {
  FokkerPlanck& densities;
  void taken(const Sample& /*unused*/) const noexcept {}
  void judged(const Sample& /*unused*/, const UpdateResult& result) const noexcept {
    if (result.has_motion) densities.update(result.motion);
  }
};

Level find_alone(const Case& c, double seconds) {
  const sim::SimulationConfig config = ride(c);
  EstimatorConfig estimator;
  estimator.moving_mass_kg = config.truck.moving_mass_kg;
  const auto found = std::make_unique<Estimator>(estimator);
  sim::Simulation simulation{config};
  for (auto i = std::llround(seconds * sim::kSampleRateHz); i > 0; --i)
    static_cast<void>(found->update(sim::to_sample(simulation.next())));
  found->finish();
  return level_of(found->snapshot());
}

/// A record as `explain` reads it; gone with this object.
class Record {
 public:
  Record()
      : path_{(std::filesystem::temp_directory_path() /
               fmt::format("vehicle_{}_{}.csv", ::getpid(), next_number_++))
                  .string()} {
    text_ = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;
  ~Record() { std::filesystem::remove(path_); }
  void add(const Sample& sample) {
    const auto& a = sample.accel_mps2;
    text_ += fmt::format("{:.6f},{:.6f},{:.6f},{:.6f}\n",
                         static_cast<double>(sample.tick) / sim::kSampleRateHz, a[0], a[1], a[2]);
  }
  /// The final law, as the program prints and trusts it.
  [[nodiscard]] Level explained(double moving_mass_kg) const {
    std::ofstream{path_} << text_;
    app::Config settings;
    settings.car.moving_mass_kg = moving_mass_kg;
    const app::Explained found = app::explain_truck(settings, {{path_, false}, {}, false});
    const auto& e = found.explanation;
    return {e.final_coulomb_n, e.final_stiffness_npm, true,
            app::told(found).trust == app::Trust::kTrusted};
  }

 private:
  static inline std::atomic<int> next_number_{0};
  std::string path_;
  std::string text_;
};

/// The mass is the one that belongs to the reduction, and the Fokker-Planck forms know the
/// stiffness, as in the paper.
void find_whole(const Case& c, sim::TruckPosition position, double seconds, Found& out) {
  sim::SimulationConfig config = ride(c);
  config.vehicle.emplace().instrumented = position;
  config.extra_sensors = true;
  sim::ModeEffects& modes = config.truck.modes;
  modes.pitch_inertia_kgm2 = sim::kFramePitchInertiaKgm2;
  const sim::VehicleMasses masses = sim::masses_of(*config.vehicle, config.truck);
  IdentifierConfig three;
  three.estimator.moving_mass_kg = masses.own_kg;
  EstimatorConfig five = three.estimator;
  five.far_mass_kg = masses.other_kg;
  five.frame_pitch_mass_kg = modes.pitch_inertia_kgm2 / std::pow(modes.pitch_half_wheelbase_m, 2);
  const auto diagnosed = std::make_unique<Identifying>(three);
  const auto with_extras = std::make_unique<Estimator>(five);
  const auto densities = std::make_unique<FokkerPlanck>(FokkerPlanckConfig{});
  Densities observer{*densities};
  Record record;
  sim::Simulation simulation{config};
  for (auto i = std::llround(seconds * sim::kSampleRateHz); i > 0; --i) {
    const Sample sample = sim::to_sample(simulation.next());
    record.add(sample);
    diagnosed->push(sample, observer);
    static_cast<void>(with_extras->update(sample));
  }
  diagnosed->finish(observer);
  with_extras->finish();
  out[kWindow] = level_of(diagnosed->snapshot());
  out[kExtras] = level_of(with_extras->snapshot());
  out[kExplained] = record.explained(masses.own_kg);
  const auto forms = densities->estimates(masses.own_kg, config.truck.stiffness_npm);
  out[kKnownInput] = level_of(forms.known_input);
  out[kWeak] = level_of(forms.weak);
  out[kPaper] = level_of(forms.paper);
}

Trucks find(const Case& c, double seconds) {
  Trucks out{};
  out[0][kAlone] = out[1][kAlone] = find_alone(c, seconds);
  find_whole(c, sim::TruckPosition::kLeading, seconds, out[0]);
  find_whole(c, sim::TruckPosition::kTrailing, seconds, out[1]);
  return out;
}

/// One thread a processor; cases are independent.
std::vector<Trucks> find_all(const std::vector<Case>& all, double seconds) {
  std::vector<Trucks> out(all.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::jthread> threads;
  for (unsigned t = std::max(1U, std::thread::hardware_concurrency()); t > 0; --t) {
    threads.emplace_back([&] {
      for (std::size_t i = next++; i < all.size(); i = next++) out[i] = find(all[i], seconds);
    });
  }
  threads.clear();
  return out;
}

double truth_n(bool laden) {
  const sim::TruckConfig truck = laden ? sim::laden_truck() : sim::empty_truck();
  return 0.5 * (truck.friction_positive_n + truck.friction_negative_n);
}
double truth_npm(bool laden) {
  return (laden ? sim::laden_truck() : sim::empty_truck()).stiffness_npm;
}

/// How far the explained levels and stiffnesses are off, in their own deviations.
void print_coverage(const std::vector<Case>& all, const std::vector<Trucks>& found) {
  Spread force;
  Spread stiffness;
  std::size_t within = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const Found& truck : found[i]) {
      const Level& level = truck[kExplained];
      const auto distance = [&](const Estimate& e, double truth) {
        within += static_cast<std::size_t>(std::abs(e.value - truth) < 2.0 * e.std);
        return (e.value - truth) / e.std;
      };
      force.add(distance(level.force_n, truth_n(all[i].laden())));
      stiffness.add(distance(level.stiffness_npm, truth_npm(all[i].laden())));
    }
  }
  fmt::print(
      "\nExplained: {} of {} numbers within two deviations; the distance in deviations, mean and "
      "spread: level {:+.1f} +- {:.1f}, stiffness {:+.1f} +- {:.1f}.\n",
      within, force.count() + stiffness.count(), force.mean(), force.std(), stiffness.mean(),
      stiffness.std());
}

/// A case's level is the mean of its trucks'; in parentheses, in how many of them the method's own
/// verdict is that it can be trusted.
std::string cell(const Trucks& trucks, Method method) {
  Spread level;
  int trusted = 0;
  for (const Found& found : trucks) {
    if (found[method].has_number) level.add(found[method].force_n.value);
    trusted += found[method].trusted ? 1 : 0;
  }
  if (level.count() == 0) return "none";
  if (method < kKnownInput && method != kExplained) return fmt::format("{:.0f}", level.mean());
  return fmt::format("{:.0f} ({})", level.mean(), trusted);
}

void print_cases(const std::vector<Case>& all, const std::vector<Trucks>& found) {
  fmt::print("| load | speed, km/h | track | section |");
  for (const char* name : kNames) fmt::print(" {} |", name);
  fmt::print("\n|--|--|--|--|--|--|--|--|--|--|--|\n");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Case& c = all[i];
    fmt::print("| {} | {:.0f} | {} | {} |", c.laden() ? "laden" : "empty", c.speed_kmh,
               c.poor_track ? "poor" : "good", c.section);
    for (std::size_t m = 0; m < kNames.size(); ++m)
      fmt::print(" {} |", cell(found[i], static_cast<Method>(m)));
    fmt::print("\n");
  }
}

/// Mean over the cases of a load, its deviation off the truth, and the worst of single trucks.
void print_load(const std::vector<Case>& all, const std::vector<Trucks>& found, Method method,
                bool laden) {
  Spread level;
  double worst = 0.0;
  double worst_stiffness = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    for (const Found& truck : found[i]) {
      if (all[i].laden() != laden || !truck[method].has_number) continue;
      const auto keep = [](double& most, double error) {
        if (std::abs(error) > std::abs(most)) most = error;
      };
      level.add(truck[method].force_n.value);
      keep(worst, truck[method].force_n.value / truth_n(laden) - 1.0);
      keep(worst_stiffness, truck[method].stiffness_npm.value / truth_npm(laden) - 1.0);
    }
  }
  fmt::print(" {:.0f} +- {:.0f} | {:+.1f} % | {:+.1f} % |", level.mean(), level.std(),
             100.0 * (level.mean() / truth_n(laden) - 1.0), 100.0 * worst);
  if (method < kKnownInput) {
    fmt::print(" {:+.1f} % |", 100.0 * worst_stiffness);
  } else {
    fmt::print(" known |");
  }
}

void print_means(const std::vector<Case>& all, const std::vector<Trucks>& found) {
  fmt::print(
      "\nMean level per load in N with the standard deviation of one truck's, off the truth in the "
      "mean and at worst, and the stiffness at worst:\n\n"
      "| method | laden | mean | worst | k, worst | empty | mean | worst | k, worst |\n"
      "|--|--|--|--|--|--|--|--|--|\n");
  for (std::size_t m = 0; m < kNames.size(); ++m) {
    fmt::print("| {} |", kNames[m]);
    for (const bool laden : {true, false}) print_load(all, found, static_cast<Method>(m), laden);
    fmt::print("\n");
  }
  fmt::print("| simulated | {:.0f} | | | | {:.0f} | | | |\n", truth_n(true), truth_n(false));
  fmt::print(
      "| published F1, F2: half their sum | 7562, 9150: 8356 | | | | 3154, 2720: 2937 | | | |\n");
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 100.0;
  const auto section = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  fmt::print(
      "Level of dry friction Fc = (F1 + F2) / 2 in N, mean of both trucks, {:.0f} s a case; in "
      "parentheses in how many of the two the own verdict, of `explain` or of a Fokker-Planck "
      "form, "
      "is that it can be trusted:\n\n",
      seconds);
  const std::vector<Case> all = cases(section);
  const std::vector<Trucks> found = find_all(all, seconds);
  print_cases(all, found);
  print_means(all, found);
  print_coverage(all, found);
  return EXIT_SUCCESS;
}
