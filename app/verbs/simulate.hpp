// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "sim_hw/faults.hpp"
#include "sim_hw/nodes.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {

/// What a person asks of `dampline simulate`.
struct SimulateOptions {
  double duration_s{300.0};
  std::uint64_t seed{1};
  std::string load{"laden"};  ///< or "empty"
  double speed_kmh{80.0};
  std::string track{"low"};  ///< ORE B176, or "high"
  double short_wave_mps2{2.0};
  double friction_scale{1.0};
  std::string vehicle;               ///< "leading" or "trailing" truck of a whole car; empty: alone
  bool extra_sensors{false};         ///< of a vehicle: frame end and the other truck's frame
  std::vector<double> standstill_s;  ///< start and end of each
  std::vector<double> speed_change;  ///< seconds and km/h, or nothing
  double noise_mps2{0.02};
  double bias_mps2{0.1};
  double drift_mps2{0.05};
  std::vector<std::string> effects;  ///< NAME or NAME:parameter=value,...
  std::vector<std::string> faults;   ///< NAME or NAME:parameter=value,...
  std::string out{"-"};              ///< "-" is the standard output
  std::string format;                ///< "candump" or "csv"; empty: by the suffix of `out`
  std::string interface { "can0" };  ///< that candump lines name
  std::string truth;                 ///< file for the truth, or nothing
  std::string dbc;                   ///< file for the DBC, or nothing
  std::string config;                ///< file for a configuration of `identify`, or nothing
  std::string to;  ///< CAN interface to send on, instead of writing a record; or nothing
  double speed{1.0};
  bool asap{false};             ///< as fast as possible
  std::int64_t batch_ticks{1};  ///< sample instants that are sent together
  bool force{false};            ///< replaces files that exist
  bool quiet{false};
};

/// Everything that decides a run's content.
struct SimulatedRun {
  sim::SimulationConfig simulation;
  sim::NodeConfig nodes;
  sim::TransportConfig transport;
  std::int64_t samples{0};
};

/// Throws UsageError naming the option, what was found and what was expected.
[[nodiscard]] SimulatedRun make_simulated_run(const SimulateOptions& options);

/// A TOML configuration with which `identify` reads the run; `dbc` is its path as seen from the
/// configuration, empty for the project's own.
[[nodiscard]] std::string identify_config_text(const SimulatedRun& run, const std::string& dbc);

/// Simulates and writes the files, or sends. Returns 0; throws UsageError or RunError.
int simulate(const SimulateOptions& options);

}  // namespace dampline::app
