// SPDX-License-Identifier: MIT
// Whether the deviations that `explain` states hold: effects planted by two simulations that share
// no code, each parameter of the final law against its truth.
// `coverage [N [FIRST_SEED [LENGTH_S [KIND]]]]`: N records per kind and condition, of sizes between
// 0.6 and 1.2 of nominal; "clean" is a kind, too.
#include "tests/explain/coverage.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "app/diagnosis/truck/explain.hpp"
#include "bench/planted.hpp"
#include "tests/explain/other_truck.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;
namespace other = dampline::test;
using dampline::test::Coverage;
using dampline::test::Truths;

/// Of what a simulation was set to. The mean of the deflection, which no accelerometer shows, is
/// where it is counted from; of friction that differs by direction only the mean shows, and what
/// grows with the deflection of the difference is stiffness.
Truths truths_of(const sim::TruckConfig& t, const Planted& planted, double mean_m) {
  const double level_n = 0.5 * (t.friction_positive_n + t.friction_negative_n);
  const double uneven_n = 0.5 * (t.friction_positive_n - t.friction_negative_n);
  const auto& spring = t.stiffness;
  const auto& d = t.damping;
  const double length_m = d.progressive_length_m;
  const double raised = length_m > 0.0 ? 1.0 + mean_m / length_m : 1.0;
  Truths out{
      {"coulomb", raised * level_n},
      {"stiffness", t.stiffness_npm + 0.5 * spring.asymmetry_npm +
                        mean_m * (2.0 * spring.quadratic_npm2 + 3.0 * spring.cubic_npm3 * mean_m) +
                        (length_m > 0.0 ? uneven_n / length_m : 0.0)}};
  const std::string& e = planted.effect;
  if (e == "viscous") out.emplace_back("viscous", d.viscous_positive_nspm);
  if (e == "asymmetric_viscous") {
    out.emplace_back("viscous_positive", d.viscous_positive_nspm);
    out.emplace_back("viscous_negative", d.viscous_negative_nspm);
  }
  if (e == "quadratic_damping") out.emplace_back("quadratic_damping", d.quadratic_ns2pm2);
  if (e == "progressive_friction")
    out.emplace_back("progressive_friction_length", length_m + mean_m);
  if (e == "stribeck") {
    out.emplace_back("stribeck_share", d.stribeck_share);
    out.emplace_back("stribeck_speed", d.stribeck_speed_mps);
  }
  if (e == "presliding_hysteresis") {
    out.emplace_back("presliding_hysteresis_force", level_n);
    out.emplace_back("presliding_hysteresis_distance", t.hysteresis.presliding_distance_m);
  }
  if (e == "viscoelastic") {
    out.emplace_back("viscoelastic_stiffness", t.hysteresis.viscoelastic_npm);
    out.emplace_back("viscoelastic_time", t.hysteresis.viscoelastic_s);
  }
  if (e == "backlash") {
    out.emplace_back("backlash_force", level_n);
    // To where half the force is there.
    out.emplace_back("backlash_gap",
                     (1.0 - 0.5 * sim::kBacklashRamp) * t.hysteresis.backlash_gap_m);
  }
  if (e == "bump_stop") {
    out.emplace_back("bump_stop_stiffness", spring.bump_stiffness_npm);
    out.emplace_back("bump_stop_gap", spring.bump_gap_m);
  }
  if (e == "cubic_stiffness") out.emplace_back("cubic_stiffness", spring.cubic_npm3);
  if (e == "quadratic_stiffness") out.emplace_back("quadratic_stiffness", spring.quadratic_npm2);
  if (e == "asymmetric_stiffness")
    out.emplace_back("asymmetric_stiffness_difference", spring.asymmetry_npm);
  if (t.modes.flexible_share > 0.0)
    out.emplace_back("unmodelled_mode_mass", t.modes.flexible_share * t.moving_mass_kg);
  if (t.modes.pitch_inertia_kgm2 > 0.0)
    out.emplace_back("unmodelled_mode_frequency",
                     t.modes.pitch_half_wheelbase_m *
                         std::sqrt(2.0 * t.stiffness_npm / t.modes.pitch_inertia_kgm2) /
                         (2.0 * M_PI));
  const bool own = e == "time_skew" || e == "gain_error" || t.modes.flexible_share > 0.0;
  if (own) out.emplace_back(planted.parameter, planted.truth);
  return out;
}

/// The other simulation's laws, at a size of about 1.
struct OtherKind {
  std::string name;
  std::function<other::Plant(double)> plant;
  /// Beside friction and spring, or in their place.
  std::function<Truths(double, double)> truths;  // of size and mean deflection
};
std::vector<OtherKind> other_kinds() {
  using other::force;
  using other::kCoulombN;
  using other::level;
  using other::State;
  constexpr double kC = 100e3;
  const auto cubic = [](double s) { return 4.4e11 * s; };
  return {
      {"clean", [](double) { return other::Plant{}; }, [](double, double) { return Truths{}; }},
      {"viscous",
       [](double s) { return force([s](const State& x) { return s * kC * x.velocity_mps; }); },
       [](double s, double) {
         return Truths{{"viscous", s * kC}};
       }},
      {"asymmetric_viscous",
       [](double s) {
         return force([s](const State& x) {
           return s * (x.velocity_mps > 0.0 ? 190e3 : 30e3) * x.velocity_mps;
         });
       },
       [](double s, double) {
         return Truths{{"viscous_positive", s * 190e3}, {"viscous_negative", s * 30e3}};
       }},
      {"quadratic_damping",
       [](double s) {
         return force(
             [s](const State& x) { return s * 5.1e6 * x.velocity_mps * std::abs(x.velocity_mps); });
       },
       [](double s, double) {
         return Truths{{"quadratic_damping", s * 5.1e6}};
       }},
      {"stribeck",
       [](double s) {
         return level([s](const State& x) {
           return kCoulombN * (1.0 + 0.45 * s * std::exp(-std::abs(x.velocity_mps) / 0.011));
         });
       },
       [](double s, double) {
         return Truths{{"stribeck_share", 0.45 * s}, {"stribeck_speed", 0.011}};
       }},
      {"progressive_friction",
       [](double s) {
         return level([s](const State& x) {
           return kCoulombN * std::max(1.0 + s * x.deflection_m / 0.0047, 0.0);
         });
       },
       [](double s, double m) {
         return Truths{{"coulomb", kCoulombN * (1.0 + s * m / 0.0047)},
                       {"progressive_friction_length", 0.0047 / s + m}};
       }},
      {"presliding_hysteresis", [](double s) { return other::presliding(1.5e-4 * s, 1.0); },
       [](double s, double) {
         return Truths{{"presliding_hysteresis_force", kCoulombN},
                       {"presliding_hysteresis_distance", 1.5e-4 * s}};
       }},
      {"viscoelastic", [](double s) { return other::viscoelastic(2.7e6 * s, 0.034); },
       [](double s, double) {
         return Truths{{"viscoelastic_stiffness", 2.7e6 * s}, {"viscoelastic_time", 0.034}};
       }},
      {"backlash", [](double s) { return other::backlash(3.3e-4 * s); },
       [](double s, double) {
         return Truths{{"backlash_force", kCoulombN},
                       {"backlash_gap", 3.3e-4 * s + 0.5 * other::kStretchM}};
       }},
      {"bump_stop",
       [](double s) {
         return force([s](const State& x) {
           const double over = std::max(std::abs(x.deflection_m) - 0.00137, 0.0);
           return s * 14e6 * over * other::sign(x.deflection_m);
         });
       },
       [](double s, double) {
         return Truths{{"bump_stop_stiffness", s * 14e6}, {"bump_stop_gap", 0.00137}};
       }},
      {"cubic_stiffness",
       [cubic](double s) {
         return force([k = cubic(s)](const State& x) { return k * std::pow(x.deflection_m, 3); });
       },
       [cubic](double s, double m) {
         return Truths{{"stiffness", other::kSpringNpm + 3.0 * cubic(s) * m * m},
                       {"cubic_stiffness", cubic(s)}};
       }},
      {"quadratic_stiffness",
       [](double s) {
         return force([s](const State& x) { return s * 6e8 * x.deflection_m * x.deflection_m; });
       },
       [](double s, double m) {
         return Truths{{"stiffness", other::kSpringNpm + 2.0 * s * 6e8 * m},
                       {"quadratic_stiffness", s * 6e8}};
       }},
      {"asymmetric_stiffness",
       [](double s) {
         return force([s](const State& x) { return s * 0.7e6 * std::abs(x.deflection_m); });
       },
       [](double s, double) {
         return Truths{{"asymmetric_stiffness_difference", s * 1.4e6}};
       }},
      {"mode", [](double s) { return other::mode(0.21 * s, 9.0 + 2.0 * s); },
       [](double s, double) {
         return Truths{{"unmodelled_mode_frequency", 9.0 + 2.0 * s},
                       {"unmodelled_mode_mass", 0.21 * s * other::kMassKg}};
       }},
      {"time_skew",
       [](double s) {
         other::Plant out;
         out.frame_late = static_cast<std::size_t>(std::lround(29.0 * s));
         return out;
       },
       // What takes the new velocity for its step is half a step ahead.
       [](double s, double) {
         return Truths{{"time_skew_frame", (std::round(29.0 * s) - 0.5) * other::kStepS}};
       }},
      {"gain_error",
       [](double s) {
         other::Plant out;
         out.gain[2] = 1.0 - 0.043 * s;
         return out;
       },
       [](double s, double) {
         return Truths{{"gain_error_wheelset2", -0.043 * s}};
       }}};
}

const char* effect_of(const std::string& kind) {
  if (kind == "pitch" || kind == "mode") return "unmodelled_mode";
  return kind.c_str();
}

class Table {
 public:
  explicit Table(double length_s) : length_s_{length_s} {}

  void sim(const Condition& condition, const std::string& kind, std::uint64_t seed) {
    sim::SimulationConfig config = sim::reference_run(condition.load, condition.speed_kmh, seed);
    sim::Random random{seed, sim::Stream::kShocks};
    const double size = 0.6 + 0.6 * random.uniform();
    Planted planted{"clean", "", "", 0.0};
    if (kind != "clean") {
      planted = plant(kind, size, random);
      if (const auto wrong = sim::add_effect_text(config, planted.text))
        throw std::runtime_error{*wrong};
    }
    const std::string path = path_of(".log");
    const Deflection moved = write_record(config, length_s_, path);
    take({kind, condition.name}, path, config.truck.moving_mass_kg,
         truths_of(config.truck, planted, moved.mean_m));
  }
  void other_truck(const OtherKind& kind, std::uint64_t seed) {
    sim::Random random{seed, sim::Stream::kShocks};
    const double size = 0.6 + 0.6 * random.uniform();
    const other::Plant plant = kind.plant(size);
    const std::string path = path_of(".csv");
    double mean_m = 0.0;
    std::ofstream{path} << other::record_of(plant, seed, length_s_, seed, &mean_m);
    Truths truths{{"coulomb", other::kCoulombN}, {"stiffness", other::kSpringNpm}};
    for (const auto& [name, value] : kind.truths(size, mean_m)) {
      bool known = false;
      for (auto& truth : truths) {
        if (truth.first != name) continue;
        truth.second = value;
        known = true;
      }
      if (!known) truths.emplace_back(name, value);
    }
    take({kind.name, "other truck"}, path, plant.moving_mass_kg, truths);
  }

  void print() const {
    fmt::print(
        "| planted | condition | found | parameter | within 2 | mean z | rms z | mean error |\n"
        "|--|--|--|--|--|--|--|--|\n");
    Coverage all;
    for (const auto& [key, row] : rows_) {
      const auto& [kind, condition] = key;
      for (const auto& [name, c] : row.of) {
        fmt::print("| {} | {} | {} of {} | {} | {} of {} | {:+.2f} | {:.2f} | {:+.2f} % |\n", kind,
                   condition, row.found, row.records, name, c.within, c.records, c.mean(), c.rms(),
                   100.0 * c.mean_error());
        all.records += c.records;
        all.within += c.within;
        all.squares += c.squares;
      }
      for (const auto& [names, count] : row.instead)
        fmt::print("| {} | {} | {} of {}: {} | | | | | |\n", kind, condition, count, row.records,
                   names);
    }
    if (all.records > 0)
      fmt::print("\nAll: {} of {} ({:.1f} %) within two deviations, rms z {:.2f}.\n", all.within,
                 all.records, 100.0 * all.within_share(), all.rms());
  }

 private:
  using Key = std::pair<std::string, std::string>;
  struct Row {
    int records{0};
    int found{0};
    std::map<std::string, int> instead;
    std::map<std::string, Coverage> of;
  };

  static std::string path_of(const char* suffix) {
    return (std::filesystem::temp_directory_path() /
            fmt::format("coverage_{}{}", ::getpid(), suffix))
        .string();
  }
  /// Parameters count where the planted effect was found and nothing else.
  void take(const Key& key, const std::string& path, double mass_kg, const Truths& truths) {
    app::Config settings;
    settings.car.moving_mass_kg = mass_kg;
    const app::Explained found = app::explain_truck(settings, {{path, false}, {}, false});
    std::filesystem::remove(path);
    const effect::Explanation& e = found.explanation;
    Row& row = rows_[key];
    ++row.records;
    const bool clean = key.first == "clean";
    const bool named = clean ? e.conclusion == effect::Conclusion::kComplete
                             : e.step_count == 1 && std::string{effect_of(key.first)} ==
                                                        effect::name_of(e.step[0].chosen.effect);
    if (!named || found.other) {  // no truck here is beside another one
      std::string names{found.other ? "other_truck" : ""};
      for (std::size_t i = 0; i < e.step_count; ++i)
        names += fmt::format("{}{}", names.empty() ? "" : " + ",
                             effect::name_of(e.step[i].chosen.effect));
      ++row.instead[names.empty() ? effect::name_of(e.conclusion) : names];
      return;
    }
    ++row.found;
    dampline::test::compare(e, truths,
                            [&](const std::string& name, const Estimate& estimate, double truth) {
                              row.of[name].add(estimate, truth);
                            });
    if (!clean) return;
    for (const app::Parameter& p : found.identified.parameters)
      for (const auto& [name, truth] : truths)
        if (p.name == name) row.of["identify: " + name].add({p.value, p.std}, truth);
  }

  double length_s_;
  std::map<Key, Row> rows_;
};

}  // namespace

int main(int argc, char** argv) {
  const int n = argc > 1 ? std::atoi(argv[1]) : 10;
  std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 61001;
  const double length_s = argc > 3 ? std::atof(argv[3]) : 120.0;
  const std::string only = argc > 4 ? argv[4] : "";
  Table table{length_s};
  std::vector<std::string> kinds = planted_kinds();
  kinds.insert(kinds.begin(), "clean");
  for (int i = 0; i < n; ++i) {
    for (const std::string& kind : kinds) {
      ++seed;
      if (kind == "impulsive_input" || (!only.empty() && only != kind)) continue;
      for (const Condition& condition : kConditions) table.sim(condition, kind, seed);
    }
    for (const OtherKind& kind : other_kinds()) {
      ++seed;
      if (only.empty() || only == kind.name) table.other_truck(kind, seed);
    }
  }
  table.print();
  return EXIT_SUCCESS;
}
