// SPDX-License-Identifier: MIT
#include "app/identify/fault_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/text/summary.hpp"

namespace dampline::app {
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
    result.warnings.push_back("A parameter is not constant: " + describe_drift(*out.drift) +
                              ". The values stated are means over the record.");
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

}  // namespace dampline::app
