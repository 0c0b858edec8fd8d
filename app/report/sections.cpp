// SPDX-License-Identifier: MIT
#include "app/report/sections.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "app/report/html.hpp"
#include "app/text/meaning.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kShownStretches = 12;

std::string percent(double share) {
  const double value = 100.0 * share;
  return value < 100.0 ? fmt::format("{:.3g} %", value) : fmt::format("{:.0f} %", value);
}

std::string paragraph(const std::string& text) {
  return text.empty() ? "" : fmt::format("<p>{}</p>\n", escape_html(text));
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

std::vector<std::vector<std::string>> quality_rows(const RunResult& result) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* what, const std::optional<double>& value, const char* meaning) {
    if (value && std::isfinite(*value)) rows.push_back({what, percent(*value), meaning});
  };
  add("fit error (nmse)", result.fit.nmse, "share of the variance that the model does not explain");
  add("fit error (rrse)", result.fit.rrse, "its square root: relative size of what is left");
  add("held-out error (nmse)", result.fit.held_out_nmse,
      "the same on stretches that were not used for the fit");
  add("sticking", result.stick_share, "share of the moving time with |v| below 2 mm/s");
  add("excitation", result.excitation, "share of the record in which there was motion");
  if (result.sample_rate_hz)
    rows.push_back({"sample rate", fmt::format("{:.4f} Hz", result.sample_rate_hz->value),
                    "measured from the record's own time" +
                        (result.sample_rate_hz->std > 0.0
                             ? fmt::format(", ± {:.2g} Hz", result.sample_rate_hz->std)
                             : std::string{})});
  if (result.latency_s)
    rows.push_back({"latency", fmt::format("{:.2f} s", *result.latency_s),
                    "from a sample to its deflection and velocity"});
  rows.push_back({"length of the record", format_duration(result.duration_s), ""});
  return rows;
}

}  // namespace

std::string warning_section(const RunResult& result) {
  std::string out;
  for (const std::string& warning : result.warnings)
    out += fmt::format("<p class=\"warning\">{}</p>\n", escape_html(warning));
  if (result.std_is_lower_bound)
    out +=
        "<p class=\"warning\">The stated standard deviations are lower bounds: this record lies "
        "outside the range (sensor noise, sticking) in which they were validated.</p>\n";
  return out;
}

std::string parameter_section(const RunResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const Parameter& p : result.parameters) {
    const QuantityText text = format_quantity(p.value, p.std);
    const std::string relative =
        text.std.empty() || p.value == 0.0 ? "" : percent(p.std / std::fabs(p.value));
    rows.push_back({p.name, text.value, text.std.empty() ? "" : "± " + text.std, p.unit, relative,
                    meaning_of_parameter(p.name)});
  }
  return html_table({"parameter", "value", "standard deviation", "unit", "relative", "meaning"},
                    rows, 4) +
         fmt::format("<p class=\"note\">Model: {}.</p>\n", escape_html(joined(result.model)));
}

std::string quality_section(const RunResult& result) {
  std::string out = html_table({"", "", "meaning"}, quality_rows(result), 1);
  if (!result.asymmetry.empty()) out += paragraph("Asymmetry: " + result.asymmetry);
  if (result.notes.empty()) return out;
  out += "<ul>\n";
  for (const std::string& note : result.notes)
    out += fmt::format("<li>{}</li>\n", escape_html(note));
  return out + "</ul>\n";
}

std::string excluded_section(const RunResult& result) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, count] : result.counts)
    rows.push_back({meaning_of_count(name), format_count(count)});
  std::string out = result.excluded.empty() ? "<p>Nothing was left out.</p>\n" : "";
  if (!result.excluded.empty()) {
    std::vector<std::vector<std::string>> spans;
    for (std::size_t i = 0; i < std::min(kShownStretches, result.excluded.size()); ++i) {
      const Excluded& e = result.excluded[i];
      spans.push_back({fmt::format("{:.1f} s to {:.1f} s", e.start_s, e.end_s), e.reason});
    }
    out += html_table({"stretch of the record", "reason"}, spans, 0);
    const std::uint64_t more = result.excluded.size() - spans.size() + result.excluded_more;
    if (more > 0)
      out += fmt::format("<p class=\"note\">and {} more, listed in excluded.csv.</p>\n", more);
  }
  return out + html_table({"counted", ""}, rows, 1);
}

std::string provenance_section(const Provenance& provenance, const std::string& run_toml) {
  std::vector<std::vector<std::string>> rows;
  for (const InputFile& input : provenance.inputs)
    rows.push_back({input.role, input.name,
                    input.sha256.empty() ? "" : format_count(input.bytes) + " bytes",
                    input.sha256.empty() ? "no file: no checksum" : "sha256 " + input.sha256});
  return html_table({"input", "name", "size", "checksum"}, rows, 0) +
         fmt::format(
             "<p class=\"note\">dampline {}</p>\n<details><summary>Complete configuration "
             "(run.toml)</summary>\n<pre>{}</pre></details>\n",
             escape_html(provenance.version), escape_html(run_toml));
}

}  // namespace dampline::app
