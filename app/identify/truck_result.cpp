// SPDX-License-Identifier: MIT
#include "app/identify/truck_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "app/text/format.hpp"
#include "app/text/summary.hpp"
#include "dampline/effect/judgement.hpp"

namespace dampline::app {

namespace {

constexpr double kNotableShare = 0.02;  // of the level: a viscous part worth speaking of
constexpr double kNotableSigmas = 3.0;
constexpr double kRareSupport = 50.0;  // samples

std::string pair_text(const Estimate& estimate, double scale, const char* unit) {
  const QuantityText text = format_quantity(scale * estimate.value, scale * estimate.std);
  if (text.std.empty()) return fmt::format("{} {}", text.value, unit);
  return fmt::format("{} ± {} {}", text.value, text.std, unit);
}

bool has(const std::vector<std::string>& words, const char* word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void add(RunResult& result, const char* name, const Estimate& estimate, const char* unit) {
  result.parameters.push_back({name, estimate.value, estimate.std, unit});
}

void fill_parameters(const Snapshot& s, const ModelConfig& model, RunResult& result) {
  const bool viscous = has(model.base, "viscous");
  add(result, "coulomb", viscous ? s.coulomb_with_viscous_n : s.coulomb_n, "N");
  add(result, "stiffness", viscous ? s.stiffness_with_viscous_npm : s.stiffness_npm, "N/m");
  if (viscous) add(result, "viscous", s.viscous_nspm, "N s/m");
  add(result, "law_width", viscous ? s.law_width_with_viscous_mps : s.law_width_mps, "m/s");
  result.model = {"linear spring"};
  result.model.insert(result.model.end(), model.base.begin(), model.base.end());
}

void fill_counts(const Counts& c, RunResult& result) {
  result.counts = {{"samples", c.samples},
                   {"gaps", c.gaps},
                   {"lost", c.lost},
                   {"saturated", c.saturated},
                   {"stuck", c.stuck},
                   {"not_finite", c.not_finite},
                   {"repeated", c.repeated},
                   {"blocks", c.blocks},
                   {"blocks_excluded", c.blocks_excluded},
                   {"blocks_still", c.blocks_still},
                   {"rows", c.rows},
                   {"rows_still", c.rows_still}};
}

/// The curve is odd: the branch v < 0 mirrors v > 0 but has its own support.
void fill_curve(const Snapshot& s, RunResult& result) {
  for (std::size_t i = kCurveSegments; i-- > 0;) {
    const CurvePoint& p = s.curve[i];
    result.curve.push_back({-p.velocity_mps, -p.force_n, p.std_n, s.samples_negative[i]});
  }
  result.curve.push_back({0.0, -s.curve_force_at_zero_n, s.curve_std_at_zero_n, 0});
  result.curve.push_back({0.0, s.curve_force_at_zero_n, s.curve_std_at_zero_n, 0});
  for (const CurvePoint& p : s.curve)
    result.curve.push_back({p.velocity_mps, p.force_n, p.std_n, p.samples});
}

std::string viscous_note(const Snapshot& s) {
  const double force = s.viscous_nspm.value * s.velocity_rms_mps;
  const double share = force / s.coulomb_n.value;
  const bool notable = std::fabs(share) > kNotableShare &&
                       std::fabs(s.viscous_nspm.value) > kNotableSigmas * s.viscous_nspm.std;
  const std::string what = fmt::format(
      "A viscous part, had the model one, would be {}: {:.2g} % of the dry friction at the "
      "rms velocity of {:.3g} mm/s.",
      pair_text(s.viscous_nspm, 1.0, "N s/m"), 100.0 * share, 1e3 * s.velocity_rms_mps);
  return what + (notable
                     ? " That is more than chance: consider base = [\"coulomb\", \"viscous\"] in "
                       "[model]."
                     : " That is not significant.");
}

void fill_notes(const Snapshot& s, const TruckRecord& record, const ModelConfig& model,
                RunResult& result) {
  if (!has(model.base, "viscous")) result.notes.push_back(viscous_note(s));
  result.notes.emplace_back(
      "Forces and stiffness scale with [car] moving_mass_kg, which accelerations "
      "cannot show: an error of 1 % there is an error of 1 % here.");
  result.notes.push_back(
      fmt::format("Sensor noise, estimated above 120 Hz: {:.3g} m/s^2 rms.", s.noise_mps2));
  const auto rare = std::count_if(s.curve.begin(), s.curve.end(), [](const CurvePoint& p) {
    return static_cast<double>(p.samples) < kRareSupport;
  });
  if (rare > 0)
    result.notes.push_back(fmt::format("{} of the curve's {} nodes have fewer than {:g} samples.",
                                       rare, kCurveSegments, kRareSupport));
  if (!(record.measured.rate_hz > 0.0))
    result.notes.emplace_back("The record's own time did not allow to measure the sample rate.");
}

}  // namespace

RunResult describe_truck(const TruckRecord& record, const ModelConfig& model) {
  const Snapshot& s = record.snapshot;
  RunResult result;
  result.kind = "truck";
  fill_parameters(s, model, result);
  fill_counts(s.counts, result);
  fill_curve(s, result);
  const bool viscous = has(model.base, "viscous");
  const double nmse = viscous ? s.nmse_with_viscous : s.nmse;
  result.fit = {
      nmse, std::sqrt(nmse), viscous ? s.held_out_nmse_with_viscous : s.held_out_nmse, {}, {}, {}};
  result.std_is_unproven = viscous ? s.std_with_viscous_is_lower_bound : s.std_is_lower_bound;
  result.stick_share = s.stick_share;
  result.excitation = s.excitation;
  result.asymmetry = "not observable from accelerations";
  if (record.measured.rate_hz > 0.0)
    result.sample_rate_hz = Estimate{record.measured.rate_hz, record.measured.std_hz};
  result.duration_s = record.time_s(record.newest_tick + 1);
  result.fit.law_width_mps = result.parameters.back().value;
  result.fit.law_width_share = *result.fit.law_width_mps / s.velocity_rms_mps;
  result.fit.velocity_rms_mps = s.velocity_rms_mps;
  if (!viscous)
    result.fit.viscous = {s.viscous_nspm.value * s.velocity_rms_mps / s.coulomb_n.value,
                          s.viscous_nspm.value / s.viscous_nspm.std};
  fill_notes(s, record, model, result);
  return result;
}

void fill_history(const std::vector<ConvergenceHistory::Row>& rows, const TruckRecord& record,
                  RunResult& result) {
  const double factor = record.correction.stiffness();
  result.convergence.names = {"coulomb", "stiffness"};
  result.convergence.units = {"N", "N/m"};
  for (const ConvergenceHistory::Row& row : rows) {
    const Estimate stiffness{factor * row.stiffness_npm.value, factor * row.stiffness_npm.std};
    result.convergence.rows.push_back({record.time_s(row.tick), {row.coulomb_n, stiffness}});
  }
}

void fill_motion(const std::vector<Motion>& motion, const TruckRecord& record, RunResult& result) {
  result.motion.reserve(motion.size());
  for (const Motion& m : motion)
    result.motion.push_back({record.time_s(m.tick), record.correction.deflection() * m.deflection_m,
                             record.correction.velocity() * m.velocity_mps});
}

namespace {

constexpr std::size_t kMostSpans = 200;

std::vector<Span> spoilt_spans(const Guard& guard, const Fault& fault, double nominal_hz,
                               const TruckRecord& record) {
  const auto second = std::max<std::int64_t>(std::llround(nominal_hz), 1);
  std::vector<Span> spans;
  const std::int64_t known = record.newest_tick - FaultLog::kSeconds * second;
  for (std::int64_t tick = std::max(record.first_tick, known); tick <= record.newest_tick;
       tick += second) {
    if (!guard.spoilt(fault.kind, fault.channel, tick)) continue;
    const double start_s = record.time_s(tick);
    const double end_s = record.time_s(tick + second);
    if (!spans.empty() && start_s - spans.back().end_s < 0.5) {
      spans.back().end_s = end_s;
    } else if (spans.size() < kMostSpans) {
      spans.push_back({start_s, end_s});
    }
  }
  return spans;
}

std::string warning_of(const DataFaults& faults) {
  std::string names;
  for (const FaultFinding& f : faults.list)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", f.name, f.channel);
  return "The data have faults, listed under data quality: " + names + ".";
}

}  // namespace

void describe_faults(const FaultView& view, const TruckRecord& record, double nominal_hz,
                     DataFaults& out) {
  const auto own_s = [&](double time_s) {
    return record.time_s(std::llround(time_s * nominal_hz));
  };
  for (const Fault& fault : view.list()) {
    out.list.push_back({name_of(fault.kind),
                        name_of(fault.channel),
                        own_s(fault.time_s),
                        own_s(fault.last_s),
                        fault.size,
                        fault.unit,
                        fault.count,
                        {}});
  }
  for (const std::uint64_t impacts : view.inputs.impacts) out.impacts += impacts;
  out.speed_changes = view.inputs.speed_changes;
  out.values_replaced = view.repairs.replaced;
  out.samples_spoilt = view.repairs.spoilt;
  out.values_bridged = view.repairs.bridged.values;
  const auto& placed_s = view.repairs.placed.off_s;
  out.placed_s = *std::max_element(placed_s.begin(), placed_s.end());
  const auto wrong_rate = [](const Fault& f) { return f.kind == FaultKind::kWrongSampleRate; };
  const auto list = view.list();
  out.lasting = effect::forbids_naming(view) || std::any_of(list.begin(), list.end(), wrong_rate);
}

void add_fault(FaultKind kind, FaultChannel channel, double size, RunResult& result) {
  DataFaults& faults = result.faults;
  if (!faults.list.empty()) std::erase(result.warnings, warning_of(faults));
  faults.list.push_back({name_of(kind), name_of(channel), 0.0, 0.0, size, unit_of(kind), 1, {}});
  faults.lasting = true;
  result.warnings.push_back(warning_of(faults));
}

DriftFinding finding_of(const ParameterDrift& drift) {
  return {
      name_of(drift.parameter), drift.step, drift.time_s,
      drift.interval_s,         drift.gain, {100.0 * drift.change.value, 100.0 * drift.change.std}};
}

void describe_faults_of_all(const Guard& guard, const FaultView& view, const ParameterDrift& drift,
                            const TruckRecord& record, double nominal_hz, RunResult& result) {
  DataFaults& out = result.faults;
  describe_faults(view, record, nominal_hz, out);
  for (std::size_t i = 0; i < out.list.size(); ++i)
    out.list[i].spans = spoilt_spans(guard, view.faults[i], nominal_hz, record);
  if (drift.found) {
    out.drift = finding_of(drift);
    result.warnings.push_back(drift_warning(*out.drift, "record"));
  }
  if (!out.list.empty()) result.warnings.push_back(warning_of(out));
}

void describe_alarms(const AlarmView& view, const TruckRecord& record, RunResult& result) {
  const std::uint64_t held = std::min<std::uint64_t>(view.count, AlarmView::kMost);
  for (std::uint64_t i = view.count - held; i < view.count; ++i) {
    const AlarmView::Alarm& alarm = view.alarms[i % AlarmView::kMost];
    const AlarmFinding finding{name_of(alarm.parameter), 100.0 * alarm.change,
                               record.time_s(alarm.since_tick), record.time_s(alarm.tick)};
    result.faults.alarms.push_back(finding);
    result.warnings.push_back(
        fmt::format("Alarm: {} ({}).", describe_alarm(finding), describe_alarm_figures()));
  }
}

namespace {

template <class Histogram>
DensityTable density_table(const Histogram& histogram, const char* quantity, double factor) {
  DensityTable table{quantity, histogram.share_outside(), {}};
  for (std::size_t b = 0; b < Histogram::kBins; ++b)
    table.rows.push_back(
        {factor * histogram.axis().centre(b), histogram.density(b) / factor, histogram.mass(b)});
  return table;
}

/// The broken line at `velocity_mps` on the branch of `side`; NaN outside its support.
Estimate force_at(std::span<const CurvePoint> points, double velocity_mps, bool positive) {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const CurvePoint& a = points[i];
    const CurvePoint& b = points[i + 1];
    const bool branch = positive ? a.velocity_mps >= 0.0 : b.velocity_mps <= 0.0;
    if (!branch || !(a.velocity_mps < b.velocity_mps)) continue;
    if (velocity_mps < a.velocity_mps || velocity_mps > b.velocity_mps) continue;
    const double t = (velocity_mps - a.velocity_mps) / (b.velocity_mps - a.velocity_mps);
    return {(1.0 - t) * a.force_n + t * b.force_n, (1.0 - t) * a.std_n + t * b.std_n};
  }
  return {kNothing, kNothing};
}

std::vector<Estimate> along(const std::vector<CurveRow>& curve, std::span<const CurvePoint> points,
                            double nominal_per_true) {
  std::vector<Estimate> out;
  bool past_zero = false;
  for (const CurveRow& row : curve) {
    const bool positive = row.velocity_mps > 0.0 || past_zero;
    past_zero = past_zero || row.velocity_mps == 0.0;
    out.push_back(force_at(points, row.velocity_mps * nominal_per_true, positive));
  }
  return out;
}

std::vector<Objection> objections_of(const TrustVerdict& verdict) {
  std::vector<Objection> out;
  for (std::size_t i = 0; i < kReasons; ++i) {
    const auto reason = static_cast<Reason>(i);
    const Finding& finding = verdict[reason];
    if (finding.violated) out.push_back({text(reason), finding.size, finding.limit, unit(reason)});
  }
  return out;
}

/// The same picture with its axes in other units.
void stretch(PhasePicture& picture, double x, double y) {
  picture.x_low *= x;
  picture.x_high *= x;
  picture.y_low *= y;
  picture.y_high *= y;
  for (auto& column : picture.density) {
    for (float& density : column) density /= static_cast<float>(x * y);
  }
}

// Rms of the level's error: 0.8 % of 13 trusted of 20 trucks without an effect
// (tests/app/unseen_truck, seeds 2001 to 2020), 0.4 % of 12 runs of sim_hw; the scatter alone said
// 0.05 to 0.13 %.
constexpr double kKnownInputFloor = 0.008;

/// On track, errors of the velocity bend the curve of the known input (14 % low at 3 mm/s, 7 % high
/// at 26 mm/s, of friction that is constant): half of what a node lies off the level is in its
/// deviation, and what that makes of the level is in the level's.
MethodResult with_velocity_error(MethodResult known) {
  const double level_n = std::abs(known.level_n.value);
  const double floor_n = kKnownInputFloor * level_n;
  known.level_n.std = std::hypot(known.level_n.std, floor_n);
  for (std::size_t i = 0; i < known.points; ++i) {
    CurvePoint& point = known.curve[i];
    point.std_n = std::hypot(point.std_n, floor_n, 0.5 * (std::abs(point.force_n) - level_n));
  }
  return known;
}

}  // namespace

void fill_densities(const FokkerPlanck& statistics, const TruckRecord& record, RunResult& result) {
  if (statistics.samples() == 0) return;
  result.densities = {
      density_table(statistics.deflections(), "deflection_m", record.correction.deflection()),
      density_table(statistics.velocities(), "velocity_mps", record.correction.velocity())};
}

void fill_phase(const PhaseView& view, const TruckRecord& record, RunResult& result) {
  const auto phase = std::make_shared<PhaseSnapshot>();
  view.snapshot(*phase);
  const double y = record.correction.deflection();
  const double v = record.correction.velocity();
  stretch(phase->velocity_over_deflection, y, v);
  stretch(phase->accel_over_deflection, y, 1.0);
  stretch(phase->accel_over_velocity, v, 1.0);
  phase->period.period_s /= record.correction.ratio;
  phase->period.period_std_s /= record.correction.ratio;
  for (std::size_t p = 0; p < kSectionPhases; ++p) {
    for (std::size_t i = 0; i < phase->section_count[p]; ++i) {
      phase->section[p][i].deflection_m *= y;
      phase->section[p][i].velocity_mps *= v;
    }
  }
  result.phase = phase;
}

void fill_methods(const FokkerPlanck& statistics, double mass_kg, double nominal_stiffness_npm,
                  const TruckRecord& record, RunResult& result) {
  const FokkerPlanckEstimates found = statistics.estimates(mass_kg, nominal_stiffness_npm);
  const auto add = [&](const char* name, const char* title, const MethodResult& method) {
    const std::span<const CurvePoint> points{method.curve.data(),
                                             method.verdict.has_number ? method.points : 0};
    result.methods.push_back({name, title, method.level_n, method.verdict.has_number,
                              method.verdict.trusted, objections_of(method.verdict),
                              along(result.curve, points, 1.0 / record.correction.velocity())});
  };
  add("fokker_planck_paper", "Fokker-Planck, Kisilowski and Urbanski 1987", found.paper);
  add("fokker_planck_weak", "Fokker-Planck, weak form", found.weak);
  add("known_input", "conditional mean with the known input",
      with_velocity_error(found.known_input));
}

}  // namespace dampline::app
