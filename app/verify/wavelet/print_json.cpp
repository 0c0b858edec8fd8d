// SPDX-License-Identifier: MIT
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/verify/wavelet/print.hpp"

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;

Json maybe(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }
Json finite(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json json_of(const Estimate& estimate, const char* spread) {
  return {{"method", estimate.method},
          {"value", finite(estimate.value)},
          {"error", finite(estimate.error)},
          {spread, finite(estimate.spread)},
          {"rows", estimate.rows},
          {"windows", estimate.windows},
          {"error_bound", finite(estimate.bound.error)},
          {std::string{spread} + "_bound", finite(estimate.bound.spread)},
          {"met", estimate.met()}};
}

Json json_of(const ParameterFigures& parameter) {
  const char* const spread = parameter.truth == 0.0 ? "std" : "cov";
  Json out{
      {"name", parameter.name},
      {"unit", parameter.unit},
      {"truth", parameter.truth},
      {"published",
       {{"value", maybe(parameter.published_value)}, {spread, maybe(parameter.published_spread)}}},
      {"estimates", Json::array()}};
  for (const Estimate& estimate : parameter.estimates)
    out["estimates"].push_back(json_of(estimate, spread));
  return out;
}

Json json_of(const CaseFigures& figures) {
  Json out{{"tables", figures.tables},         {"title", figures.title},
           {"conditions", figures.conditions}, {"notes", figures.notes},
           {"step_s", figures.step_s},         {"samples", figures.samples},
           {"parameters", Json::array()}};
  for (const ParameterFigures& parameter : figures.parameters)
    out["parameters"].push_back(json_of(parameter));
  return out;
}

Json json_of(const CheckGroup& group) {
  Json out{{"tables", group.tables},
           {"title", group.title},
           {"notes", group.notes},
           {"checks", Json::array()}};
  for (const Check& check : group.checks) {
    out["checks"].push_back({{"what", check.what},
                             {"unit", check.unit},
                             {"published", maybe(check.published)},
                             {"found", finite(check.found)},
                             {"at_most", maybe(check.at_most)},
                             {"at_least", maybe(check.at_least)},
                             {"met", check.met()}});
  }
  return out;
}

}  // namespace

std::string json_of(const WaveletFigures& figures) {
  const Tally count = tally(figures);
  Json out{{"subject", "wavelet"},
           {"bounds", count.bound},
           {"bounds_met", count.met},
           {"cases", Json::array()},
           {"groups", Json::array()}};
  for (const CaseFigures& one : figures.cases) out["cases"].push_back(json_of(one));
  for (const CheckGroup& group : figures.groups) out["groups"].push_back(json_of(group));
  return out.dump(2) + "\n";
}

}  // namespace dampline::app
