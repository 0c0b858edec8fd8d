// SPDX-License-Identifier: MIT
#include "app/report/faults.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/report/html.hpp"
#include "app/report/plot_style.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
namespace {

std::string label_of(const FaultFinding& fault) {
  return plot_label(fault.name) + ", " + fault.channel;
}

std::string size_of(const FaultFinding& fault) {
  return fault.unit == "-" ? "" : fmt::format("{:.4g} {}", fault.size, fault.unit);
}

}  // namespace

PlotScript plot_faults(const RunResult& result) {
  const auto& faults = result.faults.list;
  if (faults.empty()) return {};
  std::string spans;
  std::string seen;
  std::string labels;
  for (std::size_t row = 0; row < faults.size(); ++row) {
    const FaultFinding& f = faults[row];
    const auto y = static_cast<double>(row);
    for (const Span& s : f.spans)
      spans += fmt::format("{} {} {} {} {} {}\n", 0.5 * (s.start_s + s.end_s), y, s.start_s,
                           s.end_s, y - 0.3, y + 0.3);
    seen += fmt::format("{} {} {} 0\n", f.time_s, y, f.last_s - f.time_s);
    labels += fmt::format("{}'{}' {}", row == 0 ? "" : ",", label_of(f), row);
  }
  std::string script = fmt::format("{}unset key\nset lmargin at screen 0.28\n", kPlotFrame);
  if (!spans.empty()) script += "$spans << EOD\n" + spans + "EOD\n";
  script += "$seen << EOD\n" + seen + "EOD\n";
  script += fmt::format(
      "set xrange [0:{}]\nset yrange [-0.6:{}]\nset ytics scale 0 ({})\nunset grid\n"
      "set xlabel 'time in the record (s)'\nset style fill solid 0.5 noborder\nplot ",
      std::max(result.duration_s, 1.0), static_cast<double>(faults.size()) - 0.4, labels);
  if (!spans.empty())
    script += fmt::format("$spans using 1:2:3:4:5:6 with boxxyerror lc rgb '{}', ", kPlotOrange);
  script += fmt::format(
      "$seen using 1:2:3:4 with vectors nohead lw 2 lc rgb '{0}', "
      "'' using 1:2 with points pt 7 ps 0.6 lc rgb '{0}'\n",
      kPlotBlue);
  return {script, 960, 90 + 34 * static_cast<int>(faults.size())};
}

std::string fault_section(const RunResult& result) {
  if (result.kind != "truck") return "";
  const DataFaults& faults = result.faults;
  std::string out;
  if (faults.list.empty()) {
    out = "<p>No fault of a sensor or of the transport was found.</p>\n";
  } else {
    std::vector<std::vector<std::string>> rows;
    for (const FaultFinding& f : faults.list)
      rows.push_back({plot_label(f.name), f.channel, fmt::format("{:.1f} s", f.time_s),
                      fmt::format("{:.1f} s", f.last_s), size_of(f), format_count(f.count)});
    out = html_table({"fault", "channel", "first seen", "last seen", "size", "times or blocks"},
                     rows, 0);
  }
  if (faults.drift)
    out +=
        fmt::format("<p class=\"warning\">{}.</p>\n", escape_html(describe_drift(*faults.drift)));
  return out + fmt::format(
                   "<p class=\"note\">Input, no faults: {} impacts (rail joints, wheel flats), {} "
                   "changes of speed.</p>\n",
                   format_count(faults.impacts), format_count(faults.speed_changes));
}

}  // namespace dampline::app
