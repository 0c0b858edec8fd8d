// SPDX-License-Identifier: MIT
#include "app/report/sections.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>

#include "app/law/document.hpp"
#include "app/report/html.hpp"
#include "app/report/phase_plot.hpp"
#include "app/report/plots.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"

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
    out += fmt::format(
        "<p class=\"warning\">The stated standard deviations are lower bounds: {}.</p>\n",
        result.trust == Trust::kTrusted
            ? "this record lies outside the range (sensor noise, sticking) in which they were "
              "validated"
            : "they are of the noise alone, and the result is not to be trusted");
  return out;
}

namespace {

std::string law_table(const std::vector<Parameter>& parameters,
                      const std::vector<std::string>& model) {
  std::vector<std::vector<std::string>> rows;
  for (const Parameter& p : parameters) {
    const bool has_std = p.std > 0.0 && std::isfinite(p.std) && p.value != 0.0;
    rows.push_back({p.name, quantity_text(p.value, p.std, p.unit),
                    has_std ? percent(p.std / std::fabs(p.value)) : "",
                    meaning_of_parameter(p.name)});
  }
  return html_table({"parameter", "value ± standard deviation", "relative", "meaning"}, rows, 2) +
         fmt::format("<p class=\"note\">Model: {}.</p>\n", escape_html(joined(model)));
}

}  // namespace

std::string parameter_section(const RunResult& result) {
  return law_table(result.parameters, result.model);
}

std::string base_section(const RunResult& result) {
  return result.base ? law_table(result.base->parameters, result.base->model) : "";
}

namespace {

/// "a3 = a4" of an unknown that terms share.
std::string names_of(const law::Unknown& u) {
  if (u.terms.empty()) return u.name;
  std::string out;
  for (const std::size_t t : u.terms)
    out += fmt::format("{}{}{}", out.empty() ? "" : " = ", u.name.front(), t + 1);
  return out;
}

/// "a1", not that of "a12".
bool is_in(const std::string& equation, const std::string& name) {
  for (auto at = equation.find(name); at != std::string::npos; at = equation.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if (end == equation.size() || std::isdigit(static_cast<unsigned char>(equation[end])) == 0)
      return true;
  }
  return false;
}

/// What the equation names, a in its u too, and nobody identified.
std::string given_text(const law::Document& d) {
  using Part = law::Unknown::Part;
  const std::string equation = d.equation();
  std::vector<std::string> given;
  const auto is_unknown = [&](Part part, std::size_t term) {
    return std::any_of(d.unknowns.begin(), d.unknowns.end(), [&](const law::Unknown& u) {
      return u.part == part && (part == Part::kMass ||
                                std::find(u.terms.begin(), u.terms.end(), term) != u.terms.end());
    });
  };
  const auto add = [&](const std::string& name, double value, const char* unit) {
    if (is_in(equation, name) || (name[0] == 'a' && is_in(equation, "u" + name.substr(1))))
      given.push_back(fmt::format("{} = {}", name, quantity_text(value, 0.0, unit)));
  };
  if (d.law.mass_kg > 0.0 && !is_unknown(Part::kMass, 0)) add("m", d.law.mass_kg, "kg");
  for (std::size_t i = 0; i < d.law.terms.size(); ++i) {
    const law::Regressor& c = d.law.terms[i].column;
    const law::TermText& text = law::text_of(c.kind);
    if (!is_unknown(Part::kA, i)) add(fmt::format("a{}", i + 1), c.a, text.unit_a);
    if (!is_unknown(Part::kB, i)) add(fmt::format("b{}", i + 1), c.b, text.unit_b);
  }
  return given.empty() ? "" : "Given: " + joined(given) + ".";
}

/// What the law leaves of the record that it was found from.
std::string left_text(const law::Document& d) {
  std::string out;
  const auto add = [&](double value, const char* unit, const std::string& of) {
    const ReadUnit read = read_unit(unit, value);
    if (value > 0.0)
      out += fmt::format("{}{:.3g} {} rms of {}", out.empty() ? "It leaves " : ", ",
                         read.factor * value, read.name, of);
  };
  add(d.residual_n, "N",
      d.filter_hz > 0.0 ? fmt::format("the force behind a low pass of {:.3g} Hz", d.filter_hz)
                        : std::string{"the force"});
  add(d.residual_m, "m", "the motion when the force alone moves the mass");
  if (d.free_run) add(d.free_run->residual_m, "m", "that motion by the figures for a free run");
  add(d.residual_mps2, "m/s^2", "the frame's acceleration");
  return out.empty() ? "" : out + ".";
}

}  // namespace

std::string law_section(const RunResult& result) {
  if (result.law.empty()) return "";
  const law::Document d = law::read_document(result.law, "law.json");
  const law::Document moves = d.for_free_run();
  std::vector<std::string> header{"unknown", "value ± standard deviation"};
  if (d.free_run) header.emplace_back("for a free run");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < d.unknowns.size(); ++i) {
    rows.push_back({names_of(d.unknowns[i]), d.text_of(i)});
    if (d.free_run) rows.back().push_back(moves.text_of(i));
  }
  std::string out = fmt::format("<p><code>{}</code></p>\n", escape_html(d.equation()));
  out += html_table(header, rows, header.size() - 1);
  out += paragraph(given_text(d));
  out += paragraph(left_text(d));
  if (!d.not_in_it.empty()) out += paragraph("Not in it: " + joined(d.not_in_it) + ".");
  const bool remembers = !law::memories_of(d.law).empty();
  return out +
         paragraph(fmt::format(
             "v = x'{}. law.json holds it with its covariance; dampline predict gives what it "
             "does under another input.",
             remembers ? ", u = z / a, and z follows x within -a and a" : ""));
}

std::string quality_section(const RunResult& result) {
  std::string out = html_table({"", "value", "meaning"}, quality_rows(result), 1);
  if (!result.asymmetry.empty()) out += paragraph("Asymmetry: " + result.asymmetry);
  if (result.notes.empty()) return out;
  out += "<ul>\n";
  for (const std::string& note : result.notes)
    out += fmt::format("<li>{}</li>\n", escape_html(note));
  return out + "</ul>\n";
}

std::string excluded_section(const RunResult& result) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::vector<std::string>> zeros;
  for (const auto& [name, count] : result.counts)
    (count > 0 ? rows : zeros).push_back({meaning_of_count(name), format_count(count)});
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
  if (!rows.empty()) out += html_table({"counted", "number"}, rows, 1);
  if (zeros.empty()) return out;
  return out + html_details(fmt::format("{} counters that are 0", zeros.size()),
                            html_table({"counted", "number"}, zeros, 1));
}

std::string provenance_section(const Provenance& provenance, const std::string& run_toml) {
  std::vector<std::vector<std::string>> rows;
  for (const InputFile& input : provenance.inputs)
    rows.push_back({input.role, input.name,
                    input.sha256.empty() ? "" : format_count(input.bytes) + " bytes",
                    input.sha256.empty() ? "no file: no checksum" : "sha256 " + input.sha256});
  return html_table({"input", "name", "size", "checksum"}, rows, 0) +
         fmt::format("<p class=\"note\">dampline {}</p>\n", escape_html(provenance.version)) +
         html_details("Complete configuration (run.toml)",
                      fmt::format("<pre>{}</pre>", escape_html(run_toml)));
}

namespace {

std::string with_unit(double value, const std::string& unit) {
  return fmt::format("{:.3g}{}{}", value, unit.empty() ? "" : " ", unit);
}

/// The verdict, and below it what the record contradicts, a line each.
std::string objections_of(const MethodSummary& method) {
  std::string out = method.trusted ? "yes" : "no";
  for (const Objection& o : method.objections)
    out += fmt::format("\n{}: {}, limit {}", o.reason, with_unit(o.size, o.unit),
                       with_unit(o.limit, o.unit));
  return out;
}

std::string level_of(const MethodSummary& method) {
  if (!method.has_level) return "none";
  const QuantityText text = format_quantity(method.level_n.value, method.level_n.std);
  return fmt::format("{} ± {} N", text.value, text.std);
}

std::string difference(const MethodSummary& method, const Parameter* coulomb) {
  if (!method.has_level || coulomb == nullptr || coulomb->value == 0.0) return "";
  return fmt::format("{:+.1f} %", 100.0 * (method.level_n.value / coulomb->value - 1.0));
}

}  // namespace

std::string method_section(const RunResult& result) {
  if (result.methods.empty()) return "";
  const Parameter* coulomb = find_parameter(result.parameters, "coulomb");
  std::vector<std::vector<std::string>> rows;
  std::vector<bool> grey;
  for (const MethodSummary& m : result.methods) {
    rows.push_back({m.title, level_of(m), difference(m, coulomb), objections_of(m)});
    grey.push_back(!m.trusted);
  }
  return html_table(
      {"method", "Coulomb level", "against the wavelet windows", "to be trusted here"}, rows, 2,
      grey);
}

namespace {

std::string mebibytes(std::uint64_t bytes) {
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1024.0 * 1024.0));
}

}  // namespace

std::string live_section(const RunResult& result) {
  const auto is_zero = [](const auto& row) { return row[1] == "0" || row[1] == "0 + 0"; };
  if (!result.live) return "";
  const LiveFigures& f = *result.live;
  const std::string lateness =
      fmt::format("{} / {} / {} / {} / {}", format_microseconds(f.lateness_p50_us),
                  format_microseconds(f.lateness_p90_us), format_microseconds(f.lateness_p99_us),
                  format_microseconds(f.lateness_p999_us), format_microseconds(f.lateness_max_us));
  std::vector<std::vector<std::string>> rows{
      {"lateness", lateness,
       "from a frame's stamp to its result: p50 / p90 / p99 / p99.9 / largest"},
      {"cycle slips", format_count(f.cycle_slips),
       "frames later than one sampling period; no result depends on it"},
      {"page faults", fmt::format("{} + {}", f.minor_faults, f.major_faults),
       "minor + major, of the acquisition after its warm-up"},
      {"memory locked", f.memory_locked ? "yes" : "no", ""},
      {"real-time scheduling", f.realtime_scheduled ? "yes" : "no", ""},
      {"recorded", mebibytes(f.recorded_bytes), "in the black box"},
      {"records lost", format_count(f.records_lost), "that the black box could not take"},
      {"publications failed", format_count(f.publish_failures), "of live.json"}};
  if (f.first_sample_s)
    rows.push_back({"first sample", fmt::format("{:.3f} s", *f.first_sample_s),
                    "after the start of the program"});
  std::vector<std::vector<std::string>> zeros;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(zeros), is_zero);
  std::erase_if(rows, is_zero);
  std::string out = html_table({"", "value", "meaning"}, rows, 1);
  if (zeros.empty()) return out;
  return out + html_details(fmt::format("{} counters that are 0", zeros.size()),
                            html_table({"", "value", "meaning"}, zeros, 1));
}

namespace {

constexpr std::string_view kPhaseText =
    "How often the motion passed each place of the extended phase space (y, y', y''), seen along "
    "its three axes; the shade follows the root of the density. Points are stroboscopic (Poincare) "
    "sections.";

}  // namespace

std::string phase_section(const RunResult& result) {
  if (!result.phase) return "";
  return figure(plot_phase(*result.phase), "phase",
                fmt::format("{} {}", kPhaseText, describe_period(*result.phase)));
}

std::string fault_section(const RunResult& result) {
  const DataFaults& faults = result.faults;
  const bool truck = result.kind == "truck";
  if (!truck && faults.list.empty()) return "";
  std::string out;
  if (faults.list.empty()) {
    out = "<p>No fault of a sensor or of the transport was found.</p>\n";
  } else {
    std::vector<std::vector<std::string>> rows;
    for (const FaultFinding& f : faults.list)
      rows.push_back({plot_label(f.name), f.channel, fmt::format("{:.1f} s", f.time_s),
                      fmt::format("{:.1f} s", f.last_s), fault_size(f), format_count(f.count)});
    out = html_table({"fault", "channel", "first seen", "last seen", "size", "times or blocks"},
                     rows, 0);
  }
  if (faults.drift)
    out +=
        fmt::format("<p class=\"warning\">{}.</p>\n", escape_html(describe_drift(*faults.drift)));
  for (const AlarmFinding& alarm : faults.alarms)
    out += fmt::format("<p class=\"warning\">Alarm: {}.</p>\n", escape_html(describe_alarm(alarm)));
  if (result.live)
    out += fmt::format("<p class=\"note\">Live alarm: {}; {}.</p>\n",
                       faults.alarms.empty() ? "none" : format_count(faults.alarms.size()),
                       escape_html(describe_alarm_figures()));
  if (faults.values_replaced + faults.samples_spoilt > 0)
    out += fmt::format(
        "<p class=\"note\">Because of these, {} single values were replaced by what their "
        "neighbours say and {} samples left out.</p>\n",
        format_count(faults.values_replaced), format_count(faults.samples_spoilt));
  if (faults.values_bridged > 0)
    out += fmt::format(
        "<p class=\"note\">{} single values were missing and were put in from what the channel did "
        "around them.</p>\n",
        format_count(faults.values_bridged));
  if (faults.placed_s > 0.0)
    out += fmt::format(
        "<p class=\"note\">Samples were taken at uneven times ({:.2g} ms rms) and were put at even "
        "ones by their own stamps.</p>\n",
        1e3 * faults.placed_s);
  if (!truck) return out;
  return out + fmt::format(
                   "<p class=\"note\">Input, no faults: {} impacts (rail joints, wheel flats), {} "
                   "changes of speed.</p>\n",
                   format_count(faults.impacts), format_count(faults.speed_changes));
}

}  // namespace dampline::app
