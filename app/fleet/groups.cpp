// SPDX-License-Identifier: MIT
#include "app/fleet/groups.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "app/compare/compare.hpp"
#include "app/error.hpp"
#include "app/run/json.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "drivers/text/quote.hpp"

namespace dampline::app::fleet {
namespace {

constexpr std::array<std::string_view, 4> kNames{"vehicle", "truck", "load", "month"};

std::string label_of(const StateAbout& about, By by) {
  constexpr std::size_t kToTheMonth = 7;
  switch (by) {
    case By::kVehicle:
      return about.segment.vehicle;
    case By::kTruck:
      return about.segment.truck;
    case By::kLoad:
      return about.load.empty() ? fmt::format("{:g} kg", about.moving_mass_kg) : about.load;
    case By::kMonth:
      return about.segment.start_ns == 0 ? ""
                                         : utc_text(about.segment.start_ns).substr(0, kToTheMonth);
  }
  return "";
}

/// A name that a directory may have, and a cell of a table.
std::string plain(const std::string& text) {
  return text.empty() ? "unknown" : without(text, "/. ,\"");
}

double hours(const RunResult& result) {
  constexpr double kHourS = 3600.0;
  return result.duration_s / kHourS;
}

}  // namespace

const char* name_of(By by) noexcept { return kNames[static_cast<std::size_t>(by)].data(); }

std::vector<By> parse_by(const std::string& words) {
  std::vector<By> out;
  std::string_view rest{words};
  while (!rest.empty()) {
    const std::string_view word = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    const auto* const found = std::find(kNames.begin(), kNames.end(), word);
    const auto by = static_cast<By>(found - kNames.begin());
    if (found == kNames.end() || std::find(out.begin(), out.end(), by) != out.end())
      throw UsageError{fmt::format("--by: found {}, expected some of {}, with commas between",
                                   drivers::quote(words), list_words(kNames))};
    out.push_back(by);
  }
  return out;
}

std::string Group::name() const {
  std::vector<std::string> names;
  names.reserve(labels.size());
  for (const std::string& label : labels) names.push_back(plain(label));
  return fmt::format("{}", fmt::join(names, "."));
}

std::vector<Group> group(std::vector<Leaf> leaves, const std::vector<By>& by) {
  std::map<std::vector<std::string>, std::vector<Leaf>> found;
  for (Leaf& leaf : leaves) {
    std::vector<std::string> labels;
    labels.reserve(by.size());
    for (const By key : by) labels.push_back(label_of(leaf.about, key));
    found[labels].push_back(std::move(leaf));
  }
  std::vector<Group> out;
  out.reserve(found.size());
  for (auto& [labels, list] : found) out.push_back({labels, std::move(list)});
  return out;
}

std::string to_text(const std::vector<By>& by, const std::vector<GroupRow>& rows) {
  std::vector<std::vector<std::string>> table(1);
  for (const By key : by) table.front().emplace_back(name_of(key));
  for (const char* head : {"segments", "record", "level", "stiffness", "trust", "run"})
    table.front().emplace_back(head);
  const auto quantity = [](const std::optional<Parameter>& p) {
    return p ? quantity_text(p->value, p->std, p->unit) : "";
  };
  for (const GroupRow& row : rows) {
    std::vector<std::string>& cells = table.emplace_back(row.labels);
    cells.insert(cells.end(),
                 {format_count(row.segments), format_duration(row.result.duration_s),
                  quantity(compare::level_of(row.result)),
                  quantity(compare::stiffness_of(row.result)), name_of(row.result.trust), row.run});
  }
  return columns_text(table);
}

std::string to_csv(const std::vector<By>& by, const std::vector<GroupRow>& rows) {
  std::string out;
  for (const By key : by) out += fmt::format("{},", name_of(key));
  out += "segments,duration_h,coulomb_n,coulomb_std_n,stiffness_npm,stiffness_std_npm,trust,run\n";
  for (const GroupRow& row : rows) {
    for (const std::string& label : row.labels) out += plain(label) + ",";
    const Parameter level = compare::level_of(row.result).value_or(Parameter{});
    const Parameter stiffness = compare::stiffness_of(row.result).value_or(Parameter{});
    out += fmt::format("{},{},{},{},{},{},{},{}\n", row.segments, hours(row.result), level.value,
                       level.std, stiffness.value, stiffness.std, name_of(row.result.trust),
                       plain(row.run));
  }
  return out;
}

std::string to_json(const std::vector<By>& by, const std::vector<GroupRow>& rows,
                    const std::vector<LeftOut>& left_out) {
  using Json = nlohmann::ordered_json;
  Json groups = Json::array();
  for (const GroupRow& row : rows) {
    Json& one = groups.emplace_back(Json::object());
    for (std::size_t i = 0; i < by.size(); ++i) one[name_of(by[i])] = row.labels[i];
    one["segments"] = row.segments;
    one["duration_s"] = row.result.duration_s;
    one["trust"] = name_of(row.result.trust);
    one["parameters"] = Json::array();
    for (const Parameter& p : row.result.parameters)
      one["parameters"].push_back(parameter_json(p.name, {p.value, p.std}, p.unit));
    one["run"] = row.run;
  }
  return json_text(
      {{"schema", "dampline.merge/1"}, {"groups", groups}, {"left_out", to_json(left_out)}});
}

}  // namespace dampline::app::fleet
