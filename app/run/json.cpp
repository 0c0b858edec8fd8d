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

constexpr const char* kParametersSchema = "dampline.parameters/1";
constexpr const char* kLiveSchema = "dampline.live/1";

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
  void known(const char* key, const std::string& text) {
    json_[key] = text.empty() ? Json(nullptr) : Json(text);
  }
  void time(const char* key, const std::optional<std::int64_t>& utc_since_1970_ns) {
    json_[key] = utc_since_1970_ns ? Json(utc_text(*utc_since_1970_ns)) : Json(nullptr);
  }
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
  void known(const char* key, std::string& text) {
    if (const Json& json = json_.at(key); !json.is_null()) text = json.get<std::string>();
  }
  void time(const char* key, std::optional<std::int64_t>& utc_since_1970_ns) {
    if (const Json& json = json_.at(key); !json.is_null())
      utc_since_1970_ns = utc_ns(json.get_ref<const std::string&>());
  }
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
      if (in.has("values_bridged", true)) in("values_bridged", f.values_bridged);
      if (in.has("placed_s", f.placed_s > 0.0)) in("placed_s", f.placed_s);
    });
  if (a.has("alarms", true)) a("alarms", f.alarms);
  constexpr AlarmFigures kFigures;
  a.constant("alarm_figures", Json{{"false_alarms_per_1000_h", kFigures.false_alarms_per_1000_h},
                                   {"delay_s", kFigures.delay_s},
                                   {"delay_95_s", kFigures.delay_95_s}});
  if (a.has("time_drift", f.drift.has_value())) a("time_drift", f.drift);
}

template <class Archive>
void list_members(Archive&& a, Of<Collecting> auto& c) {
  a("have_s", c.have_s);
  a("need_s", c.need_s);
}

template <class Archive>
void list_members(Archive&& a, Of<WatchState> auto& w) {
  a("name", w.name);
  a("active", w.active);
  a("value", w.value);
  a("limit", w.limit);
  a("unit", w.unit);
  a("since_s", w.since_s);
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
  a("explanation_age_s", f.explanation_age_s);
  a("silence_s", f.silence_s);
  a("recording", f.recording);
  a("recorded_bytes", f.recorded_bytes);
  a("records_lost", f.records_lost);
  if (a.has("publish_failures", true)) a("publish_failures", f.publish_failures);
  if (a.has("collecting", f.collecting.has_value())) a("collecting", f.collecting);
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
void list_members(Archive&& a, Of<InputFile> auto& f) {
  a("name", f.name);
  a("role", f.role);
  a("bytes", f.bytes);
  a.known("sha256", f.sha256);
}

template <class Archive>
void list_members(Archive&& a, Of<Origin> auto& o) {
  a.constant("schema", o.written_ns ? kLiveSchema : kParametersSchema);
  a("version", o.version);
  a.known("commit", o.commit);
  if (a.has("written_utc", o.written_ns.has_value())) a.time("written_utc", o.written_ns);
  a("source", o.source);
  a.known("sha256", o.sha256);
  a.time("start_utc", o.recorded.start_ns);
  a.time("end_utc", o.recorded.end_ns);
  a.known("vehicle", o.vehicle);
  a.known("truck", o.truck);
  if (a.has("load", !o.load.empty())) a("load", o.load);
  a.known("note", o.note);
  a("other_inputs", o.other_inputs);
}

template <class Archive>
void list_members(Archive&& a, Of<RunResult> auto& r) {
  if (a.has("schema", true)) list_members(a, r.origin);  // which runs of version 0.1.0 lack
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
  if (a.has("watched", !r.watched.empty())) a("watched", r.watched);
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
  // Beside parameters.json the explanation is a file of its own.
  if (result.origin.written_ns && !result.evidence.explanation.empty())
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

}  // namespace dampline::app
