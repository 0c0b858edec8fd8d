// SPDX-License-Identifier: MIT
#include "app/run/faults_json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;

Json fault(const FaultFinding& f) {
  Json spans = Json::array();
  for (const Span& span : f.spans) spans.push_back({span.start_s, span.end_s});
  return {{"name", f.name}, {"channel", f.channel}, {"time_s", f.time_s}, {"last_s", f.last_s},
          {"size", f.size}, {"unit", f.unit},       {"count", f.count},   {"spoilt_s", spans}};
}

FaultFinding read_fault(const Json& json) {
  FaultFinding f;
  f.name = json.at("name");
  f.channel = json.at("channel");
  f.time_s = json.at("time_s");
  f.last_s = json.at("last_s");
  f.size = json.at("size");
  f.unit = json.at("unit");
  f.count = json.at("count");
  for (const Json& span : json.at("spoilt_s")) f.spans.push_back({span.at(0), span.at(1)});
  return f;
}

Json drift(const DriftFinding& d) {
  return {{"parameter", d.parameter},
          {"kind", d.step ? "step" : "drift"},
          {"time_s", d.time_s},
          {"interval_s", d.interval_s},
          {"gain", d.gain},
          {"change", d.change_percent.value},
          {"std", d.change_percent.std},
          {"unit", "%"}};
}

Json alarm(const AlarmFinding& a) {
  return {{"parameter", a.parameter},
          {"change", a.change_percent},
          {"unit", "%"},
          {"since_s", a.since_s},
          {"time_s", a.time_s}};
}

}  // namespace

void write_faults(const DataFaults& faults, Json& json) {
  Json list = Json::array();
  for (const FaultFinding& f : faults.list) list.push_back(fault(f));
  json["faults"] = list;
  json["inputs"] = {{"impacts", faults.impacts}, {"speed_changes", faults.speed_changes}};
  json["repair"] = {{"values_replaced", faults.values_replaced},
                    {"samples_left_out", faults.samples_spoilt}};
  Json alarms = Json::array();
  for (const AlarmFinding& a : faults.alarms) alarms.push_back(alarm(a));
  json["alarms"] = alarms;
  constexpr AlarmFigures kFigures;
  json["alarm_figures"] = {{"false_alarms_per_1000_h", kFigures.false_alarms_per_1000_h},
                           {"delay_s", kFigures.delay_s},
                           {"delay_95_s", kFigures.delay_95_s}};
  if (faults.drift) json["time_drift"] = drift(*faults.drift);
}

DataFaults read_faults(const Json& json) {
  DataFaults out;
  if (!json.contains("faults")) return out;
  for (const Json& f : json.at("faults")) out.list.push_back(read_fault(f));
  out.impacts = json.at("inputs").at("impacts");
  out.speed_changes = json.at("inputs").at("speed_changes");
  if (json.contains("repair")) {
    out.values_replaced = json.at("repair").at("values_replaced");
    out.samples_spoilt = json.at("repair").at("samples_left_out");
  }
  if (json.contains("alarms"))
    for (const Json& a : json.at("alarms"))
      out.alarms.push_back({a.at("parameter"), a.at("change"), a.at("since_s"), a.at("time_s")});
  if (!json.contains("time_drift")) return out;
  const Json& d = json.at("time_drift");
  out.drift = DriftFinding{d.at("parameter"), d.at("kind") == "step",
                           d.at("time_s"),    d.at("interval_s"),
                           d.at("gain"),      Estimate{d.at("change"), d.at("std")}};
  return out;
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

std::string describe_drift(const DriftFinding& drift) {
  const std::string change = fmt::format("{} changed by {:+.1f} ± {:.1f} %", drift.parameter,
                                         drift.change_percent.value, drift.change_percent.std);
  if (!drift.step) return change + ", slowly over the record";
  return fmt::format("{} at {:.0f} ± {:.0f} s of moving time", change, drift.time_s,
                     0.5 * drift.interval_s);
}

}  // namespace dampline::app
