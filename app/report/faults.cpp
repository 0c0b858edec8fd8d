// SPDX-License-Identifier: MIT
#include "app/report/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

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

std::size_t rank_of(const std::string& channel) {
  constexpr std::array<std::string_view, 5> kOrder{"frame", "wheelset1", "wheelset2", "wheelsets",
                                                   "all"};
  return static_cast<std::size_t>(std::find(kOrder.begin(), kOrder.end(), channel) -
                                  kOrder.begin());
}

/// One line of the figure: a fault of a channel, or a reason to leave blocks out.
struct Lane {
  std::string label;
  std::string size;
  std::vector<Span> spans;
  std::optional<Span> seen;
};

/// Channel by channel; below them what was left out of the estimate.
std::vector<Lane> lanes_of(const RunResult& result) {
  std::vector<const FaultFinding*> sorted;
  for (const FaultFinding& f : result.faults.list) sorted.push_back(&f);
  std::stable_sort(sorted.begin(), sorted.end(), [](const FaultFinding* a, const FaultFinding* b) {
    return rank_of(a->channel) < rank_of(b->channel);
  });
  std::vector<Lane> lanes;
  lanes.reserve(sorted.size() + result.excluded.size());
  for (const FaultFinding* f : sorted)
    lanes.push_back({label_of(*f), size_of(*f), f->spans, Span{f->time_s, f->last_s}});
  std::map<std::string, std::size_t> lane;
  for (const Excluded& e : result.excluded) {
    const auto [place, is_new] = lane.emplace(e.reason, lanes.size());
    if (is_new) lanes.push_back({"left out: " + plot_label(e.reason), "", {}, std::nullopt});
    lanes[place->second].spans.push_back({e.start_s, e.end_s});
  }
  return lanes;
}

}  // namespace

PlotScript plot_faults(const RunResult& result) {
  if (result.faults.list.empty()) return {};
  const std::vector<Lane> lanes = lanes_of(result);
  std::array<std::string, 2> spans;  // that faults spoil, and that were left out
  std::string seen;
  std::string ticks;
  std::string sizes;
  for (std::size_t row = 0; row < lanes.size(); ++row) {
    const Lane& lane = lanes[row];
    const auto y = static_cast<double>(lanes.size() - 1 - row);
    for (const Span& s : lane.spans)
      spans[lane.seen ? 0 : 1] += fmt::format("{} {} {} {} {} {}\n", 0.5 * (s.start_s + s.end_s), y,
                                              s.start_s, s.end_s, y - 0.3, y + 0.3);
    if (lane.seen)
      seen +=
          fmt::format("{} {} {} 0\n", lane.seen->start_s, y, lane.seen->end_s - lane.seen->start_s);
    ticks += fmt::format("{}'{}' {}", row == 0 ? "" : ",", lane.label, y);
    sizes +=
        fmt::format("set label '{}' at graph 1.01,first {} left tc rgb '#333333'\n", lane.size, y);
  }
  std::string script = fmt::format(
      "{}unset key\nset lmargin at screen 0.27\nset rmargin at screen 0.86\n{}", kPlotFrame, sizes);
  for (std::size_t i = 0; i < spans.size(); ++i)
    if (!spans[i].empty()) script += fmt::format("$spans{} << EOD\n{}EOD\n", i, spans[i]);
  script += fmt::format(
      "$seen << EOD\n{}EOD\nset xrange [0:{}]\nset yrange [-0.6:{}]\nset ytics scale 0 ({})\n"
      "unset grid\nset xlabel 'time in the record (s)'\nset style fill solid 0.6 noborder\nplot ",
      seen, std::max(result.duration_s, 1.0), static_cast<double>(lanes.size()) - 0.4, ticks);
  constexpr std::array<std::string_view, 2> kColours{kPlotOrange, "#888888"};
  for (std::size_t i = 0; i < spans.size(); ++i)
    if (!spans[i].empty())
      script +=
          fmt::format("$spans{} using 1:2:3:4:5:6 with boxxyerror lc rgb '{}', ", i, kColours[i]);
  script += fmt::format(
      "$seen using 1:2:3:4 with vectors nohead lw 2 lc rgb '{0}', "
      "'' using 1:2 with points pt 7 ps 0.6 lc rgb '{0}'\n",
      kPlotBlue);
  return {script, 960, 90 + 34 * static_cast<int>(lanes.size())};
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
  return out + fmt::format(
                   "<p class=\"note\">Input, no faults: {} impacts (rail joints, wheel flats), {} "
                   "changes of speed.</p>\n",
                   format_count(faults.impacts), format_count(faults.speed_changes));
}

}  // namespace dampline::app
