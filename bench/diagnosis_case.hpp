// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/explain/explain_truck.hpp"
#include "app/explain/truck_pass.hpp"
#include "bench/true_model.hpp"
#include "dampline/effect/explainer.hpp"
#include "drivers/candump/line_writer.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/nodes.hpp"
#include "sim_hw/presets.hpp"
#include "sim_hw/random.hpp"
#include "sim_hw/transport.hpp"

namespace dampline::bench {

/// The three conditions of the diagnosis tables.
struct Condition {
  const char* name;
  sim::Load load;
  double speed_kmh;
};
inline constexpr Condition kConditions[]{{"laden 80", sim::Load::kLaden, 80.0},
                                         {"laden 60", sim::Load::kLaden, 60.0},
                                         {"empty 80", sim::Load::kEmpty, 80.0}};

/// An effect as it is planted: its name, what to simulate, and the parameter that tells its size,
/// with the true value (no name: none is compared).
struct Planted {
  std::string effect;
  std::string text;
  std::string parameter;
  double truth{0.0};
};

/// The kinds that are planted; "mode" and "pitch" are both an unmodelled mode.
inline const std::vector<std::string>& planted_kinds() {
  static const std::vector<std::string> kinds{"viscous",
                                              "asymmetric_viscous",
                                              "quadratic_damping",
                                              "progressive_friction",
                                              "stribeck",
                                              "presliding_hysteresis",
                                              "backlash",
                                              "bump_stop",
                                              "cubic_stiffness",
                                              "quadratic_stiffness",
                                              "asymmetric_stiffness",
                                              "pitch",
                                              "mode",
                                              "time_skew",
                                              "gain_error",
                                              "impulsive_input"};
  return kinds;
}

/// Plants one kind at a strength, 1 being nominal; channels, signs and frequencies by chance.
inline Planted plant(const std::string& kind, double strength, sim::Random& random) {
  const auto sign = [&] { return random.uniform() < 0.5 ? -1.0 : 1.0; };
  const char* const channels[]{"frame", "wheelset1", "wheelset2"};
  const char* const channel = channels[static_cast<std::size_t>(3.0 * random.uniform())];
  if (kind == "pitch") {
    return {"unmodelled_mode", fmt::format("unmodelled_mode:strength={}", strength), "", 0.0};
  }
  if (kind == "mode") {
    const double hz = 6.0 + 10.0 * random.uniform();
    return {"unmodelled_mode",
            fmt::format("unmodelled_mode:pitch_inertia_kgm2=0,flexible_share={},"
                        "flexible_frequency_hz={}",
                        0.3 * strength, hz),
            "unmodelled_mode_frequency", hz};
  }
  if (kind == "time_skew") {
    const double s = 0.002 * strength * sign();
    return {
        kind,
        fmt::format("time_skew:{}{}_s={}", channel == channels[0] ? "" : "frame_s=0,", channel, s),
        fmt::format("time_skew_{}", channel), s};
  }
  if (kind == "gain_error") {
    const double g = 0.05 * strength * sign();
    return {
        kind,
        fmt::format("gain_error:{}{}={}", channel == channels[1] ? "" : "wheelset1=0,", channel, g),
        fmt::format("gain_error_{}", channel), g};
  }
  return {kind, fmt::format("{}:strength={}", kind, strength), "", 0.0};
}

/// Of the effects without chance: what was planted, from the simulation's own settings.
inline void tell_truth(const sim::SimulationConfig& c, Planted& planted) {
  const auto& t = c.truck;
  const std::string& e = planted.effect;
  const auto set = [&](const char* name, double value) {
    planted.parameter = name;
    planted.truth = value;
  };
  if (e == "viscous") set("viscous", t.damping.viscous_positive_nspm);
  if (e == "asymmetric_viscous") set("viscous_positive", t.damping.viscous_positive_nspm);
  if (e == "quadratic_damping") set("quadratic_damping", t.damping.quadratic_ns2pm2);
  if (e == "progressive_friction")
    set("progressive_friction_length", t.damping.progressive_length_m);
  if (e == "stribeck") set("stribeck_share", t.damping.stribeck_share);
  if (e == "presliding_hysteresis")
    set("presliding_hysteresis_distance", t.hysteresis.presliding_distance_m);
  if (e == "backlash") set("backlash_gap", t.hysteresis.backlash_gap_m);
  if (e == "bump_stop") set("bump_stop_gap", t.stiffness.bump_gap_m);
  if (e == "cubic_stiffness") set("cubic_stiffness", t.stiffness.cubic_npm3);
  if (e == "quadratic_stiffness") set("quadratic_stiffness", t.stiffness.quadratic_npm2);
  if (e == "asymmetric_stiffness")
    set("asymmetric_stiffness_difference", t.stiffness.asymmetry_npm);
}

/// A record of a condition with effects planted, explained.
struct DiagnosedRecord {
  effect::Explanation explanation;
  bool withheld{false};
  bool drifts{false};
  std::string faults;
  std::vector<Planted> planted;
  double coulomb_n{0.0};
  double stiffness_npm{0.0};
  double true_nmse{0.0};  ///< held out, by the true model; 0: none was fitted
  [[nodiscard]] bool names(std::size_t step, const std::string& effect) const {
    return step < explanation.step_count &&
           effect::name_of(explanation.step[step].chosen.effect) == effect;
  }
};

/// The frames of a simulated run as candump text.
inline void write_record(const sim::SimulationConfig& config, double length_s,
                         const std::string& path) {
  sim::Simulation simulation{config};
  sim::SensorNodes nodes{{}, config.seed};
  sim::Transport transport{{}, config.seed};
  fmt::memory_buffer text;
  const auto samples = static_cast<std::int64_t>(length_s * sim::kSampleRateHz);
  for (std::int64_t n = 0; n < samples; ++n) {
    const sim::SimulatedSample sample = simulation.next();
    for (const CanFrame& frame : transport.pass(nodes.pack(sample), sample.time_s))
      drivers::append_candump(text, frame, "can0");
  }
  std::ofstream{path}.write(text.data(), static_cast<std::streamsize>(text.size()));
}

/// The size of the deflection that puts a true length on a point of its grid, near to `scale_m`.
template <std::size_t N>
double scale_with(const std::array<double, N>& grid, double truth_m, double scale_m) {
  double best_m = truth_m / grid[0];
  for (const double g : grid) {
    if (std::abs(std::log(truth_m / g / scale_m)) < std::abs(std::log(best_m / scale_m)))
      best_m = truth_m / g;
  }
  return best_m;
}

/// The scale with which the candidates of a planted effect hold the true one; 0: they have no
/// lengths.
inline double true_scale_m(const Planted& planted, double scale_m) {
  if (planted.parameter == "bump_stop_gap")
    return scale_with(effect::kBumpGap, planted.truth, scale_m);
  if (planted.parameter == "presliding_hysteresis_distance")
    return scale_with(effect::kDahlDistance, planted.truth, scale_m);
  if (planted.parameter == "backlash_gap")
    return scale_with(effect::kBacklashGap, planted.truth, scale_m);
  return 0.0;
}

/// The law of a kind whose grid does not hold the true one, and whether there is one.
inline std::optional<TrueLaw> true_law(const sim::SimulationConfig& config,
                                       const Planted& planted) {
  if (planted.effect == "stribeck")
    return TrueLaw{config.truck.damping.stribeck_speed_mps, 0.0, 0.0};
  if (planted.parameter == "unmodelled_mode_frequency")
    return TrueLaw{0.0, planted.truth, config.truck.modes.flexible_damping_ratio};
  return std::nullopt;
}

/// What the true model leaves of a record: the base and the planted effect alone, with its true
/// length, speed or frequency in the place of the grid. Pitch of the frame stands on its grid.
inline double true_nmse_of(const app::Config& settings, const sim::SimulationConfig& config,
                           const std::string& path, const Planted& planted) {
  const auto law = true_law(config, planted);
  const auto sums = law ? std::make_unique<TrueSums>(sim::kSampleRateHz, *law) : nullptr;
  app::TruckPass pass = app::pass_of(settings, {path, false}, {});
  const double scale_m = true_scale_m(planted, pass.diagnosis->scale_m());
  app::TruckPassOptions options{scale_m, false, {}};
  if (sums)
    options.watch = [&](const Sample&, const UpdateResult& result,
                        const effect::Diagnosis& diagnosis) { sums->take(result, diagnosis); };
  if (sums || scale_m > 0.0) pass = app::pass_of(settings, {path, false}, options);
  effect::ExplainerConfig wanted;
  wanted.moving_mass_kg = settings.car.moving_mass_kg;
  for (std::size_t i = 0; i < effect::kEffects; ++i)
    wanted.allowed[i] = planted.effect == effect::name_of(static_cast<effect::Effect>(i));
  const auto explainer = std::make_unique<effect::Explainer>();
  const effect::GramStore& store = sums ? sums->finish() : pass.diagnosis->store();
  return explainer->explain(store, pass.diagnosis->impulses(), pass.diagnosis->scale_m(), wanted)
      .final.held_out_nmse;
}

/// What the base leaves of the same record as sound sensors would have seen it.
inline double sound_nmse_of(const app::Config& settings, sim::SimulationConfig config,
                            const std::string& path) {
  config.sensors.time_skew_s = {};
  config.sensors.gain_error = {};
  write_record(config, 300.0, path);
  const app::TruckPass pass = app::pass_of(settings, {path, false}, {});
  effect::ExplainerConfig nothing;
  nothing.moving_mass_kg = settings.car.moving_mass_kg;
  nothing.allowed.fill(false);
  const auto explainer = std::make_unique<effect::Explainer>();
  return explainer->explain(*pass.diagnosis, nothing).final.held_out_nmse;
}

/// 0: impacts have no column, and of two effects none is looked at.
inline double true_nmse(const app::Config& settings, const sim::SimulationConfig& config,
                        const std::string& path, const std::vector<Planted>& planted) {
  if (planted.size() != 1 || planted[0].effect == "impulsive_input") return 0.0;
  const bool sensor = planted[0].effect == "time_skew" || planted[0].effect == "gain_error";
  return sensor ? sound_nmse_of(settings, config, path)
                : true_nmse_of(settings, config, path, planted[0]);
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
  write_record(config, 300.0, path);
  app::Config settings;
  settings.car.moving_mass_kg = config.truck.moving_mass_kg;
  const app::Explained found = app::explain_truck(settings, {{path, false}, {}, false});
  DiagnosedRecord out;
  out.true_nmse = true_nmse(settings, config, path, planted);
  std::filesystem::remove(path);
  out.explanation = found.explanation;
  out.withheld = found.withheld;
  out.drifts = found.drifts;
  for (const app::FaultFinding& f : found.identified.faults.list)
    out.faults += fmt::format(" {} {} at {:.0f} s", f.name, f.channel, f.time_s);
  out.planted = std::move(planted);
  out.coulomb_n = 0.5 * (config.truck.friction_positive_n + config.truck.friction_negative_n);
  // The estimate's k is the mean of both sides.
  out.stiffness_npm = config.truck.stiffness_npm + 0.5 * config.truck.stiffness.asymmetry_npm;
  return out;
}

}  // namespace dampline::bench
