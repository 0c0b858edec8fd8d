// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/run/evidence.hpp"
#include "app/run/faults.hpp"
#include "app/run/methods.hpp"
#include "dampline/phase/view.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::app {

/// A named result with its unit; names as in parameters.json ("coulomb", "coulomb_positive", ...).
struct Parameter {
  std::string name;
  double value{0.0};
  double std{0.0};
  std::string unit;
};

/// Errors of the fit, normalised by the variance of what was fitted. Absent: not computed.
struct Fit {
  std::optional<double> nmse;
  std::optional<double> rrse;
  std::optional<double> held_out_nmse;
};

struct CurveRow {
  double velocity_mps{0.0};
  double force_n{0.0};
  double std_n{0.0};
  std::uint64_t samples{0};
};

/// How parameters developed over the record. Each row's estimates follow `names`.
struct Convergence {
  struct Row {
    double time_s{0.0};
    std::vector<Estimate> estimates;
  };
  std::vector<std::string> names;
  std::vector<std::string> units;
  std::vector<Row> rows;
};

struct MotionRow {
  double time_s{0.0};
  double deflection_m{0.0};
  double velocity_mps{0.0};
};

/// Measured and fitted force of a rig: an excerpt.
struct ForceRow {
  double time_s{0.0};
  double velocity_mps{0.0};
  double measured_n{0.0};
  double fitted_n{0.0};
};

/// A stretch of the record that was left out, in seconds from its beginning.
struct Excluded {
  double start_s{0.0};
  double end_s{0.0};
  std::string reason;
};

/// Something that happened beside the samples: the link went down, a marker, a rotated file.
struct RunEvent {
  double time_s{0.0};  ///< from the first sample; before it negative
  std::string name;    ///< "link_down", "marker_on", ...
  std::uint64_t line{0};
  std::int64_t value{0};
};

/// How a live run kept up. Times from a frame's stamp to its result.
struct LiveFigures {
  std::string state;  ///< "waiting", "identifying", "degraded", "fault" or "ended"
  double lateness_p50_us{0.0};
  double lateness_p90_us{0.0};
  double lateness_p99_us{0.0};
  double lateness_p999_us{0.0};
  double lateness_max_us{0.0};
  std::uint64_t cycle_slips{0};   ///< samples that were late by more than one sampling period
  std::uint64_t minor_faults{0};  ///< page faults of the acquisition after its warm-up
  std::uint64_t major_faults{0};
  bool memory_locked{false};
  bool realtime_scheduled{false};
  std::optional<double> first_sample_s;  ///< from the start of the program to the first sample
  double silence_s{0.0};                 ///< without a sample, until now
  bool recording{false};
  std::uint64_t recorded_bytes{0};
  std::uint64_t records_lost{0};
};

/// A bin of the histogram of lateness, with how many frames were so late.
struct LatenessRow {
  double from_us{0.0};
  double to_us{0.0};
  std::uint64_t frames{0};
};

/// What an identification hands to the run directory. The order of `parameters`, `counts` and
/// `notes` is the order in which people see them.
struct RunResult {
  std::string kind;                ///< "truck" or "rig"
  std::string headline;            ///< the result in one plain sentence
  std::vector<std::string> model;  ///< terms
  std::vector<Parameter> parameters;
  std::vector<std::pair<std::string, std::uint64_t>> counts;
  Fit fit;
  bool std_is_lower_bound{false};
  std::optional<double> stick_share;
  std::optional<double> excitation;  ///< share of the record that moved
  std::string asymmetry;             ///< a sentence: what is known about F(v > 0) against F(v < 0)
  std::optional<Estimate> sample_rate_hz;
  std::optional<double> latency_s;
  double duration_s{0.0};
  std::vector<std::string> warnings;  ///< what a reader must know before trusting the numbers
  std::vector<std::string> notes;
  std::vector<CurveRow> curve;  ///< ascending velocity; a jump at 0 is two rows with velocity 0
  std::vector<MethodSummary> methods;  ///< beside the wavelet windows, where they were asked for
  std::vector<DensityTable> densities;
  std::shared_ptr<const PhaseSnapshot> phase;  ///< of a truck; large, hence shared
  Convergence convergence;
  std::vector<MotionRow> motion;   ///< an excerpt of at most 20 s
  std::vector<ForceRow> force;     ///< an excerpt; empty for a truck
  std::vector<Excluded> excluded;  ///< capped
  std::uint64_t excluded_more{0};  ///< stretches beyond the cap
  std::vector<RunEvent> events;    ///< capped
  std::uint64_t events_more{0};    ///< events beyond the cap
  DataFaults faults;               ///< of a truck record
  std::optional<LiveFigures> live;
  std::vector<LatenessRow> lateness;  ///< of a live run, ascending; bins with nothing are left out
  Evidence evidence;                  ///< of an explanation
};

}  // namespace dampline::app
