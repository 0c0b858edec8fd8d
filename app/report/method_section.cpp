// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "app/report/html.hpp"
#include "app/report/sections.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
namespace {

std::string with_unit(double value, const std::string& unit) {
  return fmt::format("{:.3g}{}{}", value, unit.empty() ? "" : " ", unit);
}

std::string objections_of(const MethodSummary& method) {
  std::string out;
  for (const Objection& o : method.objections)
    out += fmt::format("<li>{}: {}, limit {}</li>", escape_html(o.reason),
                       escape_html(with_unit(o.size, o.unit)),
                       escape_html(with_unit(o.limit, o.unit)));
  return out.empty() ? "" : "<ul>" + out + "</ul>";
}

std::string level_of(const MethodSummary& method) {
  if (!method.has_level) return "none";
  const QuantityText text = format_quantity(method.level_n.value, method.level_n.std);
  return fmt::format("{} ± {} N", text.value, text.std);
}

const Parameter* coulomb_of(const RunResult& result) {
  for (const Parameter& p : result.parameters)
    if (p.name == "coulomb") return &p;
  return nullptr;
}

std::string difference(const MethodSummary& method, const Parameter* coulomb) {
  if (!method.has_level || coulomb == nullptr || coulomb->value == 0.0) return "";
  return fmt::format("{:+.1f} %", 100.0 * (method.level_n.value / coulomb->value - 1.0));
}

}  // namespace

std::string method_section(const RunResult& result) {
  if (result.methods.empty()) return "";
  const Parameter* coulomb = coulomb_of(result);
  std::string out =
      "<table><tr><th>method</th><th class=\"number\">Coulomb level</th><th class=\"number\">"
      "against the wavelet windows</th><th>to be trusted here</th></tr>\n";
  for (const MethodSummary& m : result.methods)
    out += fmt::format(
        "<tr{}><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{}</td><td>{}{}</td>"
        "</tr>\n",
        m.trusted ? "" : " class=\"grey\"", escape_html(m.title), level_of(m),
        difference(m, coulomb), m.trusted ? "yes" : "no", objections_of(m));
  return out + "</table>\n";
}

}  // namespace dampline::app
