// SPDX-License-Identifier: MIT
#include "app/text/summary.hpp"

#include <fmt/format.h>

#include <map>
#include <string_view>

#include "app/text/meaning.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
namespace {

/// Name, value, deviation, unit and a remark, in columns.
std::string estimate_line(std::string_view name, const Estimate& estimate, std::string_view unit,
                          std::string_view remark) {
  const QuantityText text = format_quantity(estimate.value, estimate.std);
  const std::string std = text.std.empty() ? "" : "± " + text.std;
  // The sign is two bytes wide and one column: pad by hand.
  const std::size_t columns = text.std.empty() ? 0 : text.std.size() + 2;
  return fmt::format("  {:<20} {:>14} {}{} {:<6} {}\n", name, text.value, std,
                     std::string(columns < 12 ? 12 - columns : 0, ' '), unit, remark);
}

std::string parameter_lines(const RunResult& result) {
  std::string out;
  for (const Parameter& p : result.parameters)
    out += estimate_line(p.name, {p.value, p.std}, p.unit, meaning_of_parameter(p.name));
  return out;
}

std::string verdict_on(const MethodSummary& method) {
  if (method.trusted) return "can be trusted here";
  std::string out = "not to be trusted here";
  for (const Objection& o : method.objections)
    out +=
        fmt::format("{} {}: {:.3g}{}{}, limit {:.3g}", &o == method.objections.data() ? ":" : ";",
                    o.reason, o.size, o.unit.empty() ? "" : " ", o.unit, o.limit);
  return out;
}

std::string method_lines(const RunResult& result) {
  std::string out;
  for (const MethodSummary& m : result.methods) {
    if (m.has_level)
      out += estimate_line(m.name, m.level_n, "N", verdict_on(m));
    else
      out += fmt::format("  {:<20} no level; {}\n", m.name, verdict_on(m));
  }
  return out;
}

std::string fit_line(const RunResult& result) {
  std::string out;
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) out += fmt::format("{}{} {:.3g}", out.empty() ? "" : ", ", name, *value);
  };
  add("nmse", result.fit.nmse);
  add("rrse", result.fit.rrse);
  add("held-out nmse", result.fit.held_out_nmse);
  return out.empty() ? "" : fmt::format("  {:<20} {}\n", "fit", out);
}

std::string excluded_line(const RunResult& result) {
  if (result.excluded.empty()) return fmt::format("  {:<20} nothing\n", "left out");
  std::map<std::string, double> seconds;
  for (const Excluded& e : result.excluded) seconds[e.reason] += e.end_s - e.start_s;
  std::string out;
  for (const auto& [reason, sum] : seconds)
    out += fmt::format("{}{} ({})", out.empty() ? "" : ", ", format_duration(sum), reason);
  if (result.excluded_more > 0) out += fmt::format(", and {} more stretches", result.excluded_more);
  return fmt::format("  {:<20} {}\n", "left out", out);
}

}  // namespace

std::string summarize(const RunResult& result) {
  std::string out = result.headline + "\n" + parameter_lines(result) + method_lines(result) +
                    fit_line(result) + excluded_line(result);
  if (!result.asymmetry.empty()) out += fmt::format("  {:<20} {}\n", "asymmetry", result.asymmetry);
  if (result.std_is_lower_bound)
    out += fmt::format("  {:<20} the stated deviations are lower bounds\n", "uncertainty");
  for (const std::string& warning : result.warnings)
    out += fmt::format("  {:<20} {}\n", "warning", warning);
  return out;
}

}  // namespace dampline::app
