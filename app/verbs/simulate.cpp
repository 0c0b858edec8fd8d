// SPDX-License-Identifier: MIT
#include "app/verbs/simulate.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "app/error.hpp"
#include "app/text/format.hpp"
#include "app/verbs/output.hpp"
#include "app/verbs/simulate_send.hpp"
#include "app/verbs/verbs.hpp"
#include "drivers/candump/line.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/writers.hpp"

namespace dampline::app {
namespace {

bool writes_csv(const SimulateOptions& options) {
  if (options.format.empty()) return options.out.ends_with(".csv");
  if (options.format != "csv" && options.format != "candump") {
    throw UsageError(fmt::format("--format: '{}', expected candump or csv", options.format));
  }
  return options.format == "csv";
}

bool own_ranges(const SimulatedRun& run) {
  return run.simulation.sensors.range_mps2 == sim::SensorConfig{}.range_mps2;
}

void write_text(const std::string& path, std::string_view text, bool replace) {
  TextFile file{path, replace};
  file.buffer().append(text.data(), text.data() + text.size());
  file.close();
}

void check_files(const SimulateOptions& options, const SimulatedRun& run, bool csv) {
  const sim::TransportConfig& transport = run.transport;
  if (csv && (transport.loss_fraction > 0.0 || transport.swap_fraction > 0.0 ||
              transport.swap_time_s >= 0.0)) {
    throw UsageError("--fault: loss and swap happen to frames, expected --format candump");
  }
  const std::array<std::string_view, 4> files{options.out, options.truth, options.dbc,
                                              options.config};
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (files[i].empty() || files[i] != files[j]) continue;
      throw UsageError(fmt::format("{}: named for two outputs, expected a file each", files[i]));
    }
  }
  if (!options.config.empty() && options.dbc.empty() && !own_ranges(run)) {
    throw UsageError(
        "--config-out: a sensor has another range than the project's DBC says, "
        "expected --dbc FILE too");
  }
}

void write_side_files(const SimulateOptions& options, const SimulatedRun& run) {
  namespace fs = std::filesystem;
  if (!options.dbc.empty()) {
    write_text(options.dbc,
               sim::dbc_text(run.simulation.sensors, run.nodes, run.simulation.extra_sensors),
               options.force);
  }
  if (options.config.empty()) return;
  std::string dbc;
  if (!options.dbc.empty()) {
    const fs::path folder = fs::absolute(options.config).parent_path();
    dbc = fs::absolute(options.dbc).lexically_proximate(folder).generic_string();
  }
  write_text(options.config, identify_config_text(run, dbc), options.force);
}

std::uint64_t write_record(const SimulateOptions& options, const SimulatedRun& run, bool csv) {
  TextFile record{options.out, options.force};
  TruthFile truth{options.truth, run.simulation, options.force};
  const bool extras = run.simulation.extra_sensors;
  if (csv) record.buffer().append(extras ? sim::kExtrasHeader : sim::kSampleHeader);
  sim::Simulation simulation{run.simulation};
  sim::SensorNodes nodes{run.nodes, run.simulation.seed};
  sim::Transport transport{run.transport, run.simulation.seed};
  const SimulateProgress progress{run.samples, options.quiet};
  std::uint64_t lines = 0;
  const auto write = [&](const CanFrame& frame) {
    drivers::append_candump(record.buffer(), frame, options.interface);
    ++lines;
  };
  for (std::int64_t i = 0; i < run.samples; ++i) {
    const sim::SimulatedSample sample = simulation.next();
    if (csv) {
      sim::append_csv(record.buffer(), sample, extras);
      ++lines;
    } else {
      std::ranges::for_each(transport.pass(nodes.pack(sample), sample.time_s), write);
      if (extras) std::ranges::for_each(nodes.pack_extras(sample), write);
    }
    record.tick();
    truth.append(sample);
    progress.at(i);
  }
  progress.end();
  record.close();
  truth.close();
  return lines;
}

}  // namespace

int simulate(const SimulateOptions& options) {
  const SimulatedRun run = make_simulated_run(options);
  const bool csv = writes_csv(options);
  check_files(options, run, csv);
  check_sending(options);
  write_side_files(options, run);
  if (!options.to.empty()) {
    send_run(options, run);
    return 0;
  }
  const std::uint64_t lines = write_record(options, run, csv);
  if (!options.quiet) {
    tell(fmt::format(
        "simulate: {:.6g} s, {} {} -> {}\n", static_cast<double>(run.samples) / sim::kSampleRateHz,
        lines, csv ? "rows" : "frames", options.out == "-" ? "standard output" : options.out));
  }
  return 0;
}

namespace {

std::string effect_help() {
  std::string text =
      "add an effect: NAME or NAME:parameter=value,... (repeatable); strength=1 "
      "scales the defaults. Names: ";
  for (const sim::Effect& effect : sim::effects()) {
    text += fmt::format("{}{}", &effect == sim::effects().data() ? "" : ", ", effect.name);
  }
  return text + ". --list-effects tells their parameters";
}

int list_effects() {
  const sim::SimulationConfig laden;
  for (const sim::Effect& effect : sim::effects()) {
    fmt::print("{}: {}\n", effect.name, effect.meaning);
    for (const sim::EffectParameter& parameter : effect.parameters) {
      fmt::print("    {} = {:.6g}\n", parameter.name, parameter.nominal(laden));
    }
  }
  return 0;
}

void add_car_flags(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--load", options.load, "laden or empty")->capture_default_str();
  verb.add_option("--speed-kmh", options.speed_kmh, "speed")->capture_default_str();
  verb.add_option("--track", options.track, "ORE B176 irregularity: low or high")
      ->capture_default_str();
  verb.add_option("--short-wave-mps2", options.short_wave_mps2,
                  "rms of the wheelsets' acceleration between 45 and 75 Hz")
      ->capture_default_str();
  verb.add_option("--friction-scale", options.friction_scale, "factor of the friction")
      ->capture_default_str();
  verb.add_option("--vehicle", options.vehicle,
                  "leading or trailing: this truck of a whole car (body and two trucks, four "
                  "degrees of freedom); without it a truck alone");
  verb.add_flag("--extra-sensors", options.extra_sensors,
                "with --vehicle: two more accelerometers, over the frame's first wheelset and on "
                "the other truck's frame");
  verb.add_option("--standstill", options.standstill_s, "START,END in seconds (repeatable)")
      ->delimiter(',')
      ->expected(2, 2 * static_cast<int>(sim::kMostStandstills))
      ->take_all();
  verb.add_option("--speed-change", options.speed_change, "TIME,KMH: change to another speed")
      ->delimiter(',')
      ->expected(2);
  verb.add_option("--effect", options.effects, effect_help())->expected(1)->take_all();
}

void add_sensor_flags(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--noise-mps2", options.noise_mps2,
                  "white noise of a sensor, rms; 0: only rounding is left, which is uneven, and "
                  "which the guards "
                  "may take for a burst of noise and leave seconds out of the results")
      ->capture_default_str();
  verb.add_option("--bias-mps2", options.bias_mps2, "constant error, one standard deviation")
      ->capture_default_str();
  verb.add_option("--drift-mps2", options.drift_mps2, "slow change of the bias, rms")
      ->capture_default_str();
  verb.add_option("--fault", options.faults,
                  fmt::format("add a fault (repeatable): {}", sim::kFaultHelp))
      ->expected(1)
      ->take_all();
}

void add_file_flags(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--out", options.out, "the record; - is the standard output")
      ->capture_default_str();
  verb.add_option("--format", options.format, "candump or csv; default by the suffix of --out");
  verb.add_option("--interface", options.interface, "name of the CAN interface in candump lines")
      ->capture_default_str();
  verb.add_option("--truth", options.truth, "also write states and forces, as CSV");
  verb.add_option("--dbc", options.dbc, "also write the DBC file of the sensors");
  verb.add_option("--config-out", options.config, "also write a configuration for identify");
  verb.add_flag("--force", options.force, "replace files that exist");
  verb.add_flag("--quiet", options.quiet, "no summary on the standard error");
}

void add_sending_flags(CLI::App& verb, SimulateOptions& options) {
  verb.add_option("--to", options.to, "send on this CAN interface instead of writing a record");
  verb.add_option("--speed", options.speed, "with --to: 2 is twice as fast as in reality")
      ->capture_default_str();
  verb.add_flag("--asap", options.asap, "with --to: as fast as possible");
  verb.add_option("--batch", options.batch_ticks,
                  "with --to: so many sample instants (1/300 s) together, when the last is due")
      ->capture_default_str();
}

}  // namespace

void add_simulate_verb(CLI::App& program, std::function<int()>& action) {
  CLI::App* const verb = program.add_subcommand(
      "simulate", "simulate a run of the car: three accelerometers on a CAN bus, or as CSV");
  const auto options = std::make_shared<SimulateOptions>();
  const auto listing = std::make_shared<bool>(false);
  verb->add_option("--duration", options->duration_s, "seconds")->capture_default_str();
  verb->add_option("--seed", options->seed, "the same seed gives the same bytes")
      ->capture_default_str();
  add_car_flags(*verb, *options);
  add_sensor_flags(*verb, *options);
  add_file_flags(*verb, *options);
  add_sending_flags(*verb, *options);
  verb->add_flag("--list-effects", *listing, "list the effects and their parameters, and end");
  verb->callback([options, listing, &action] {
    action = [options, listing] { return *listing ? list_effects() : simulate(*options); };
  });
}

}  // namespace dampline::app
