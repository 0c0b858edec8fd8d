// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
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
#include "dampline/effect/explainer.hpp"
#include "drivers/candump/line.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/nodes.hpp"
#include "sim_hw/noise.hpp"
#include "sim_hw/simulation.hpp"

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
  bool is_untouched{false};  ///< a stop that the motion never reaches
  std::string faults;
  std::vector<Planted> planted;
  double coulomb_n{0.0};
  double stiffness_npm{0.0};
  std::optional<effect::Explanation> by_true_model;
  [[nodiscard]] bool names(std::size_t step, const std::string& effect) const {
    return step < explanation.step_count &&
           effect::name_of(explanation.step[step].chosen.effect) == effect;
  }
};

/// The frames of a simulated run as candump text; returns the largest deflection, in metres.
[[nodiscard]] inline double write_record(const sim::SimulationConfig& config, double length_s,
                                         const std::string& path) {
  sim::Simulation simulation{config};
  sim::SensorNodes nodes{{}, config.seed};
  sim::Transport transport{{}, config.seed};
  fmt::memory_buffer text;
  double largest_m = 0.0;
  const auto samples = static_cast<std::int64_t>(length_s * sim::kSampleRateHz);
  for (std::int64_t n = 0; n < samples; ++n) {
    const sim::SimulatedSample sample = simulation.next();
    largest_m = std::max(largest_m, std::abs(sample.instant.deflection_m));
    for (const CanFrame& frame : transport.pass(nodes.pack(sample), sample.time_s))
      drivers::append_candump(text, frame, "can0");
  }
  std::ofstream{path}.write(text.data(), static_cast<std::streamsize>(text.size()));
  return largest_m;
}

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
  if (planted.parameter == "backlash_gap") out.backlash_gap.fill(planted.truth / scale_m);
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
  const double scale_m = app::pass_of(settings, {path, false}, {}).diagnosis->scale_m();
  const app::TruckPass pass =
      app::pass_of(settings, {path, false}, {true_grids(config, planted, scale_m), {}, false, {}});
  effect::ExplainerConfig wanted;
  wanted.moving_mass_kg = settings.car.moving_mass_kg;
  for (std::size_t i = 0; i < effect::kEffects; ++i)
    wanted.allowed[i] = planted.effect == effect::name_of(static_cast<effect::Effect>(i));
  return std::make_unique<effect::Explainer>()->explain(*pass.diagnosis, wanted);
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
  return std::make_unique<effect::Explainer>()->explain(*pass.diagnosis, nothing);
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
  const double largest_m = write_record(config, 300.0, path);
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
  for (const app::FaultFinding& f : found.identified.faults.list)
    out.faults += fmt::format(" {} {} at {:.0f} s", f.name, f.channel, f.time_s);
  out.planted = std::move(planted);
  out.coulomb_n = 0.5 * (config.truck.friction_positive_n + config.truck.friction_negative_n);
  // The estimate's k is the mean of both sides.
  out.stiffness_npm = config.truck.stiffness_npm + 0.5 * config.truck.stiffness.asymmetry_npm;
  return out;
}

}  // namespace dampline::bench
