// SPDX-License-Identifier: MIT
// The diagnosis on simulated trucks: effects of random kind and strength, three conditions, 300 s
// each, through `explain` as a file goes through it, as a confusion matrix and as rates.
// `diagnosis [PER_CELL [FIRST_SEED [STRENGTH [NOISE [KIND]]]]]`: records per kind and condition; a
// strength of 0 draws it from 0.3 to 1.2 of nominal, 0 per cell is clean records only; the sensors'
// noise in units of its nominal value; one kind alone, with the seeds that it has among all.
// `diagnosis pairs [FIRST_SEED [STRENGTH]]`: every pair of ten kinds, laden at 80 km/h, once.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/pass.hpp"
#include "bench/planted.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::bench {

/// A record of a condition with effects planted, explained.
struct DiagnosedRecord {
  effect::Explanation explanation;
  bool withheld{false};
  bool drifts{false};
  bool has_other_truck{false};  ///< no record here is of a truck beside another one
  bool is_untouched{false};     ///< a stop that the motion never reaches
  std::string faults;
  std::vector<Planted> planted;
  double coulomb_n{0.0};
  double stiffness_npm{0.0};
  std::optional<effect::Explanation> by_true_model;
  [[nodiscard]] bool names(std::size_t step, const std::string& effect) const {
    return !has_other_truck && step < explanation.step_count &&
           effect::name_of(explanation.step[step].chosen.effect) == effect;
  }
  /// Effects that are said to be in it.
  [[nodiscard]] std::size_t steps() const {
    return explanation.step_count + (has_other_truck ? 1 : 0);
  }
  /// The first of them, or "none".
  [[nodiscard]] std::string first_name() const {
    if (has_other_truck) return "other_truck";
    return explanation.step_count == 0 ? "none"
                                       : effect::name_of(explanation.step[0].chosen.effect);
  }
};

/// Grids whose points are all the true one of a planted effect.
inline effect::Grids true_grids(const sim::SimulationConfig& config, const Planted& planted,
                                double scale_m) {
  const sim::TruckConfig& t = config.truck;
  effect::Grids out;
  out.scale_m = scale_m;
  out.fine.fill(true);
  for (std::size_t i = 0; i < effect::kStribeckSpeeds; ++i)
    out.stribeck_mps[i] = t.damping.stribeck_speed_mps * std::exp2(static_cast<double>(i) - 1.0);
  if (planted.parameter == "bump_stop_gap") out.bump_gap.fill(planted.truth / scale_m);
  if (planted.parameter == "presliding_hysteresis_distance")
    out.dahl_distance.fill(planted.truth / scale_m);
  if (planted.parameter == "backlash_gap")
    out.play.fill({planted.truth / scale_m, effect::kInnerWidthMps});
  const auto& modes = t.modes;
  if (modes.pitch_inertia_kgm2 > 0.0) {
    const double arm_m = modes.pitch_half_wheelbase_m;
    const double hz =
        arm_m * std::sqrt(2.0 * t.stiffness_npm / modes.pitch_inertia_kgm2) / (2.0 * M_PI);
    const double friction_n = 0.5 * (t.friction_positive_n + t.friction_negative_n);
    out.pitch.fill({hz, 0.5 * friction_n / t.stiffness_npm});
  }
  out.flexible.fill({modes.flexible_frequency_hz, modes.flexible_damping_ratio});
  return out;
}

/// The true model of a record: the base and the planted effect alone, with its true length, speed
/// or frequency.
inline effect::Explanation true_fit_of(const app::Config& settings,
                                       const sim::SimulationConfig& config, const std::string& path,
                                       const Planted& planted) {
  const double scale_m = app::pass_of(settings, {path, false}, {}).diagnosis().scale_m();
  const app::TruckPass pass =
      app::pass_of(settings, {path, false}, {true_grids(config, planted, scale_m), {}, false, {}});
  effect::ExplainerConfig wanted;
  wanted.moving_mass_kg = settings.car.moving_mass_kg;
  for (std::size_t i = 0; i < effect::kEffects; ++i)
    wanted.allowed[i] = planted.effect == effect::name_of(static_cast<effect::Effect>(i));
  return std::make_unique<effect::Explainer>()->explain(pass.diagnosis(), wanted);
}

/// The base of the same record as sound sensors would have seen it.
inline effect::Explanation sound_fit_of(const app::Config& settings, sim::SimulationConfig config,
                                        const std::string& path) {
  config.sensors.time_skew_s = {};
  config.sensors.gain_error = {};
  static_cast<void>(write_record(config, 300.0, path));
  const app::TruckPass pass = app::pass_of(settings, {path, false}, {});
  effect::ExplainerConfig nothing;
  nothing.moving_mass_kg = settings.car.moving_mass_kg;
  nothing.allowed.fill(false);
  return std::make_unique<effect::Explainer>()->explain(pass.diagnosis(), nothing);
}

/// None: impacts have no column, and of two effects none is looked at.
inline std::optional<effect::Explanation> true_fit(const app::Config& settings,
                                                   const sim::SimulationConfig& config,
                                                   const std::string& path,
                                                   const std::vector<Planted>& planted) {
  if (planted.size() != 1 || planted[0].effect == "impulsive_input") return std::nullopt;
  const bool sensor = planted[0].effect == "time_skew" || planted[0].effect == "gain_error";
  return sensor ? sound_fit_of(settings, config, path)
                : true_fit_of(settings, config, path, planted[0]);
}

/// As `dampline explain` does it: guards, floor and all.
inline DiagnosedRecord diagnose(const Condition& condition, std::vector<Planted> planted,
                                std::uint64_t seed, double noise = 1.0) {
  sim::SimulationConfig config = sim::reference_run(condition.load, condition.speed_kmh, seed);
  config.sensors.noise_mps2 *= noise;
  for (const Planted& p : planted) {
    if (const auto wrong = sim::add_effect_text(config, p.text)) throw std::runtime_error{*wrong};
  }
  for (Planted& p : planted) tell_truth(config, p);
  const std::string path =
      (std::filesystem::temp_directory_path() / fmt::format("diagnosis_{}.log", ::getpid()))
          .string();
  const double largest_m = write_record(config, 300.0, path).largest_m;
  app::Config settings;
  settings.car.moving_mass_kg = config.truck.moving_mass_kg;
  const app::Explained found = app::explain_truck(settings, {{path, false}, {}, false});
  DiagnosedRecord out;
  const auto is_out_of_reach = [&](const Planted& p) {
    return p.parameter == "bump_stop_gap" && largest_m < p.truth;
  };
  out.is_untouched = std::any_of(planted.begin(), planted.end(), is_out_of_reach);
  out.by_true_model = true_fit(settings, config, path, planted);
  std::filesystem::remove(path);
  out.explanation = found.explanation;
  out.withheld = found.withheld;
  out.drifts = found.drifts;
  out.has_other_truck = found.other != nullptr;
  for (const app::FaultFinding& f : found.identified.faults.list)
    out.faults += fmt::format(" {} {} at {:.0f} s", f.name, f.channel, f.time_s);
  out.planted = std::move(planted);
  out.coulomb_n = 0.5 * (config.truck.friction_positive_n + config.truck.friction_negative_n);
  // The estimate's k is the mean of both sides.
  out.stiffness_npm = config.truck.stiffness_npm + 0.5 * config.truck.stiffness.asymmetry_npm;
  return out;
}

}  // namespace dampline::bench

namespace {

using namespace dampline;
using namespace dampline::bench;

struct Share {
  int good{0};
  int all{0};
  void add(bool is_good) {
    good += is_good ? 1 : 0;
    ++all;
  }
  [[nodiscard]] std::string text() const {
    return all == 0 ? "-" : fmt::format("{} of {} ({:.1f} %)", good, all, 100.0 * good / all);
  }
};

std::string median_and_range(std::vector<double> values) {
  if (values.empty()) return "-";
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return fmt::format("{:.3f} ({:.3f} to {:.3f})", at(0.5), values.front(), values.back());
}

struct Tally {
  double floor_within{0.1};
  std::map<std::string, std::map<std::string, int>> confusion;
  Share right, wrong, alarm, magnitude, repaired, repaired_by_truth, extra, withheld, complete,
      floor, as_true;
  std::vector<double> floors, ratios;  // over what is left: of clean records, of right ones
  std::vector<double> over_true;       // left over what the true model leaves
  std::map<std::string, std::vector<double>> over_true_of;
  std::string misses;

  void add(const std::string& kind, const Condition& condition, const DiagnosedRecord& record) {
    const effect::Explanation& e = record.explanation;
    const std::string verdict = record.first_name();
    ++confusion[kind][verdict];
    if (record.planted.empty()) {
      alarm.add(record.steps() > 0);
      floors.push_back(e.floor_nmse / e.base.held_out_nmse);
      floor.add(std::abs(floors.back() - 1.0) <= floor_within);
      return;
    }
    const bool named = record.names(0, record.planted[0].effect);
    if (!named) {
      const std::string why = record.withheld       ? " (withheld:" + record.faults + ")"
                              : record.drifts       ? " (drift)"
                              : record.is_untouched ? " (never touched)"
                                                    : "";
      const effect::Step& best = e.step_count == 0 ? e.rejected : e.step[0];
      misses += fmt::format("| {} | {} | {}{} | {} {:.2f} % t {:.1f} |\n", condition.name,
                            record.planted[0].text, verdict, why,
                            effect::name_of(best.chosen.effect), 100.0 * best.gain, best.block_t);
    }
    right.add(named);
    withheld.add(record.withheld || record.drifts);
    if (named) {
      ratios.push_back(effect::floor_ratio(e));
      complete.add(ratios.back() <= effect::kIncompleteAbove);
    }
    wrong.add(record.steps() > 0 && !named);
    extra.add(record.steps() > 1);
    if (named) add_sizes(condition, record);
    if (named && record.by_true_model) {
      over_true.push_back(e.final.held_out_nmse / record.by_true_model->final.held_out_nmse);
      as_true.add(over_true.back() <= 1.1);
      over_true_of[kind].push_back(over_true.back());
    }
  }

 private:
  void add_sizes(const Condition& condition, const DiagnosedRecord& record) {
    const effect::Explanation& e = record.explanation;
    const Planted& planted = record.planted[0];
    for (std::size_t i = 0; i < e.step[0].parameter_count; ++i) {
      const effect::EffectParameter& p = e.step[0].parameter[i];
      if (planted.parameter == p.name)
        magnitude.add(std::abs(p.estimate.value / planted.truth - 1.0) < 0.2);
    }
    const auto off = [](double value, double truth, double limit) {
      return std::abs(value / truth - 1.0) > limit;
    };
    const bool base_off = off(e.base_coulomb_n.value, record.coulomb_n, 0.05) ||
                          off(e.base_stiffness_npm.value, record.stiffness_npm, 0.05);
    if (!base_off) return;
    const auto is_good = [&](const effect::Explanation& by) {
      return !off(by.final_coulomb_n.value, record.coulomb_n, 0.03) &&
             !off(by.final_stiffness_npm.value, record.stiffness_npm, 0.03);
    };
    const bool good = is_good(e);
    repaired.add(good);
    if (record.by_true_model) repaired_by_truth.add(is_good(*record.by_true_model));
    if (!good)
      misses += fmt::format(
          "| {} | {} | not repaired | Fc {:+.1f} -> {:+.1f} %, k {:+.1f} -> {:+.1f} % |\n",
          condition.name, planted.text, 100.0 * (e.base_coulomb_n.value / record.coulomb_n - 1.0),
          100.0 * (e.final_coulomb_n.value / record.coulomb_n - 1.0),
          100.0 * (e.base_stiffness_npm.value / record.stiffness_npm - 1.0),
          100.0 * (e.final_stiffness_npm.value / record.stiffness_npm - 1.0));
  }
};

void print(const Tally& tally) {
  fmt::print("| planted | named first |\n|--|--|\n");
  for (const auto& [kind, verdicts] : tally.confusion) {
    std::string text;
    for (const auto& [verdict, count] : verdicts)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", verdict, count);
    fmt::print("| {} | {} |\n", kind, text);
  }
  fmt::print("\n| figure | reached | wanted |\n|--|--|--|\n");
  fmt::print("| right name | {} | 94 % (98 % at strength 1) |\n", tally.right.text());
  fmt::print("| wrong name | {} | at most 1 % |\n", tally.wrong.text());
  fmt::print("| false alarms on clean records | {} | at most 2 % |\n", tally.alarm.text());
  fmt::print("| more than one effect where one was planted | {} | |\n", tally.extra.text());
  fmt::print("| size within 20 %, of the right ones | {} | 80 % |\n", tally.magnitude.text());
  fmt::print("| Fc and k within 3 % where the base was off by 5 % | {} | 90 % |\n",
             tally.repaired.text());
  fmt::print("| the same, fitted with the true model | {} | |\n", tally.repaired_by_truth.text());
  fmt::print("| effects withheld: faults, or a drift | {} | |\n", tally.withheld.text());
  fmt::print("| floor over what a clean record leaves: median (range) | {} | |\n",
             median_and_range(tally.floors));
  fmt::print("| the same within {:.0f} % | {} | all |\n", 100.0 * tally.floor_within,
             tally.floor.text());
  fmt::print("| left over floor, of the right ones: median (range) | {} | |\n",
             median_and_range(tally.ratios));
  fmt::print("| the same up to 1.5 | {} | |\n", tally.complete.text());
  fmt::print("| left over what the true model leaves: median (range) | {} | |\n",
             median_and_range(tally.over_true));
  fmt::print("| the same up to 1.1 | {} | all |\n", tally.as_true.text());
  for (const auto& [kind, values] : tally.over_true_of)
    fmt::print("| ... {} | {} | |\n", kind, median_and_range(values));
  fmt::print("\n| condition | planted | named | best candidate |\n|--|--|--|--|\n{}", tally.misses);
}

/// Two effects at once: whether the first name, both, and no more than both are found.
void pairs(std::uint64_t seed, double strength) {
  const std::array<std::string, 10> kinds{"viscous",
                                          "stribeck",
                                          "progressive_friction",
                                          "presliding_hysteresis",
                                          "bump_stop",
                                          "cubic_stiffness",
                                          "time_skew",
                                          "gain_error",
                                          "pitch",
                                          "mode"};
  Share first, both, exact;
  std::string rows;
  for (std::size_t a = 0; a < kinds.size(); ++a) {
    for (std::size_t b = a + 1; b < kinds.size(); ++b) {
      sim::Random random{seed, sim::Stream::kShocks};
      const Planted one = plant(kinds[a], strength, random);
      const Planted two = plant(kinds[b], strength, random);
      const DiagnosedRecord found = diagnose(kConditions[0], {one, two}, seed++);
      const auto has = [&](const std::string& effect) {
        return found.names(0, effect) || found.names(1, effect) || found.names(2, effect);
      };
      const std::size_t steps = found.steps();
      const std::size_t wanted = one.effect == two.effect ? 1 : 2;
      first.add(found.names(0, one.effect) || found.names(0, two.effect));
      both.add(has(one.effect) && has(two.effect));
      exact.add(has(one.effect) && has(two.effect) && steps == wanted);
      std::string names{found.has_other_truck ? " other_truck" : ""};
      for (std::size_t i = 0; i < found.explanation.step_count; ++i)
        names += fmt::format(" {}", effect::name_of(found.explanation.step[i].chosen.effect));
      rows += fmt::format("| {} + {} |{}{} |\n", kinds[a], kinds[b], names,
                          found.withheld ? " (withheld:" + found.faults + ")" : "");
    }
  }
  fmt::print("| planted | named |\n|--|--|\n{}\n", rows);
  fmt::print("| figure | reached | wanted |\n|--|--|--|\n| first right | {} | 95 % |\n",
             first.text());
  fmt::print("| both found | {} | 90 % |\n| exact set | {} | 85 % |\n", both.text(), exact.text());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string{argv[1]} == "pairs") {
    pairs(argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 7001,
          argc > 3 ? std::atof(argv[3]) : 0.7);
    return EXIT_SUCCESS;
  }
  const int per_cell = argc > 1 ? std::max(0, std::atoi(argv[1])) : 4;
  std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 5001;
  const double fixed = argc > 3 ? std::atof(argv[3]) : 0.0;
  const double noise = argc > 4 ? std::atof(argv[4]) : 1.0;
  const std::string only = argc > 5 ? argv[5] : "";
  const int clean = per_cell == 0 ? 4 : 5 * per_cell;
  Tally tally;
  if (noise > 1.0) tally.floor_within = 0.15;
  for (const Condition& condition : kConditions) {
    for (int i = 0; i < clean; ++i, ++seed) {
      if (only.empty()) tally.add("(clean)", condition, diagnose(condition, {}, seed, noise));
    }
    for (const std::string& kind : planted_kinds()) {
      for (int i = 0; i < per_cell; ++i, ++seed) {
        if (!only.empty() && only != kind) continue;
        sim::Random random{seed, sim::Stream::kShocks};
        const double strength = fixed > 0.0 ? fixed : 0.3 + 0.9 * random.uniform();
        tally.add(kind, condition,
                  diagnose(condition, {plant(kind, strength, random)}, seed, noise));
      }
    }
  }
  print(tally);
  return EXIT_SUCCESS;
}
