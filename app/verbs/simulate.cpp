// SPDX-License-Identifier: MIT
#include "app/verbs/simulate.hpp"

#include <fmt/format.h>

#include <array>
#include <cstdio>
#include <filesystem>

#include "app/error.hpp"
#include "app/verbs/simulate_files.hpp"
#include "app/verbs/simulate_send.hpp"
#include "app/verbs/text_file.hpp"
#include "drivers/candump/line.hpp"
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

void write_text(const std::string& path, std::string_view text) {
  TextFile file{path};
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
    write_text(options.dbc, sim::dbc_text(run.simulation.sensors, run.nodes));
  }
  if (options.config.empty()) return;
  std::string dbc;
  if (!options.dbc.empty()) {
    const fs::path folder = fs::absolute(options.config).parent_path();
    dbc = fs::absolute(options.dbc).lexically_proximate(folder).generic_string();
  }
  write_text(options.config, identify_config_text(run, dbc));
}

std::uint64_t write_record(const SimulateOptions& options, const SimulatedRun& run, bool csv) {
  TextFile record{options.out};
  TruthFile truth{options.truth, run.simulation};
  if (csv) record.buffer().append(sim::kSampleHeader);
  sim::Simulation simulation{run.simulation};
  sim::SensorNodes nodes{run.nodes, run.simulation.seed};
  sim::Transport transport{run.transport, run.simulation.seed};
  const SimulateProgress progress{run.samples, options.quiet};
  std::uint64_t lines = 0;
  for (std::int64_t i = 0; i < run.samples; ++i) {
    const sim::SimulatedSample sample = simulation.next();
    if (csv) {
      sim::append_csv(record.buffer(), sample);
      ++lines;
    } else {
      for (const CanFrame& frame : transport.pass(nodes.pack(sample), sample.time_s)) {
        drivers::append_candump(record.buffer(), frame, options.interface);
        ++lines;
      }
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
    fmt::print(stderr, "simulate: {:.6g} s, {} {} -> {}\n",
               static_cast<double>(run.samples) / sim::kSampleRateHz, lines,
               csv ? "rows" : "frames", options.out == "-" ? "standard output" : options.out);
  }
  return 0;
}

}  // namespace dampline::app
