// SPDX-License-Identifier: MIT
#include "app/compare/compare.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "app/error.hpp"
#include "app/run/directory.hpp"
#include "app/run/json.hpp"
#include "app/run/state.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"

namespace dampline::app::compare {
namespace {

StatisticsHeader basis_of(const std::string& run) {
  const auto statistics = std::make_unique<Statistics>();
  load_state(std::filesystem::path{run} / "state.dls", *statistics);
  return statistics->header;
}

std::string kind_text(const RunResult& result) {
  if (result.row_method) return result.kind + "'s (--method wavelet)";
  return result.kind + "'s";
}

/// Why `other` cannot stand beside `first`; empty: it can.
std::string objection(const Run& first, const Run& other) {
  const RunResult& a = first.result;
  const RunResult& b = other.result;
  if (a.kind != b.kind || a.row_method.has_value() != b.row_method.has_value())
    return fmt::format("is a {} run, expected a {}", kind_text(b), kind_text(a));
  for (const Parameter& p : b.parameters)
    if (const Parameter* same = find_parameter(a.parameters, p.name);
        same != nullptr && same->unit != p.unit)
      return fmt::format("{} is in {}, expected {}", p.name, p.unit, same->unit);
  if (a.kind != "truck") return "";
  const double mass = first.config.car.moving_mass_kg;
  if (other.config.car.moving_mass_kg != mass)
    return fmt::format(
        "another mass: [car] moving_mass_kg is {}, expected {}: every force scales with it",
        other.config.car.moving_mass_kg, mass);
  const std::string basis = other_basis(basis_of(first.name), basis_of(other.name));
  return basis.empty() ? "" : "another basis: " + basis;
}

Run read_run(const std::string& name) {
  RunFiles files = read_files(name);
  Config config;
  try {
    config = parse_config(files.run_toml, (std::filesystem::path{name} / "run.toml").string());
  } catch (const UsageError& error) {
    throw RunError{error.what()};
  }
  return {name, std::move(files.result), std::move(config)};
}

}  // namespace

std::vector<Run> read_runs(const std::vector<std::string>& directories) {
  std::vector<Run> runs;
  for (const std::string& directory : directories) {
    runs.push_back(read_run(directory));
    const std::string why = objection(runs.front(), runs.back());
    if (!why.empty())
      throw RunError{
          fmt::format("{}: cannot be compared with {}: {}", directory, runs.front().name, why)};
  }
  return runs;
}

std::optional<Parameter> level_of(const RunResult& result) {
  if (const Parameter* common = find_parameter(result.parameters, "coulomb"); common != nullptr)
    return *common;
  const Parameter* forward = find_parameter(result.parameters, "coulomb_positive");
  const Parameter* back = find_parameter(result.parameters, "coulomb_negative");
  if (forward == nullptr || back == nullptr) return std::nullopt;
  return Parameter{"coulomb", 0.5 * (forward->value + back->value),
                   0.5 * std::hypot(forward->std, back->std), forward->unit};
}

std::optional<Parameter> stiffness_of(const RunResult& result) {
  const Parameter* found = find_parameter(result.parameters, "stiffness");
  return found == nullptr ? std::nullopt : std::optional{*found};
}

std::vector<Difference> differences(const RunResult& first, const RunResult& other) {
  std::vector<Difference> out;
  for (const Parameter& a : first.parameters) {
    const Parameter* b = find_parameter(other.parameters, a.name);
    if (b == nullptr) continue;
    const double value = b->value - a.value;
    const double std = std::hypot(a.std, b->std);
    out.push_back({a.name, a.unit, value, std, 100.0 * value / a.value, value / std});
  }
  return out;
}

std::vector<std::string> notes_on(const std::vector<Run>& runs) {
  std::vector<std::string> out;
  const Run& first = runs.front();
  for (const Run& run : runs) {
    const Origin& origin = run.result.origin;
    if (run.result.std_is_lower_bound)
      out.push_back(fmt::format("{}: its deviations are lower bounds.", run.name));
    if (&run == &first) continue;
    if (!origin.sha256.empty() && origin.sha256 == first.result.origin.sha256)
      out.push_back(fmt::format(
          "{}: of the same record as {}: their errors are the same, and deviations say nothing of "
          "the difference.",
          run.name, first.name));
    if (run.result.model != first.result.model)
      out.push_back(fmt::format("{}: another law than {}: what both have is a part of each.",
                                run.name, first.name));
  }
  return out;
}

namespace {

std::string quantity(const std::optional<Parameter>& p) {
  if (!p) return "";
  return quantity_text(p->value, p->std, p->unit);
}

/// To the second, which a reader can compare.
std::string start_text(const Origin& origin) {
  constexpr std::size_t kToTheSecond = 19;
  if (!origin.recorded.start_ns) return "";
  std::string text = utc_text(*origin.recorded.start_ns).substr(0, kToTheSecond);
  text[text.find('T')] = ' ';
  return text;
}

/// In the unit that the quantity itself, of about that size, is read in.
std::string difference_text(const Difference& d) {
  const ReadUnit unit = read_unit(d.unit, 100.0 * d.value / d.percent);
  const QuantityText text = format_quantity(unit.factor * d.value, unit.factor * d.std);
  const std::string size = text.value.starts_with('-') ? text.value : "+" + text.value;
  return fmt::format("{} {} ({:+.2g} %, {:+.1f} std)", size, unit.name, d.percent, d.deviations);
}

}  // namespace

std::vector<std::vector<std::string>> overview(const std::vector<Run>& runs) {
  std::vector<std::vector<std::string>> rows{
      {"run", "vehicle", "truck", "start (UTC)", "level", "stiffness", "law", "trust"}};
  for (const Run& run : runs) {
    const RunResult& r = run.result;
    rows.push_back({run.name, r.origin.vehicle, r.origin.truck, start_text(r.origin),
                    quantity(level_of(r)), quantity(stiffness_of(r)),
                    fmt::format("{}", fmt::join(r.model, ", ")), std::string{name_of(r.trust)}});
  }
  return rows;
}

std::vector<std::vector<std::string>> difference_table(const std::vector<Run>& runs) {
  std::vector<std::vector<std::string>> rows{{"run"}};
  for (const Parameter& p : runs.front().result.parameters) {
    const auto has = [&](const Run& run) {
      return find_parameter(run.result.parameters, p.name) != nullptr;
    };
    if (std::any_of(runs.begin() + 1, runs.end(), has)) rows.front().push_back(p.name);
  }
  if (rows.front().size() == 1) return {};
  for (const Run& run : std::vector<Run>(runs.begin() + 1, runs.end())) {
    std::vector<std::string>& row = rows.emplace_back(rows.front().size(), "");
    row.front() = run.name;
    for (const Difference& d : differences(runs.front().result, run.result)) {
      const auto column = std::find(rows.front().begin(), rows.front().end(), d.name);
      row[static_cast<std::size_t>(column - rows.front().begin())] = difference_text(d);
    }
  }
  return rows;
}

std::string to_text(const std::vector<Run>& runs) {
  std::string out = columns_text(overview(runs));
  if (const auto rows = difference_table(runs); !rows.empty())
    out += fmt::format("\nDifference to {}, and how many of its standard deviations it is:\n{}",
                       runs.front().name, columns_text(rows));
  for (const std::string& note : notes_on(runs)) out += "note: " + note + "\n";
  return out;
}

std::string to_json(const std::vector<Run>& runs) {
  using Json = nlohmann::ordered_json;
  Json list = Json::array();
  Json apart = Json::array();
  for (const Run& run : runs) {
    Json whole = Json::parse(to_json(run.result));
    Json& one = list.emplace_back(Json{{"run", run.name}});
    for (const char* key : {"source", "sha256", "start_utc", "end_utc", "vehicle", "truck", "note",
                            "kind", "model", "trust", "std_is_lower_bound", "parameters"})
      one[key] = whole[key];
    if (&run == &runs.front()) continue;
    Json parameters = Json::array();
    for (const Difference& d : differences(runs.front().result, run.result))
      parameters.push_back({{"name", d.name},
                            {"difference", d.value},
                            {"std", d.std},
                            {"unit", d.unit},
                            {"percent", d.percent},
                            {"deviations", d.deviations}});
    apart.push_back({{"run", run.name}, {"of", runs.front().name}, {"parameters", parameters}});
  }
  return json_text({{"schema", "dampline.comparison/1"},
                    {"runs", list},
                    {"differences", apart},
                    {"notes", notes_on(runs)}});
}

}  // namespace dampline::app::compare
