// SPDX-License-Identifier: MIT
#include "app/run/parameters_json.hpp"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "app/error.hpp"
#include "app/run/faults_json.hpp"

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;

Json number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json estimate(const std::optional<Estimate>& value) {
  if (!value) return nullptr;
  return {{"value", value->value}, {"std", value->std}, {"unit", "Hz"}};
}

Json live(const LiveFigures& f) {
  return {{"state", f.state},
          {"lateness_us",
           {{"p50", f.lateness_p50_us},
            {"p90", f.lateness_p90_us},
            {"p99", f.lateness_p99_us},
            {"p99.9", f.lateness_p999_us},
            {"max", f.lateness_max_us}}},
          {"cycle_slips", f.cycle_slips},
          {"minor_faults", f.minor_faults},
          {"major_faults", f.major_faults},
          {"memory_locked", f.memory_locked},
          {"realtime_scheduled", f.realtime_scheduled},
          {"first_sample_s", number(f.first_sample_s)},
          {"silence_s", f.silence_s},
          {"recording", f.recording},
          {"recorded_bytes", f.recorded_bytes},
          {"records_lost", f.records_lost}};
}

LiveFigures read_live(const Json& json) {
  LiveFigures f;
  f.state = json.at("state");
  const Json& lateness = json.at("lateness_us");
  f.lateness_p50_us = lateness.at("p50");
  f.lateness_p90_us = lateness.at("p90");
  f.lateness_p99_us = lateness.at("p99");
  f.lateness_p999_us = lateness.at("p99.9");
  f.lateness_max_us = lateness.at("max");
  f.cycle_slips = json.at("cycle_slips");
  f.minor_faults = json.at("minor_faults");
  f.major_faults = json.at("major_faults");
  f.memory_locked = json.at("memory_locked");
  f.realtime_scheduled = json.at("realtime_scheduled");
  if (!json.at("first_sample_s").is_null()) f.first_sample_s = json.at("first_sample_s");
  f.silence_s = json.at("silence_s");
  f.recording = json.at("recording");
  f.recorded_bytes = json.at("recorded_bytes");
  f.records_lost = json.at("records_lost");
  return f;
}

Json parameters(const RunResult& result) {
  Json list = Json::array();
  for (const Parameter& p : result.parameters)
    list.push_back({{"name", p.name}, {"value", p.value}, {"std", p.std}, {"unit", p.unit}});
  return list;
}

Json methods(const RunResult& result) {
  Json list = Json::array();
  for (const MethodSummary& m : result.methods) {
    Json objections = Json::array();
    for (const Objection& o : m.objections)
      objections.push_back(
          {{"reason", o.reason}, {"size", o.size}, {"limit", o.limit}, {"unit", o.unit}});
    Json level = nullptr;
    if (m.has_level) level = {{"value", m.level_n.value}, {"std", m.level_n.std}, {"unit", "N"}};
    list.push_back({{"name", m.name},
                    {"title", m.title},
                    {"coulomb", level},
                    {"trusted", m.trusted},
                    {"objections", objections}});
  }
  return list;
}

double read_number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

std::optional<double> read_optional(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return json.get<double>();
}

void read_parameters(const Json& list, RunResult& result) {
  for (const Json& p : list)
    result.parameters.push_back({p.at("name"), read_number(p.at("value")), read_number(p.at("std")),
                                 p.at("unit").get<std::string>()});
}

void read_methods(const Json& list, RunResult& result) {
  for (const Json& m : list) {
    MethodSummary& method = result.methods.emplace_back();
    method.name = m.at("name");
    method.title = m.at("title");
    const Json& level = m.at("coulomb");
    method.has_level = !level.is_null();
    if (method.has_level)
      method.level_n = {read_number(level.at("value")), read_number(level.at("std"))};
    method.trusted = m.at("trusted");
    for (const Json& o : m.at("objections"))
      method.objections.push_back({o.at("reason"), read_number(o.at("size")),
                                   read_number(o.at("limit")), o.at("unit").get<std::string>()});
  }
}

RunResult read_result(const Json& json) {
  RunResult result;
  result.kind = json.at("kind");
  result.headline = json.at("headline");
  result.model = json.at("model");
  read_parameters(json.at("parameters"), result);
  for (const auto& [name, count] : json.at("counts").items())
    result.counts.emplace_back(name, count.get<std::uint64_t>());
  const Json& fit = json.at("fit");
  result.fit = {read_optional(fit.at("nmse")), read_optional(fit.at("rrse")),
                read_optional(fit.at("held_out_nmse"))};
  result.std_is_lower_bound = json.at("std_is_lower_bound");
  result.stick_share = read_optional(json.at("stick_share"));
  result.excitation = read_optional(json.at("excitation"));
  result.asymmetry = json.at("asymmetry");
  if (const Json& rate = json.at("sample_rate"); !rate.is_null())
    result.sample_rate_hz = Estimate{read_number(rate.at("value")), read_number(rate.at("std"))};
  result.latency_s = read_optional(json.at("latency_s"));
  result.duration_s = json.at("duration_s");
  result.excluded_more = json.at("excluded_more");
  result.warnings = json.at("warnings");
  result.notes = json.at("notes");
  result.events_more = json.value("events_more", std::uint64_t{0});
  result.faults = read_faults(json);
  if (json.contains("methods")) read_methods(json.at("methods"), result);
  if (json.contains("live")) result.live = read_live(json.at("live"));
  return result;
}

}  // namespace

std::string to_json(const RunResult& result) {
  Json counts = Json::object();
  for (const auto& [name, count] : result.counts) counts[name] = count;
  Json json{{"parameters", parameters(result)},
            {"counts", counts},
            {"fit",
             {{"nmse", number(result.fit.nmse)},
              {"rrse", number(result.fit.rrse)},
              {"held_out_nmse", number(result.fit.held_out_nmse)}}},
            {"kind", result.kind},
            {"headline", result.headline},
            {"model", result.model},
            {"std_is_lower_bound", result.std_is_lower_bound},
            {"stick_share", number(result.stick_share)},
            {"excitation", number(result.excitation)},
            {"asymmetry", result.asymmetry},
            {"sample_rate", estimate(result.sample_rate_hz)},
            {"latency_s", number(result.latency_s)},
            {"duration_s", result.duration_s},
            {"excluded_more", result.excluded_more},
            {"warnings", result.warnings},
            {"notes", result.notes}};
  if (result.events_more > 0) json["events_more"] = result.events_more;
  if (result.kind == "truck") write_faults(result.faults, json);
  if (!result.methods.empty()) json["methods"] = methods(result);
  if (result.live) json["live"] = live(*result.live);
  // Of a run that has ended the explanation is a file of its own.
  if (result.live && result.live->state != "ended" && !result.evidence.explanation.empty())
    json["explanation"] = Json::parse(result.evidence.explanation, nullptr, false);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

RunResult from_json(std::string_view text, const std::string& origin) {
  try {
    return read_result(Json::parse(text));
  } catch (const nlohmann::json::exception& error) {
    throw RunError{fmt::format("{}: not the parameters of a run: {}", origin, error.what())};
  }
}

}  // namespace dampline::app
