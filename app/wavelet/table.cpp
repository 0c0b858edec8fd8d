// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>

#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"
#include "app/wavelet/identify.hpp"

namespace dampline::app::wavelet {
namespace {

std::string number(double value, const char* unit = "") {
  return std::isfinite(value) ? fmt::format("{:.3g}{}", value, unit) : std::string{"-"};
}

std::string term_lines(const RunResult& result) {
  std::string out = fmt::format("  {:<28} {:>14} {:>12}  {:<12} {:>9} {:>10}\n", "term", "estimate",
                                "deviation", "unit", "t", "COV");
  for (std::size_t i = 0; i < result.parameters.size(); ++i) {
    const Parameter& p = result.parameters[i];
    const QuantityText text = format_quantity(p.value, p.std);
    out += fmt::format("  {:<28} {:>14} {:>12}  {:<12} {:>9} {:>10}\n", result.model[i], text.value,
                       text.std.empty() ? number(p.std) : text.std, p.unit, number(p.value / p.std),
                       number(p.cov));
  }
  return out;
}

std::string error_lines(const RowMethod& m) {
  std::string out;
  for (std::size_t d = 0; d < m.mse_percent.size(); ++d)
    out += fmt::format("  {:<28} fitted {}, held out {}\n",
                       m.mse_percent.size() == 1 ? "MSE" : fmt::format("MSE of mass {}", d + 1),
                       number(m.mse_percent[d], " %"), number(m.held_out_mse_percent[d], " %"));
  return out;
}

std::string set_lines(const RunResult& result) {
  if (result.term_sets.empty()) return "";
  std::string out =
      fmt::format("  {:<36} {:>9} {:>12} {:>12}\n", "term set", "t", "MSE", "held out");
  for (const TermSet& s : result.term_sets)
    out += fmt::format("  {:<36} {:>9} {:>12} {:>12}\n", s.change, number(s.t),
                       number(s.mse_percent, " %"), number(s.held_out_mse_percent, " %"));
  return out;
}

}  // namespace

std::string table_of(const RunResult& result) {
  std::string out = result.headline + "\n" + term_lines(result);
  if (result.row_method) {
    const RowMethod& m = *result.row_method;
    out += error_lines(m);
    if (m.gated && result.fit.nmse)
      out += fmt::format("  {:<28} {}: those across reversals too\n", "MSE of all rows",
                         number(100.0 * *result.fit.nmse, " %"));
    out += fmt::format("  {:<28} {}\n", "rows", describe_rows(result));
  }
  out += set_lines(result);
  out += fmt::format("  {:<28} {}\n", "trust", name_of(result.trust));
  for (const std::string& reason : result.trust_reasons)
    out += fmt::format("  {:<28} {}\n", "", reason);
  for (const std::string& text : result.warnings)
    out += fmt::format("  {:<28} {}\n", "warning", text);
  return out;
}

}  // namespace dampline::app::wavelet
