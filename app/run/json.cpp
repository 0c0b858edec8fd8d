// SPDX-License-Identifier: MIT
#include "app/run/json.hpp"

#include <fmt/format.h>

#include <array>
#include <concepts>
#include <limits>
#include <nlohmann/json.hpp>

#include "app/error.hpp"
#include "app/run/trust.hpp"

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;
using Counted = std::vector<std::pair<std::string, std::uint64_t>>;

// One list of the members of each struct serves both directions: Put writes an object of them, Get
// reads it.

template <class S, class T>
concept Of = std::same_as<std::remove_const_t<S>, T>;

class Put {
 public:
  explicit Put(Json& json) : json_{json} {}
  template <class T>
  void operator()(const char* key, const T& value) {
    json_[key] = made_of(value);
  }
  void constant(const char* key, const auto& value) { json_[key] = value; }
  void choice(const char* key, bool value, const char* yes, const char* no) {
    json_[key] = value ? yes : no;
  }
  void trust(const char* key, Trust value) { json_[key] = name_of(value); }
  void estimate(const char* key, const std::optional<Estimate>& value, const char* unit) {
    json_[key] = nullptr;
    if (value) json_[key] = {{"value", value->value}, {"std", value->std}, {"unit", unit}};
  }
  template <class Walk>
  void object(const char* key, Walk members) {
    Json inner = Json::object();
    members(Put{inner});
    json_[key] = std::move(inner);
  }
  /// Whether a member that may be missing is there.
  bool has(const char* /*key*/, bool wanted) const { return wanted; }

 private:
  template <class T>
  static Json made_of(const T& value);
  static Json made_of(const Span& span) { return {span.start_s, span.end_s}; }
  static Json made_of(const Counted& counts) {
    Json object = Json::object();
    for (const auto& [name, count] : counts) object[name] = count;
    return object;
  }
  template <class T>
  static Json made_of(const std::optional<T>& value) {
    return value ? made_of(*value) : Json(nullptr);
  }
  template <class T>
  static Json made_of(const std::vector<T>& values) {
    Json list = Json::array();
    for (const T& value : values) list.push_back(made_of(value));
    return list;
  }
  Json& json_;
};

class Get {
 public:
  explicit Get(const Json& json) : json_{json} {}
  template <class T>
  void operator()(const char* key, T& value) {
    read(json_.at(key), value);
  }
  void constant(const char* /*key*/, const auto& /*value*/) {}
  void choice(const char* key, bool& value, const char* yes, const char* /*no*/) {
    value = json_.at(key) == yes;
  }
  void trust(const char* key, Trust& value) { value = trust_of(json_.at(key)); }
  void estimate(const char* key, std::optional<Estimate>& value, const char* /*unit*/) {
    const Json& json = json_.at(key);
    if (json.is_null()) return;
    value.emplace();
    read(json.at("value"), value->value);
    read(json.at("std"), value->std);
  }
  template <class Walk>
  void object(const char* key, Walk members) {
    members(Get{json_.at(key)});
  }
  bool has(const char* key, bool /*wanted*/) const { return json_.contains(key); }

 private:
  template <class T>
  static void read(const Json& json, T& value);
  static void read(const Json& json, Span& span) { span = {json.at(0), json.at(1)}; }
  static void read(const Json& json, Counted& counts) {
    for (const auto& [name, count] : json.items()) counts.emplace_back(name, count);
  }
  template <class T>
  static void read(const Json& json, std::optional<T>& value) {
    if (json.is_null()) return;
    T inner{};
    read(json, inner);
    value = std::move(inner);
  }
  template <class T>
  static void read(const Json& json, std::vector<T>& values) {
    for (const Json& item : json.get_ref<const Json::array_t&>()) read(item, values.emplace_back());
  }
  const Json& json_;
};

template <class Archive>
void list_members(Archive&& a, Of<FaultFinding> auto& f) {
  a("name", f.name);
  a("channel", f.channel);
  a("time_s", f.time_s);
  a("last_s", f.last_s);
  a("size", f.size);
  a("unit", f.unit);
  a("count", f.count);
  a("spoilt_s", f.spans);
}

template <class Archive>
void list_members(Archive&& a, Of<DriftFinding> auto& d) {
  a("parameter", d.parameter);
  a.choice("kind", d.step, "step", "drift");
  a("time_s", d.time_s);
  a("interval_s", d.interval_s);
  a("gain", d.gain);
  a("change", d.change_percent.value);
  a("std", d.change_percent.std);
  a.constant("unit", "%");
}

template <class Archive>
void list_members(Archive&& a, Of<AlarmFinding> auto& alarm) {
  a("parameter", alarm.parameter);
  a("change", alarm.change_percent);
  a.constant("unit", "%");
  a("since_s", alarm.since_s);
  a("time_s", alarm.time_s);
}

template <class Archive>
void list_members(Archive&& a, Of<DataFaults> auto& f) {
  a("faults", f.list);
  a.object("inputs", [&](auto in) {
    in("impacts", f.impacts);
    in("speed_changes", f.speed_changes);
  });
  if (a.has("repair", true))
    a.object("repair", [&](auto in) {
      in("values_replaced", f.values_replaced);
      in("samples_left_out", f.samples_spoilt);
    });
  if (a.has("alarms", true)) a("alarms", f.alarms);
  constexpr AlarmFigures kFigures;
  a.constant("alarm_figures", Json{{"false_alarms_per_1000_h", kFigures.false_alarms_per_1000_h},
                                   {"delay_s", kFigures.delay_s},
                                   {"delay_95_s", kFigures.delay_95_s}});
  if (a.has("time_drift", f.drift.has_value())) a("time_drift", f.drift);
}

template <class Archive>
void list_members(Archive&& a, Of<LiveFigures> auto& f) {
  a("state", f.state);
  a.object("lateness_us", [&](auto in) {
    in("p50", f.lateness_p50_us);
    in("p90", f.lateness_p90_us);
    in("p99", f.lateness_p99_us);
    in("p99.9", f.lateness_p999_us);
    in("max", f.lateness_max_us);
  });
  a("cycle_slips", f.cycle_slips);
  a("minor_faults", f.minor_faults);
  a("major_faults", f.major_faults);
  a("memory_locked", f.memory_locked);
  a("realtime_scheduled", f.realtime_scheduled);
  a("first_sample_s", f.first_sample_s);
  a("silence_s", f.silence_s);
  a("recording", f.recording);
  a("recorded_bytes", f.recorded_bytes);
  a("records_lost", f.records_lost);
  if (a.has("publish_failures", true)) a("publish_failures", f.publish_failures);
}

template <class Archive>
void list_members(Archive&& a, Of<Parameter> auto& p) {
  a("name", p.name);
  a("value", p.value);
  a("std", p.std);
  a("unit", p.unit);
  if (a.has("term", !p.term.empty())) {
    a("term", p.term);
    a.constant("t", p.value / p.std);
    a("cov", p.cov);
  }
  if (!a.has("correlation", p.correlation != 0.0)) return;
  a.object("correlation", [&](auto c) {
    c("with", p.twin);
    c("value", p.correlation);
  });
  a.constant("separable", is_separable(p));
}

template <class Archive>
void list_members(Archive&& a, Of<Objection> auto& o) {
  a("reason", o.reason);
  a("size", o.size);
  a("limit", o.limit);
  a("unit", o.unit);
}

template <class Archive>
void list_members(Archive&& a, Of<MethodSummary> auto& m) {
  a("name", m.name);
  a("title", m.title);
  std::optional<Estimate> level;
  if (m.has_level) level = m.level_n;
  a.estimate("coulomb", level, "N");
  if constexpr (!std::is_const_v<std::remove_reference_t<decltype(m)>>) {
    m.has_level = level.has_value();
    m.level_n = level.value_or(Estimate{});
  }
  a("trusted", m.trusted);
  a("objections", m.objections);
}

template <class Archive>
void list_members(Archive&& a, Of<Fit> auto& f) {
  a("nmse", f.nmse);
  a("rrse", f.rrse);
  a("held_out_nmse", f.held_out_nmse);
}

template <class Archive>
void list_members(Archive&& a, Of<BaseLaw> auto& b) {
  a("model", b.model);
  a("parameters", b.parameters);
  a("fit", b.fit);
}

template <class Archive>
void list_members(Archive&& a, Of<RowMethod> auto& m) {
  a.constant("name", "wavelet");
  a("wavelet", m.wavelet);
  a("level", m.level);
  a("step_s", m.step_s);
  a("window_rows", m.window_rows);
  a("gated", m.gated);
  a("mse_percent", m.mse_percent);
  a("held_out_mse_percent", m.held_out_mse_percent);
}

template <class Archive>
void list_members(Archive&& a, Of<RunResult> auto& r) {
  a("parameters", r.parameters);
  if (a.has("base", r.base.has_value())) a("base", r.base);
  a("counts", r.counts);
  a("fit", r.fit);
  a("kind", r.kind);
  a("headline", r.headline);
  if (a.has("trust", true)) {
    a.trust("trust", r.trust);
    a("trust_reasons", r.trust_reasons);
  }
  a("model", r.model);
  a("std_is_lower_bound", r.std_is_lower_bound);
  a("stick_share", r.stick_share);
  a("excitation", r.excitation);
  a("asymmetry", r.asymmetry);
  a.estimate("sample_rate", r.sample_rate_hz, "Hz");
  a("latency_s", r.latency_s);
  a("duration_s", r.duration_s);
  a("excluded_more", r.excluded_more);
  a("warnings", r.warnings);
  a("notes", r.notes);
  if (a.has("events_more", r.events_more > 0)) a("events_more", r.events_more);
  if (a.has("faults", r.kind == "truck" || !r.faults.list.empty())) list_members(a, r.faults);
  if (a.has("methods", !r.methods.empty())) a("methods", r.methods);
  if (a.has("method", r.row_method.has_value())) a("method", r.row_method);
  if (a.has("live", r.live.has_value())) a("live", r.live);
}

template <class T>
Json Put::made_of(const T& value) {
  if constexpr (requires(Put put) { list_members(put, value); }) {
    Json inner = Json::object();
    list_members(Put{inner}, value);
    return inner;
  } else {
    return value;
  }
}

template <class T>
void Get::read(const Json& json, T& value) {
  if constexpr (requires(Get get) { list_members(get, value); })
    list_members(Get{json}, value);
  else if constexpr (std::same_as<T, double>)
    value = json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
  else
    value = json.get<T>();
}

constexpr std::array<const char*, 4> kPictureStates{"empty", "constant", "clipped", "good"};
constexpr std::array<const char*, 4> kPeriodStates{"not_enough", "no_motion", "none", "found"};

struct Plane {
  const char* x;
  const char* y;
  PhasePicture PhaseSnapshot::*picture;
};
constexpr std::array<Plane, 3> kPlanes{
    Plane{"deflection_m", "velocity_mps", &PhaseSnapshot::velocity_over_deflection},
    Plane{"deflection_m", "accel_mps2", &PhaseSnapshot::accel_over_deflection},
    Plane{"velocity_mps", "accel_mps2", &PhaseSnapshot::accel_over_velocity}};

/// The state that is written as `word`.
template <class State, std::size_t N>
State state_of(const std::array<const char*, N>& words, const std::string& word) {
  for (std::size_t i = 0; i < N; ++i)
    if (word == words[i]) return static_cast<State>(i);
  throw RunError{fmt::format("no such state: {}", word)};
}

double five_digits(float value) { return std::stod(fmt::format("{:.5g}", value)); }

Json cells_of(const PhasePicture& picture) {
  Json cells = Json::array();
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      const float density = picture.density[i][j];
      if (density > 0.0F) cells.push_back({i, j, five_digits(density)});
    }
  }
  return cells;
}

Json plane_of(const Plane& plane, const PhaseSnapshot& phase) {
  const PhasePicture& picture = phase.*plane.picture;
  return {{"x", plane.x},
          {"y", plane.y},
          {"state", kPictureStates[static_cast<std::size_t>(picture.state)]},
          {"x_range", {picture.x_low, picture.x_high}},
          {"y_range", {picture.y_low, picture.y_high}},
          {"cells_per_axis", kPictureCells},
          {"samples", picture.samples},
          {"outside_share", picture.outside_share},
          {"density", cells_of(picture)}};
}

void read_plane(const Json& json, PhasePicture& picture) {
  picture.state = state_of<PictureState>(kPictureStates, json.at("state"));
  picture.x_low = json.at("x_range").at(0);
  picture.x_high = json.at("x_range").at(1);
  picture.y_low = json.at("y_range").at(0);
  picture.y_high = json.at("y_range").at(1);
  picture.samples = json.at("samples");
  picture.outside_share = json.at("outside_share");
  for (const Json& cell : json.at("density"))
    picture.density.at(cell.at(0)).at(cell.at(1)) = cell.at(2);
}

Json sections_of(const PhaseSnapshot& phase) {
  Json sections = Json::array();
  for (std::size_t p = 0; p < kSectionPhases; ++p) {
    Json points = Json::array();
    for (std::size_t i = 0; i < phase.section_count[p]; ++i) {
      const PhasePoint& point = phase.section[p][i];
      points.push_back({point.deflection_m, point.velocity_mps, point.accel_mps2});
    }
    sections.push_back(std::move(points));
  }
  return sections;
}

void read_sections(const Json& json, PhaseSnapshot& phase) {
  for (std::size_t p = 0; p < json.size(); ++p) {
    for (const Json& point : json.at(p)) {
      phase.section.at(p).at(phase.section_count.at(p)) = {point.at(0), point.at(1), point.at(2)};
      ++phase.section_count.at(p);
    }
  }
}

Json period_of(const PhaseSnapshot& phase) {
  const Period& p = phase.period;
  return {{"state", kPeriodStates[static_cast<std::size_t>(p.state)]},
          {"given", phase.period_is_known},
          {"value", p.period_s},
          {"std", p.period_std_s},
          {"unit", "s"},
          {"height", p.height},
          {"persistence", p.persistence},
          {"confidence", p.confidence}};
}

void read_period(const Json& json, PhaseSnapshot& phase) {
  phase.period_is_known = json.at("given");
  phase.period = {state_of<PeriodState>(kPeriodStates, json.at("state")),
                  json.at("value"),
                  json.at("std"),
                  json.at("height"),
                  json.at("persistence"),
                  json.at("confidence")};
}

}  // namespace

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Json parameter_json(std::string_view name, const Estimate& estimate, std::string_view unit) {
  return {{"name", name}, {"value", estimate.value}, {"std", estimate.std}, {"unit", unit}};
}

std::string to_json(const RunResult& result) {
  Json json;
  list_members(Put{json}, result);
  // Of a run that has ended the explanation is a file of its own.
  if (result.live && result.live->state != "ended" && !result.evidence.explanation.empty())
    json["explanation"] = Json::parse(result.evidence.explanation, nullptr, false);
  return json_text(json);
}

RunResult from_json(std::string_view text, const std::string& origin) {
  RunResult result;
  try {
    const Json json = Json::parse(text);
    list_members(Get{json}, result);
  } catch (const nlohmann::json::exception& error) {
    throw RunError{fmt::format("{}: not the parameters of a run: {}", origin, error.what())};
  }
  return result;
}

std::string to_json(const PhaseSnapshot& phase) {
  Json planes = Json::array();
  for (const Plane& plane : kPlanes) planes.push_back(plane_of(plane, phase));
  const Json json{{"planes", planes},
                  {"period", period_of(phase)},
                  {"section_columns", {"deflection_m", "velocity_mps", "accel_mps2"}},
                  {"sections", sections_of(phase)},
                  {"still", phase.still},
                  {"not_finite", phase.not_finite}};
  return json.dump() + "\n";
}

std::shared_ptr<const PhaseSnapshot> read_phase(std::string_view text, const std::string& origin) {
  try {
    const Json json = Json::parse(text);
    auto phase = std::make_shared<PhaseSnapshot>();
    for (std::size_t i = 0; i < kPlanes.size(); ++i)
      read_plane(json.at("planes").at(i), (*phase).*kPlanes[i].picture);
    read_period(json.at("period"), *phase);
    read_sections(json.at("sections"), *phase);
    phase->still = json.at("still");
    phase->not_finite = json.at("not_finite");
    return phase;
  } catch (const std::exception& error) {
    throw RunError{fmt::format("{}: not the phase planes of a run: {}", origin, error.what())};
  }
}

}  // namespace dampline::app
