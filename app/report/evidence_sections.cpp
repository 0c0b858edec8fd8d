// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/error.hpp"
#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/text/format.hpp"

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Evidence& evidence) {
  Json json = Json::parse(evidence.explanation, nullptr, false);
  if (!json.is_object()) throw RunError{"explanation.json: is no JSON object"};
  return json;
}

double number_at(const Json& json, const char* key) {
  return json.contains(key) && json.at(key).is_number() ? json.at(key).get<double>() : 0.0;
}
std::string word_at(const Json& json, const char* key) {
  return json.contains(key) && json.at(key).is_string() ? json.at(key).get<std::string>() : "";
}
const Json& list_at(const Json& json, const char* key) {
  static const Json none = Json::array();
  return json.contains(key) && json.at(key).is_array() ? json.at(key) : none;
}

std::string joined(const Json& words) {
  std::string out;
  for (const Json& word : words)
    if (word.is_string()) out += (out.empty() ? "" : ", ") + plot_label(word.get<std::string>());
  return out;
}

std::string percent_of(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

std::vector<std::string> model_row(const char* name, const Json& model) {
  return {name, fmt::format("{:.4g}", number_at(model, "held_out_nmse")),
          fmt::format("{:.3f}", number_at(model, "held_out_rrse")),
          joined(list_at(model, "terms"))};
}

std::vector<Parameter> parameters_at(const Json& step) {
  std::vector<Parameter> out;
  for (const Json& p : list_at(step, "parameters"))
    out.push_back(
        {word_at(p, "name"), number_at(p, "value"), number_at(p, "std"), word_at(p, "unit")});
  return out;
}

std::string parameters_of(const Json& step) {
  std::string out;
  for (const Parameter& p : parameters_at(step))
    out += fmt::format("{}{} {}", out.empty() ? "" : "\n", plot_label(p.name),
                       quantity_text(p.value, p.std, p.unit));
  return out;
}

std::vector<std::string> candidate_row(int round, const Json& c, const std::string& verdict) {
  return {word_at(c, "effect"),
          fmt::format("{}", round),
          percent_of(number_at(c, "gain")),
          fmt::format("{:.1f}", number_at(c, "block_t")),
          fmt::format("{:.4g}", number_at(c, "held_out_nmse")),
          verdict};
}

/// The verdict as a sentence.
std::string verdict_words(const std::string& verdict, const std::string& effects) {
  if (verdict == "complete")
    return "The model is complete: no effect that was tried improves it, and what is left is no "
           "more "
           "than the sensors make.";
  if (verdict == "explained")
    return fmt::format(
        "The plain model lacked {}; with it, what is left is near what the sensors make.", effects);
  if (verdict == "partly_explained")
    return fmt::format(
        "The plain model lacked something like {}, and something real is still left.", effects);
  if (verdict == "unexplained") return "Something real is left that no effect explains.";
  if (verdict == "not_ready") return "The record is too short to say what the model lacks.";
  return fmt::format("Verdict: {}.", plot_label(verdict));
}

}  // namespace

Finding finding_of(const Evidence& evidence) {
  if (evidence.explanation.empty()) return {};
  const Json json = json_of(evidence);
  Finding out{word_at(json, "verdict"), {}, ""};
  for (const Json& step : list_at(json, "steps"))
    out.effects.push_back({word_at(step, "effect"), parameters_at(step)});
  if (json.contains("signature")) out.signature = word_at(json.at("signature"), "text");
  return out;
}

std::string explanation_headline(const Evidence& evidence) {
  const Json json = json_of(evidence);
  const Finding finding = finding_of(evidence);
  std::string effects;
  for (const LackingEffect& e : finding.effects)
    effects += (effects.empty() ? "" : ", ") + plot_label(e.name);
  std::string out = verdict_words(finding.verdict, effects.empty() ? "nothing" : effects);
  if (!json.contains("base") || !json.contains("final")) return out;
  const auto share = [&](const char* model) {  // in one piece: no line ends before the sign
    return fmt::format("{:.1f}\u00a0%", 100.0 * number_at(json.at(model), "held_out_rrse"));
  };
  out += " Error on held-out data: " + share("base") + " of the force";
  return out + (effects.empty() ? "." : " before, " + share("final") + " after.");
}

std::string verdict_section(const Evidence& evidence) {
  if (evidence.explanation.empty()) return "";
  const Json json = json_of(evidence);
  std::string out;
  if (json.contains("base") && json.contains("final"))
    out +=
        html_table({"model", "held-out nmse", "rrse", "terms"},
                   {model_row("before", json.at("base")), model_row("after", json.at("final"))}, 2);
  std::vector<std::vector<std::string>> rows;
  for (const Json& step : list_at(json, "steps"))
    rows.push_back(
        {plot_label(word_at(step, "effect")), parameters_of(step), word_at(step, "note")});
  const bool remarked =
      std::any_of(rows.begin(), rows.end(), [](const auto& row) { return !row[2].empty(); });
  if (!rows.empty()) out += html_table({"effect", "parameters", remarked ? "remark" : ""}, rows, 0);
  const double floor = number_at(json, "floor_nmse");
  if (floor > 0.0 && json.contains("final"))
    out += fmt::format(
        "<p>A complete model would leave an nmse of {:.4g} ({}): what is left is {:.2f} times "
        "that.</p>\n",
        floor, escape_html(word_at(json, "floor_by")), number_at(json, "left_over_floor"));
  if (json.contains("signature") && !word_at(json.at("signature"), "text").empty())
    out += fmt::format("<p>What is left: {}.</p>\n",
                       escape_html(word_at(json.at("signature"), "text")));
  return out;
}

std::string candidate_section(const Evidence& evidence) {
  if (evidence.explanation.empty()) return "";
  const Json json = json_of(evidence);
  std::vector<std::vector<std::string>> rows;
  int round = 0;
  for (const Json& step : list_at(json, "steps")) {
    if (!step.contains("evidence") || !step.at("evidence").contains("gain")) continue;
    Json chosen = step.at("evidence");
    chosen["effect"] = word_at(step, "effect");
    chosen["held_out_nmse"] = number_at(step, "held_out_nmse_after");
    rows.push_back(candidate_row(++round, chosen, "added"));
    for (const Json& c : list_at(step, "runners_up"))
      rows.push_back(candidate_row(round, c, "explains less"));
  }
  ++round;
  for (const Json& c : list_at(json, "rejected"))
    rows.push_back(candidate_row(round, c, "not enough to be added"));
  if (rows.empty()) return "";
  return html_table({"candidate", "round", "gain", "significance t", "held-out nmse", "verdict"},
                    rows, 4);
}

std::string validation_section(const Evidence& evidence) {
  if (evidence.explanation.empty()) return "";
  std::vector<std::vector<std::string>> rows;
  bool reference = false;
  std::string starts;
  const Json json = json_of(evidence);
  for (const Json& v : list_at(json, "validation")) {
    const bool has = v.contains("rrse_reference");
    reference = reference || has;
    if (v.contains("start_slip_m"))
      starts += fmt::format("{}{:.1f} mm", starts.empty() ? "" : ", ",
                            1e3 * number_at(v, "start_slip_m"));
    rows.push_back({word_at(v, "record"), fmt::format("{:.3f}", number_at(v, "rrse_before")),
                    fmt::format("{:.3f}", number_at(v, "rrse_after")),
                    has ? fmt::format("{:.3f}", number_at(v, "rrse_after_where_reference")) : "",
                    has ? fmt::format("{:.3f}", number_at(v, "rrse_reference")) : ""});
  }
  if (rows.empty()) return "";
  std::vector<std::string> header{"record", "rrse before", "rrse after",
                                  "after, where there is a reference", "reference"};
  if (!reference) {
    header.resize(3);
    for (auto& row : rows) row.resize(3);
  }
  std::string out = html_table(header, rows, header.size() - 1);
  if (!starts.empty())
    out += fmt::format(
        "<p>Where in its play the rig stands at the start is unknown: the first second of measured "
        "force sets it ({}), and nothing else is taken from the force.</p>\n",
        starts);
  return out;
}

}  // namespace dampline::app
