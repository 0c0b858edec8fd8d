// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/run/provenance.hpp"
#include "dampline/explanation.hpp"
#include "dampline/phase/view.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::app {

/// Something in the record that a method assumes and that does not hold.
struct Objection {
  std::string reason;  ///< a plain sentence
  double size{0.0};    ///< of the violation
  double limit{0.0};   ///< the most, or the least, that the method can stand
  std::string unit;    ///< of both; empty: a pure number
};

/// What another method than the wavelet windows makes of the same record.
struct MethodSummary {
  std::string name;   ///< "fokker_planck_weak", ...: as in parameters.json and curve.csv
  std::string title;  ///< for people
  Estimate level_n;   ///< Coulomb level
  bool has_level{false};
  bool trusted{false};
  std::vector<Objection> objections;
  std::vector<Estimate> curve_n;  ///< at the velocities of RunResult::curve; NaN: no support
};

/// One bin of an online histogram.
struct DensityRow {
  double centre{0.0};
  double density{0.0};  ///< per unit of the quantity
  double samples{0.0};  ///< forgetting makes fractions of samples
};

/// Density of one quantity; its integral over the range is 1 - outside_share.
struct DensityTable {
  std::string quantity;  ///< with its unit: "deflection_m"
  double outside_share{0.0};
  std::vector<DensityRow> rows;
};

/// What a model leaves of the force, in one bin of what it is seen over.
struct ResidualRow {
  std::string over;   ///< "deflection_m", "velocity_mps", "frequency_hz", "time_s"
  double place{0.0};  ///< centre of the bin
  std::uint64_t samples{0};
  double before_mean_n{0.0};  ///< base model; 0 over frequency
  double before_rms_n{0.0};
  double after_mean_n{0.0};  ///< final model
  double after_rms_n{0.0};
};

/// One instant of an excerpt: the force that was measured, and both models' of it.
struct LoopRow {
  double time_s{0.0};
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double measured_n{0.0};
  double base_n{0.0};
  double final_n{0.0};
};

/// The damping force in steady sliding, undeflected.
struct LawRow {
  double velocity_mps{0.0};
  double base_n{0.0};
  double final_n{0.0};
};

/// One instant of a record that was never fitted.
struct PredictedRow {
  std::uint32_t record{1};
  double time_s{0.0};
  double measured_n{0.0};
  double predicted_n{0.0};  ///< final model
  double base_n{0.0};
  double reference_n{std::numeric_limits<double>::quiet_NaN()};  ///< NaN: there is none
};

/// What the report of an explanation shows beside explanation.json.
struct Evidence {
  std::string explanation;  ///< explanation.json as text; empty: the run explained nothing
  std::vector<ResidualRow> residual;
  std::vector<LoopRow> loops;
  std::vector<LawRow> law;
  std::vector<PredictedRow> prediction;
};

/// A stretch of the record, in seconds from its beginning.
struct Span {
  double start_s{0.0};
  double end_s{0.0};
};

/// A fault of sensor or transport, as parameters.json and the report name it.
struct FaultFinding {
  std::string name;     ///< "clipping", "lost_samples", ...
  std::string channel;  ///< "frame", "wheelset1", "wheelset2", "wheelsets", "all"
  double time_s{0.0};   ///< first seen, from the beginning of the record
  double last_s{0.0};
  double size{0.0};  ///< of several events the largest, of samples their sum
  std::string unit;
  std::uint64_t count{0};   ///< events, or blocks where it has no events
  std::vector<Span> spans;  ///< seconds that it spoils; capped
};

/// A parameter that changed while the record was made.
struct DriftFinding {
  static constexpr const char* kNotTold = "not_told";
  std::string parameter;    ///< "coulomb", "stiffness", "moving_mass"; or kNotTold
  bool step{false};         ///< at once; else slowly over the whole record
  double time_s{0.0};       ///< of the step, in moving time
  double interval_s{0.0};   ///< of uncertainty of that time
  double gain{0.0};         ///< share of the held-out error that it explains
  Estimate change_percent;  ///< after it, or at the end, against before
};

/// The live alarm: a parameter is not what it was when the watch began.
struct AlarmFinding {
  std::string parameter;  ///< "coulomb", "stiffness", "moving_mass"
  double change_percent{0.0};
  double since_s{0.0};  ///< from the beginning of the record
  double time_s{0.0};   ///< when it was told
};

/// What the live alarm is worth, from simulated months in which weather moves friction by 2 % over
/// a day and 1 % from day to day; `bench/months` measures it.
struct AlarmFigures {
  double false_alarms_per_1000_h{0.011};  ///< of motion: 2 in 180,000 h
  double delay_s{240.0};                  ///< median, in motion, friction 10 % less at once
  double delay_95_s{480.0};               ///< of 95 % of them
};

/// What the guards make of a record.
struct DataFaults {
  std::vector<FaultFinding> list;
  std::uint64_t impacts{0};          ///< rail joints, wheel flats: input, not faults
  std::uint64_t speed_changes{0};    ///< input, too
  std::uint64_t values_replaced{0};  ///< single wrong samples, by what their neighbours say
  std::uint64_t samples_spoilt{0};   ///< left out because of a fault that passed
  std::uint64_t values_bridged{0};   ///< that were missing, put in
  double placed_s{0.0};  ///< samples were put at their stamps, which are off even times by this rms
  bool lasting{false};   ///< nothing was done about one that changes the numbers
  std::optional<DriftFinding> drift;
  std::vector<AlarmFinding> alarms;  ///< the newest
};

/// A named result with its unit; names as in parameters.json ("coulomb", "coulomb_positive", ...).
struct Parameter {
  std::string name;
  double value{0.0};
  double std{0.0};
  std::string unit;
  /// Another one that it is most correlated with in this record; 0: not worked out.
  std::string twin{};
  double correlation{0.0};
  /// Of the method of wavelet rows: the term as it was asked for, and its coefficient of variation.
  std::string term{};
  double cov{0.0};
};

/// The parameter of that name; null: there is none.
[[nodiscard]] inline const Parameter* find_parameter(const std::vector<Parameter>& parameters,
                                                     std::string_view name) {
  for (const Parameter& p : parameters)
    if (p.name == name) return &p;
  return nullptr;
}
/// Its value and deviation; 0, 0: there is none.
[[nodiscard]] inline Estimate estimate_of(const std::vector<Parameter>& parameters,
                                          std::string_view name) {
  const Parameter* const found = find_parameter(parameters, name);
  return found == nullptr ? Estimate{} : Estimate{found->value, found->std};
}

/// Otherwise only what the two do together is known.
[[nodiscard]] inline bool is_separable(const Parameter& p) {
  return std::abs(p.correlation) <= effect::kInseparable;
}

/// What a viscous part would be beside a truck's dry friction.
struct ViscousPart {
  double share{0.0};   ///< of dry friction, at the rms velocity
  double sigmas{0.0};  ///< over its deviation
};

/// Errors of the fit, normalised by the variance of what was fitted. Absent: not computed.
struct Fit {
  std::optional<double> nmse;
  std::optional<double> rrse;
  std::optional<double> held_out_nmse;
  std::optional<ViscousPart> viscous{};      ///< this one and the next three are in no file
  std::optional<double> law_width_mps{};     ///< of a truck
  std::optional<double> law_width_share{};   ///< of the rms velocity; absent: of another law
  std::optional<double> velocity_rms_mps{};  ///< of a truck
};

/// Whether a script may act on a result, from good to bad.
enum class Trust : std::uint8_t {
  kTrusted,
  kModelIncomplete,  ///< something real is left that the model does not explain
  kDataFaulty,       ///< faults of sensors or transport that change the numbers
  kNotIdentified,    ///< numbers that cannot be, or that nothing supports
};

/// What tells a wrong unit of a truck's accelerations.
struct Magnitudes {
  double wheelset_mps2{0.0};  ///< rms, 4 to 90 Hz
  double weight_n{0.0};       ///< of the moving mass
  double frame_follow{0.0};   ///< the frame's motion over the wheelsets', at 1.2 Hz; 0: not known
  /// Of half the wheelsets' difference, that the frame shows at 3.5 to 7.6 Hz, and how much that is
  /// of what their mean leaves of its power; 0: not known.
  double pitch{0.0};
  double pitch_share{0.0};
  bool is_unfiltered{false};  ///< no low pass is declared: none, or none that is known
};

/// What identify says of a record that an explanation added to.
struct BaseLaw {
  std::vector<std::string> model;
  std::vector<Parameter> parameters;
  Fit fit;
};

/// A set of terms that was fitted beside the one asked for: what was changed, the t of the term
/// that it was changed by, and the errors. Not a number: the record does not determine the set.
struct TermSet {
  std::string change;  ///< "as asked", "without x^3", "with v^2"
  double t{0.0};       ///< of that term, in the set that has it
  double mse_percent{0.0};
  double held_out_mse_percent{0.0};
};

/// Coefficients of variation at one time, in the order of the parameters.
struct CovRow {
  double time_s{0.0};
  std::vector<double> cov;
};

/// How wavelet rows were made of a record and combined.
struct RowMethod {
  std::string wavelet;  ///< "D8"
  std::uint64_t level{0};
  double step_s{0.0};                        ///< of the rows' derivatives
  std::uint64_t window_rows{0};              ///< 0: least squares over all rows
  bool gated{false};                         ///< rows across a reversal were left out
  std::vector<double> mse_percent;           ///< of each mass
  std::vector<double> held_out_mse_percent;  ///< of rows that were not fitted
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

/// What the first estimate needs, in seconds of motion, and how much of it is there.
struct Collecting {
  double have_s{0.0};
  double need_s{0.0};
};

/// An alarm of [alarm]: what it watches and whether it is raised.
struct WatchState {
  std::string name;  ///< "coulomb_below", "drift", "fault_clipping", ...
  bool active{false};
  std::optional<double> value;  ///< as last seen; absent: not known yet, or not a number
  std::optional<double> limit;
  std::string unit;
  std::optional<double> since_s;  ///< raised at, from the beginning of the record
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
  std::optional<double> explanation_age_s;  ///< of the record, since its sums were taken
  std::optional<double> first_sample_s;     ///< from the start of the program to the first sample
  double silence_s{0.0};                    ///< without a sample, until now
  bool recording{false};
  std::uint64_t recorded_bytes{0};
  std::uint64_t records_lost{0};
  std::uint64_t publish_failures{0};       ///< how often live.json could not be written
  std::optional<Collecting> collecting{};  ///< until the first estimate
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
  Origin origin;         ///< of what is not written: when it was recorded, no more
  std::string kind;      ///< "truck" or "rig"
  std::string headline;  ///< the result in one plain sentence
  Trust trust{Trust::kNotIdentified};
  std::vector<std::string> trust_reasons;  ///< the gravest first; empty: trusted
  std::vector<std::string> model;          ///< terms
  std::vector<Parameter> parameters;
  std::vector<std::pair<std::string, std::uint64_t>> counts;
  Fit fit;
  std::vector<std::string> lacking;  ///< effects that an explanation beside a live result names
  std::optional<BaseLaw> base;     ///< after an explanation that added something: the model before
  bool std_is_unproven{false};     ///< outside the range in which deviations were validated
  bool std_is_lower_bound{false};  ///< unproven, or of a result that is not trusted
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
  DataFaults faults;
  std::optional<Magnitudes> magnitudes;  ///< of a truck record; in no file
  std::optional<double> frame_late_s;    ///< to the wheelsets, by trials, of a file; in no file
  std::optional<LiveFigures> live;
  std::vector<WatchState> watched;    ///< of a live run: the alarms of its configuration
  std::vector<LatenessRow> lateness;  ///< of a live run, ascending; bins with nothing are left out
  Evidence evidence;                  ///< of an explanation
  std::string law;  ///< law.json as text; empty: there is none that could be moved again
  // Of the method of wavelet rows.
  std::optional<RowMethod> row_method;
  Convergence windows;      ///< the estimates of each window
  std::vector<CovRow> cov;  ///< over time
  std::vector<TermSet> term_sets;
};

}  // namespace dampline::app
