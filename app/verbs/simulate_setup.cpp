// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>

#include "app/error.hpp"
#include "app/verbs/simulate.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

void require(bool good, std::string_view option, double found, std::string_view expected) {
  if (!good) throw UsageError(fmt::format("{}: {}, expected {}", option, found, expected));
}

void require(const std::optional<std::string>& error, std::string_view option) {
  if (error) throw UsageError(fmt::format("{}: {}", option, *error));
}

bool choose(std::string_view option, const std::string& found, std::string_view first,
            std::string_view second) {
  if (found != first && found != second) {
    throw UsageError(fmt::format("{}: '{}', expected {} or {}", option, found, first, second));
  }
  return found == first;
}

/// False for NaN and infinity too.
bool within(double value, double least, double most) { return value >= least && value <= most; }

void check_numbers(const SimulateOptions& options) {
  constexpr double kTenYears = 3.2e8;
  require(within(options.duration_s, 1.0 / sim::kSampleRateHz, kTenYears), "--duration",
          options.duration_s, "seconds, at least one sample (0.00334)");
  require(within(options.speed_kmh, 0.0, 500.0), "--speed-kmh", options.speed_kmh, "0 to 500");
  require(within(options.short_wave_mps2, 0.0, 1000.0), "--short-wave-mps2",
          options.short_wave_mps2, "0 to 1000");
  require(within(options.friction_scale, 0.0, 1000.0), "--friction-scale", options.friction_scale,
          "0 to 1000");
  require(within(options.noise_mps2, 0.0, 1000.0), "--noise-mps2", options.noise_mps2, "0 to 1000");
  require(within(options.bias_mps2, 0.0, 1000.0), "--bias-mps2", options.bias_mps2, "0 to 1000");
  require(within(options.drift_mps2, 0.0, 1000.0), "--drift-mps2", options.drift_mps2, "0 to 1000");
}

void set_standstills(const SimulateOptions& options, sim::SpeedConfig& speed) {
  const std::vector<double>& times = options.standstill_s;
  const auto count = static_cast<double>(times.size());
  require(times.size() % 2 == 0 && times.size() / 2 <= speed.standstills.size(), "--standstill",
          count, fmt::format("a start and an end of at most {}", speed.standstills.size()));
  // Time to start and to brake again lies between two of them.
  const double apart_s = 2.0 * speed.speed_mps / speed.ramp_mps2;
  double earliest_s = 0.0;
  for (std::size_t i = 0; 2 * i < times.size(); ++i) {
    const double start = times[2 * i];
    const double end = times[2 * i + 1];
    require(within(start, earliest_s, end) && std::isfinite(end) && end > start, "--standstill",
            start, fmt::format("a start of {:.0f} or more before the end ({})", earliest_s, end));
    speed.standstills[i] = {start, end};
    earliest_s = end + apart_s;
  }
}

void set_speed(const SimulateOptions& options, sim::SpeedConfig& speed) {
  set_standstills(options, speed);
  if (!options.speed_change.empty()) {
    const double kmh = options.speed_change.at(1);
    require(within(options.speed_change.at(0), 0.0, std::numeric_limits<double>::max()),
            "--speed-change", options.speed_change.at(0), "a time of 0 s or later");
    require(within(kmh, 0.0, 500.0), "--speed-change", kmh, "0 to 500 km/h");
    speed.change_time_s = options.speed_change.at(0);
    speed.changed_speed_mps = kmh / 3.6;
  }
}

void set_vehicle(const SimulateOptions& options, sim::SimulationConfig& config) {
  if (options.vehicle.empty()) {
    if (options.extra_sensors)
      throw UsageError("--extra-sensors: a truck alone, expected --vehicle too");
    return;
  }
  config.extra_sensors = options.extra_sensors;
  const bool leading = choose("--vehicle", options.vehicle, "leading", "trailing");
  config.vehicle.emplace().instrumented =
      leading ? sim::TruckPosition::kLeading : sim::TruckPosition::kTrailing;
  config.truck.modes.pitch_inertia_kgm2 = sim::kFramePitchInertiaKgm2;
}

void check_vehicle(const sim::SimulationConfig& config) {
  if (!config.vehicle || sim::Vehicle::supports(config.truck)) return;
  throw UsageError(
      "--vehicle: an effect with a memory of its own (pre-sliding, backlash, a viscoelastic "
      "element, a flexible body, a drift), expected one that the whole car knows, or a truck "
      "alone");
}

}  // namespace

SimulatedRun make_simulated_run(const SimulateOptions& options) {
  check_numbers(options);
  const bool laden = choose("--load", options.load, "laden", "empty");
  const bool low = choose("--track", options.track, "low", "high");
  SimulatedRun run;
  sim::SimulationConfig& config = run.simulation;
  config = sim::reference_run(laden ? sim::Load::kLaden : sim::Load::kEmpty, options.speed_kmh,
                              options.seed, options.short_wave_mps2);
  if (config.speed.speed_mps == 0.0) config.track.nominal_speed_mps = 80.0 / 3.6;
  config.track.amplitude_m_rad = low ? sim::kTrackAmplitudeLow : sim::kTrackAmplitudeHigh;
  config.truck.friction_scale = options.friction_scale;
  config.sensors.noise_mps2 = options.noise_mps2;
  config.sensors.bias_mps2 = options.bias_mps2;
  config.sensors.drift_mps2 = options.drift_mps2;
  set_speed(options, config.speed);
  set_vehicle(options, config);
  for (const std::string& effect : options.effects) {
    require(sim::add_effect_text(config, effect), "--effect");
  }
  check_vehicle(config);
  for (const std::string& fault : options.faults) {
    require(sim::add_fault_text(config, run.transport, fault), "--fault");
  }
  run.samples = std::llround(options.duration_s * sim::kSampleRateHz);
  return run;
}

namespace {

/// Masses of the reduction to one truck: of a whole car that which moves with this truck alone.
std::string car_text(const sim::SimulationConfig& simulation) {
  const sim::TruckConfig& truck = simulation.truck;
  const sim::VehicleMasses masses = simulation.vehicle
                                        ? sim::masses_of(*simulation.vehicle, truck)
                                        : sim::VehicleMasses{truck.moving_mass_kg, 0.0};
  std::string text = fmt::format("[car]\nmoving_mass_kg = {:.1f}\n", masses.own_kg);
  if (simulation.extra_sensors) {
    const double arm_m = truck.modes.pitch_half_wheelbase_m;
    text += fmt::format("far_mass_kg = {:.1f}\nframe_pitch_mass_kg = {:.1f}\n", masses.other_kg,
                        truck.modes.pitch_inertia_kgm2 / (arm_m * arm_m));
  }
  return text + fmt::format("suspension_stiffness_npm = {:.1f}\n", truck.stiffness_npm);
}

}  // namespace

std::string identify_config_text(const SimulatedRun& run, const std::string& dbc) {
  const auto& range = run.simulation.sensors.range_mps2;
  std::string text =
      car_text(run.simulation) + fmt::format("\n[input]\nsample_rate_hz = {:.1f}\n\n[input.can]\n",
                                             static_cast<double>(sim::kSampleRateHz));
  if (!dbc.empty()) {
    std::string quoted;
    for (const char c : dbc) {
      if (c == '"' || c == '\\') quoted += '\\';
      quoted += c;
    }
    text += fmt::format("dbc = \"{}\"\n", quoted);
  }
  constexpr double kNearlyFull = sim::kMaxCount - 0.5;  // counts; decimals must not hide a full one
  constexpr std::array<std::string_view, kChannels> kKeys{"frame_accel", "wheelset1_accel",
                                                          "wheelset2_accel"};
  for (std::size_t c = 0; c < kChannels; ++c) {
    text += fmt::format("{} = \"{}.ACCEL_Z\"\n", kKeys[c], sim::kMessageNames[c]);
  }
  text += fmt::format(
      "\n[input.range_mps2]\nframe = {:.6f}\nwheelset1 = {:.6f}\nwheelset2 = {:.6f}\n",
      kNearlyFull * sim::count_scale_mps2(range[0]), kNearlyFull * sim::count_scale_mps2(range[1]),
      kNearlyFull * sim::count_scale_mps2(range[2]));
  return text;
}

}  // namespace dampline::app
