// SPDX-License-Identifier: MIT
#include "app/text/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <span>
#include <string_view>
#include <utility>

#include "app/run/trust.hpp"
#include "app/text/format.hpp"

namespace dampline::app {
namespace {

using Entry = std::pair<std::string_view, std::string_view>;

constexpr std::array<Entry, 13> kParameters{{
    {"coulomb", "dry friction: force level, whatever the speed"},
    {"coulomb_positive", "dry friction while v > 0"},
    {"coulomb_negative", "dry friction while v < 0"},
    {"stiffness", "spring of the suspension"},
    {"viscous", "damping that grows with speed"},
    {"viscous_positive", "damping that grows with speed, v > 0"},
    {"viscous_negative", "damping that grows with speed, v < 0"},
    {"coulomb_with_viscous", "dry friction in the model that has a viscous part"},
    {"viscous_at_rms", "force of the viscous part at the rms velocity"},
    {"law_width", "width of the jump at v = 0: rounding and velocity error"},
    {"moving_mass", "mass that moves"},
    {"offset", "constant force"},
    {"noise", "sensor noise of one channel, rms"},
}};

constexpr std::array<Entry, 39> kCounts{{
    {"samples", "samples read"},
    {"gaps", "gaps in the sequence"},
    {"lost", "samples lost in the gaps"},
    {"saturated", "samples with a channel at full scale"},
    {"stuck", "samples with a channel that stood still while another moved"},
    {"not_finite", "samples that are no number"},
    {"repeated", "samples that came twice or too late; ignored"},
    {"blocks", "blocks of about 2 s"},
    {"blocks_excluded", "blocks left out because of a fault"},
    {"blocks_spoilt", "of these because of a fault that the guards found"},
    {"blocks_still", "blocks at standstill"},
    {"blocks_used", "stretches of equal length that hold equations"},
    {"rows", "equations used"},
    {"rows_still", "equations left out: too little motion"},
    {"windows", "windows of rows that determine all terms"},
    {"windows_undetermined", "windows that do not"},
    {"frames", "CAN frames read"},
    {"frames_sent", "CAN frames that were sent, as their counters tell"},
    {"frames_processed", "of these: became part of a sample"},
    {"frames_dropped", "of these: dropped by the kernel, for want of room"},
    {"frames_missing", "of these: never arrived"},
    {"frames_excluded", "of these: arrived and were not used, for the reasons below"},
    {"frames_error", "error frames of the bus"},
    {"frames_foreign", "of other senders"},
    {"frames_repeated", "came twice"},
    {"frames_late", "came too late"},
    {"frames_out_of_step", "their counter contradicts their time"},
    {"frames_wrong_length", "too short for their signals"},
    {"frames_not_data", "remote requests"},
    {"frames_other_page", "another page of a multiplexed message"},
    {"frames_without_partner", "another channel's frame of that instant is missing"},
    {"incomplete", "instants that lacked a channel"},
    {"restarts", "long pauses after which the channels were aligned anew"},
    {"lines_malformed", "malformed lines, skipped on request"},
    {"edges", "edges of the digital lines"},
    {"edges_lost", "edges known to be lost"},
    {"edges_impossible", "edges that followed one of their own direction"},
    {"pulses_implausible", "pulses per second that were not 1 s apart"},
    {"frames_reordered", "frames with a time before that of the frame ahead of them"},
}};

std::string look_up(std::span<const Entry> entries, std::string_view name,
                    std::string_view otherwise) {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& entry) { return entry.first == name; });
  return std::string{found == entries.end() ? otherwise : found->second};
}

}  // namespace

std::string meaning_of_parameter(std::string_view name) { return look_up(kParameters, name, ""); }
std::string meaning_of_count(std::string_view name) { return look_up(kCounts, name, name); }

namespace {

/// Name, value, deviation, unit and a remark, in columns.
std::string estimate_line(std::string_view name, const Estimate& estimate, std::string_view unit,
                          std::string_view remark) {
  const QuantityText text = format_quantity(estimate.value, estimate.std);
  const std::string std = text.std.empty() ? "" : "± " + text.std;
  // The sign is two bytes wide and one column: pad by hand.
  const std::size_t columns = text.std.empty() ? 0 : text.std.size() + 2;
  return fmt::format("  {:<20} {:>14} {}{} {:<6} {}\n", name, text.value, std,
                     std::string(columns < 12 ? 12 - columns : 0, ' '), unit, remark);
}

std::string parameter_lines(const RunResult& result) {
  std::string out;
  for (const Parameter& p : result.parameters)
    out += estimate_line(p.name, {p.value, p.std}, p.unit, meaning_of_parameter(p.name));
  return out;
}

std::string verdict_on(const MethodSummary& method) {
  if (method.trusted) return "can be trusted here";
  std::string out = "not to be trusted here";
  for (const Objection& o : method.objections)
    out +=
        fmt::format("{} {}: {:.3g}{}{}, limit {:.3g}", &o == method.objections.data() ? ":" : ";",
                    o.reason, o.size, o.unit.empty() ? "" : " ", o.unit, o.limit);
  return out;
}

std::string method_lines(const RunResult& result) {
  std::string out;
  for (const MethodSummary& m : result.methods) {
    if (m.has_level)
      out += estimate_line(m.name, m.level_n, "N", verdict_on(m));
    else
      out += fmt::format("  {:<20} no level; {}\n", m.name, verdict_on(m));
  }
  return out;
}

std::string fit_line(const RunResult& result) {
  std::string out;
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) out += fmt::format("{}{} {:.3g}", out.empty() ? "" : ", ", name, *value);
  };
  add("nmse", result.fit.nmse);
  add("rrse", result.fit.rrse);
  add("held-out nmse", result.fit.held_out_nmse);
  return out.empty() ? "" : fmt::format("  {:<20} {}\n", "fit", out);
}

std::string trust_lines(const RunResult& result) {
  std::string out = fmt::format("  {:<20} {}\n", "trust", name_of(result.trust));
  for (const std::string& reason : result.trust_reasons)
    out += fmt::format("  {:<20} {}\n", "", reason);
  return out;
}

std::string excluded_line(const RunResult& result) {
  if (result.excluded.empty()) return fmt::format("  {:<20} nothing\n", "left out");
  std::map<std::string, double> seconds;
  for (const Excluded& e : result.excluded) seconds[e.reason] += e.end_s - e.start_s;
  std::string out;
  for (const auto& [reason, sum] : seconds)
    out += fmt::format("{}{} ({})", out.empty() ? "" : ", ", format_duration(sum), reason);
  if (result.excluded_more > 0) out += fmt::format(", and {} more stretches", result.excluded_more);
  return fmt::format("  {:<20} {}\n", "left out", out);
}

}  // namespace

std::string summarize(const RunResult& result) {
  std::string out = result.headline + "\n" + parameter_lines(result) + method_lines(result) +
                    fit_line(result) + excluded_line(result);
  out += trust_lines(result);
  if (!result.asymmetry.empty()) out += fmt::format("  {:<20} {}\n", "asymmetry", result.asymmetry);
  if (result.std_is_lower_bound)
    out += fmt::format("  {:<20} the stated deviations are lower bounds\n", "uncertainty");
  for (const std::string& warning : result.warnings)
    out += fmt::format("  {:<20} {}\n", "warning", warning);
  return out;
}

std::string describe_rows(const RunResult& result) {
  const RowMethod& m = result.row_method.value();
  const auto count = [&](std::string_view name) {
    for (const auto& [counted, value] : result.counts)
      if (counted == name) return format_count(value);
    return std::string{"0"};
  };
  const std::string combined =
      m.window_rows == 0
          ? fmt::format("least squares over {} rows", count("rows"))
          : fmt::format("{} windows of {} rows, mean and scatter; {} windows undetermined",
                        count("windows"), m.window_rows, count("windows_undetermined"));
  return fmt::format("{} at level {} (step {:.4g} ms), {}{}", m.wavelet, m.level, 1e3 * m.step_s,
                     combined, m.gated ? "; none across a reversal" : "");
}

std::string describe_alarm(const AlarmFinding& alarm) {
  return fmt::format("{} changed by {:+.1f} % since {:.0f} s, told at {:.0f} s", alarm.parameter,
                     alarm.change_percent, alarm.since_s, alarm.time_s);
}

std::string describe_alarm_figures() {
  constexpr AlarmFigures kFigures;
  return fmt::format(
      "on simulated months {:.2g} false alarms in 1,000 h of motion, and friction that falls by "
      "10 % is told {:.0f} min later (95 %: {:.0f} min)",
      kFigures.false_alarms_per_1000_h, kFigures.delay_s / 60.0, kFigures.delay_95_s / 60.0);
}

std::string fault_size(const FaultFinding& fault) {
  return fault.unit == "-" ? "" : fmt::format("{:.4g} {}", fault.size, fault.unit);
}

std::string describe_drift(const DriftFinding& drift) {
  std::string change = fmt::format("{} changed by {:+.1f} ± {:.1f} %", drift.parameter,
                                   drift.change_percent.value, drift.change_percent.std);
  if (drift.parameter == DriftFinding::kNotTold)
    change = "what changed is not told, since a gap or friction with a memory is there,";
  if (!drift.step) return change + ", slowly over the record";
  return fmt::format("{} at {:.0f} ± {:.0f} s of moving time", change, drift.time_s,
                     0.5 * drift.interval_s);
}

std::string drift_text(const DriftFinding& drift) {
  return fmt::format("{}: {}.", kNotConstant, describe_drift(drift));
}

std::string drift_warning(const DriftFinding& drift, std::string_view over) {
  return fmt::format("{} The values stated are means over the {}.", drift_text(drift), over);
}

}  // namespace dampline::app
