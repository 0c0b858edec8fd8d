// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include "dampline/explanation.hpp"
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
inline constexpr std::array kConditions{Condition{"laden 80", sim::Load::kLaden, 80.0},
                                        Condition{"laden 60", sim::Load::kLaden, 60.0},
                                        Condition{"empty 80", sim::Load::kEmpty, 80.0}};

/// An effect as it is planted: its name, what to simulate, and the parameter that tells its size,
/// with the true value (no name: none is compared).
struct Planted {
  std::string effect;
  std::string text;
  std::string parameter;
  double truth{0.0};
};

/// The kinds that are planted: every effect with a name; "mode" and "pitch" are both an unmodelled
/// mode.
inline std::vector<std::string> planted_kinds() {
  std::vector<std::string> kinds;
  for (std::size_t e = 0; e < effect::kEffects; ++e) {
    const auto each = static_cast<effect::Effect>(e);
    if (each == effect::Effect::kUnknown) continue;
    if (each == effect::Effect::kUnmodelledMode) {
      kinds.insert(kinds.end(), {"pitch", "mode"});
    } else {
      kinds.emplace_back(effect::name_of(each));
    }
  }
  return kinds;
}

/// Plants one kind at a strength, 1 being nominal; channels, signs and frequencies by chance.
inline Planted plant(const std::string& kind, double strength, sim::Random& random) {
  const auto sign = [&] { return random.uniform() < 0.5 ? -1.0 : 1.0; };
  const std::array<const char*, 3> channels{"frame", "wheelset1", "wheelset2"};
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
  if (e == "viscoelastic") set("viscoelastic_stiffness", t.hysteresis.viscoelastic_npm);
  if (e == "backlash") set("backlash_gap", t.hysteresis.backlash_gap_m);
  if (e == "bump_stop") set("bump_stop_gap", t.stiffness.bump_gap_m);
  if (e == "cubic_stiffness") set("cubic_stiffness", t.stiffness.cubic_npm3);
  if (e == "quadratic_stiffness") set("quadratic_stiffness", t.stiffness.quadratic_npm2);
  if (e == "asymmetric_stiffness")
    set("asymmetric_stiffness_difference", t.stiffness.asymmetry_npm);
}

/// What a simulated run's deflection did.
struct Deflection {
  double largest_m{0.0};
  double mean_m{0.0};
};

/// The frames of a simulated run as candump text.
inline Deflection write_record(const sim::SimulationConfig& config, double length_s,
                               const std::string& path) {
  sim::Simulation simulation{config};
  sim::SensorNodes nodes{{}, config.seed};
  sim::Transport transport{{}, config.seed};
  fmt::memory_buffer text;
  Deflection out;
  const auto samples = static_cast<std::int64_t>(length_s * sim::kSampleRateHz);
  for (std::int64_t n = 0; n < samples; ++n) {
    const sim::SimulatedSample sample = simulation.next();
    out.largest_m = std::max(out.largest_m, std::abs(sample.instant.deflection_m));
    out.mean_m += sample.instant.deflection_m / static_cast<double>(samples);
    for (const CanFrame& frame : transport.pass(nodes.pack(sample), sample.time_s))
      drivers::append_candump(text, frame, "can0");
  }
  std::ofstream{path}.write(text.data(), static_cast<std::streamsize>(text.size()));
  return out;
}

}  // namespace dampline::bench
