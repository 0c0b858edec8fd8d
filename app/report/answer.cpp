// SPDX-License-Identifier: MIT
#include "app/report/answer.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "app/report/html.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

namespace dampline::app {
namespace {

/// A name, what was found, and a remark; the last two as HTML.
std::string tile(std::string_view name, const std::string& value, const std::string& remark) {
  return fmt::format("<div><dt>{}</dt><dd class=\"value\">{}</dd>{}</div>\n", escape_html(name),
                     value, remark.empty() ? "" : fmt::format("<dd>{}</dd>", remark));
}

/// In which 19 of 20 truths lie.
std::string band_of(const Parameter& p, bool lower_bound) {
  if (!(p.std > 0.0) || !std::isfinite(p.std)) return "deviation not known";
  const ReadUnit unit = read_unit(p.unit, p.value);
  const auto end = [&](double deviations) {
    return format_quantity(unit.factor * (p.value + deviations * p.std), unit.factor * p.std).value;
  };
  return fmt::format("{} to {} {}{}", end(-2.0), end(2.0), unit.name,
                     lower_bound ? ", at least" : " in 19 of 20 cases");
}

struct Stated {
  std::string_view parameter;
  std::string_view name;
  std::string_view remark;  ///< of a truck's
};
constexpr std::array kStated{Stated{"coulomb", "Friction level", ""},
                             Stated{"coulomb_positive", "Friction level, v > 0", ""},
                             Stated{"coulomb_negative", "Friction level, v < 0", ""},
                             Stated{"stiffness", "Stiffness", "at one wheelset"},
                             Stated{"viscous", "Viscous damping", ""},
                             Stated{"moving_mass", "Moving mass", ""}};

std::string parameter_tiles(const RunResult& result) {
  std::string out;
  for (const Stated& stated : kStated)
    for (const Parameter& p : result.parameters) {
      if (p.name != stated.parameter) continue;
      if (result.trust != Trust::kTrusted) {
        out += tile(stated.name, "not stated", "not to be trusted here: see below");
        continue;
      }
      const bool says_where = result.kind == "truck" && !stated.remark.empty();
      out += tile(stated.name, escape_html(quantity_text(p.value, p.std, p.unit)),
                  escape_html(band_of(p, result.std_is_lower_bound)) +
                      (says_where ? fmt::format("; {}", stated.remark) : ""));
    }
  return out;
}

std::string trust_tile(const RunResult& result) {
  std::string reasons;
  for (const std::string& reason : result.trust_reasons)
    reasons += (reasons.empty() ? "" : "<br>") + escape_html(reason);
  return tile("Trust", plot_label(name_of(result.trust)),
              reasons.empty() ? "the data are sound and the model fits them" : reasons);
}

/// What the run's configuration states, where it is TOML at all.
toml::table settings(const std::string& run_toml) {
  try {
    return toml::parse(run_toml);
  } catch (const toml::parse_error&) {
    return {};
  }
}

std::string load_tile(const RunResult& result, const toml::table& run) {
  if (result.kind != "truck") return "";
  const std::optional<double> mass_kg = run["car"]["moving_mass_kg"].value<double>();
  if (!mass_kg || !std::isfinite(*mass_kg)) return "";
  return tile("Load", fmt::format("{:.4g} t", 1e-3 * *mass_kg),
              "mass moved at this truck, as stated");
}

/// Of the suspension, root mean square; from its density.
std::optional<double> rms_mmps(const RunResult& result) {
  for (const DensityTable& table : result.densities) {
    if (table.quantity != "velocity_mps") continue;
    double sum = 0.0;
    double second = 0.0;
    for (const DensityRow& r : table.rows) {
      sum += r.density;
      second += r.density * r.centre * r.centre;
    }
    if (sum > 0.0) return 1e3 * std::sqrt(second / sum);
  }
  return std::nullopt;
}

std::string speed_tile(const RunResult& result, const toml::table& run) {
  constexpr double kKmhOfMps = 3.6;
  const std::optional<double> car_mps = run["input"]["speed_mps"].value<double>();
  const std::optional<double> suspension = rms_mmps(result);
  const std::string moved = suspension ? fmt::format("{:.3g} mm/s", *suspension) : std::string{};
  if (result.kind == "truck" && car_mps && std::isfinite(*car_mps))
    return tile("Speed", fmt::format("{:.3g} km/h", kKmhOfMps * *car_mps),
                "of the car, as stated" +
                    (moved.empty() ? "" : fmt::format("; of the suspension {} rms", moved)));
  if (moved.empty()) return "";
  return tile("Speed", moved,
              result.kind == "truck" ? "of the suspension, rms; that of the car was not stated"
                                     : "of the motion, rms");
}

/// "2023-11-14 22:13:20".
std::string to_second(std::int64_t utc_since_1970_ns) {
  std::string text = utc_text(utc_since_1970_ns);
  text.resize(std::min(text.find('.'), text.size()));
  std::replace(text.begin(), text.end(), 'T', ' ');
  return text;
}

/// The day stands once where one is enough.
std::string span_of(std::int64_t start_ns, const std::optional<std::int64_t>& end_ns) {
  constexpr std::size_t kDay = 11;  // with the blank behind it
  std::string start = to_second(start_ns);
  if (!end_ns) return start;
  const std::string end = to_second(*end_ns);
  const bool same_day = start.substr(0, kDay) == end.substr(0, kDay);
  return start + " to " + (same_day ? end.substr(kDay) : end);
}

}  // namespace

std::string record_name(const Provenance& provenance) {
  if (provenance.inputs.empty()) return "";
  const std::string& path = provenance.inputs.front().name;
  const std::string name = std::filesystem::path{path}.filename();
  return name.empty() ? path : name;
}

std::string identity_section(const RunResult& result, const Provenance& provenance,
                             const std::string& run_toml) {
  const toml::table run = settings(run_toml);
  std::string out;
  const auto add = [&](std::string_view text) {
    if (!text.empty()) out += (out.empty() ? "" : " \u00b7 ") + escape_html(text);
  };
  for (const auto& [key, name] : {std::pair{"vehicle", "Vehicle"}, std::pair{"truck", "truck"}}) {
    const std::string word = run["record"][key].value_or(std::string{});
    if (!word.empty()) add(fmt::format("{} {}", name, word));
  }
  const RecordedSpan& when = result.origin.recorded;
  if (when.start_ns) add(span_of(*when.start_ns, when.end_ns) + " UTC");
  add(run["record"]["note"].value_or(std::string{}));
  return fmt::format("<h1>dampline: {}</h1>\n{}", escape_html(record_name(provenance)),
                     out.empty() ? "" : fmt::format("<p class=\"note\">{}</p>\n", out));
}

std::string answer_section(const RunResult& result, const std::string& run_toml) {
  const toml::table run = settings(run_toml);
  return fmt::format(
      "<p class=\"lead\">{}</p>\n<dl class=\"answer\">\n{}{}{}{}{}</dl>\n",
      escape_html(result.headline), parameter_tiles(result), trust_tile(result),
      load_tile(result, run), speed_tile(result, run),
      tile("Record", format_duration(result.duration_s), result.live ? "identified live" : ""));
}

}  // namespace dampline::app
