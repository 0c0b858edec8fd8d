// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "app/report/evidence.hpp"
#include "app/report/plot_style.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kMaxPredicted = 3000;
constexpr double kShownS = 20.0;  // more is not seen

/// The liveliest stretch of a record.
std::vector<PredictedRow> stretch_of(const Evidence& evidence, std::uint32_t record) {
  std::vector<PredictedRow> all;
  for (const PredictedRow& r : evidence.prediction)
    if (r.record == record) all.push_back(r);
  if (all.empty()) return all;
  std::size_t best = 0;
  double most = -1.0;
  double sum = 0.0;
  for (std::size_t from = 0, to = 0; to < all.size(); ++to) {
    sum += all[to].measured_n * all[to].measured_n;
    for (; all[to].time_s - all[from].time_s > kShownS; ++from)
      sum -= all[from].measured_n * all[from].measured_n;
    if (sum <= most) continue;
    most = sum;
    best = from;
  }
  std::vector<PredictedRow> out;
  for (std::size_t i = best; i < all.size() && all[i].time_s - all[best].time_s <= kShownS; ++i)
    out.push_back(all[i]);
  return out;
}

}  // namespace

std::uint32_t predicted_records(const Evidence& evidence) {
  std::uint32_t out = 0;
  for (const PredictedRow& r : evidence.prediction) out = std::max(out, r.record);
  return out;
}

PlotScript plot_prediction(const Evidence& evidence, std::uint32_t record) {
  const std::vector<PredictedRow> rows = stretch_of(evidence, record);
  if (rows.size() < 2) return {};
  double largest = 0.0;
  bool reference = false;
  for (const PredictedRow& r : rows) {
    largest = std::max(largest, std::fabs(r.measured_n));
    reference = reference || std::isfinite(r.reference_n);
  }
  const PlotUnit unit = plot_unit("N", largest);
  const std::size_t stride = (rows.size() + kMaxPredicted - 1) / kMaxPredicted;
  std::string script = fmt::format(
      "{}set key at graph 1,graph 1.02 right bottom horizontal maxrows 1 samplen 2 noopaque\n"
      "set tmargin 2\nset datafile missing '?'\n$record << EOD\n",
      kPlotFrame);
  for (std::size_t i = 0; i < rows.size(); i += stride) {
    const PredictedRow& r = rows[i];
    fmt::format_to(
        std::back_inserter(script), "{} {} {} {} {}\n", r.time_s, unit.factor * r.measured_n,
        unit.factor * r.base_n, unit.factor * r.predicted_n,
        std::isfinite(r.reference_n) ? fmt::format("{}", unit.factor * r.reference_n) : "?");
  }
  script += fmt::format(
      "EOD\nset xlabel 'time in the record (s)'\nset ylabel 'force ({})' offset 0.5\n"
      "plot $record using 1:2 with lines lw 3 lc rgb '#bbbbbb' title 'measured', "
      "'' using 1:3 with lines lw 1 lc rgb '{}' title 'before'",
      unit.name, kPlotOrange);
  if (reference) script += ", '' using 1:5 with lines lw 1 lc rgb '#009e73' title 'reference'";
  script += fmt::format(", '' using 1:4 with lines lw 1.2 lc rgb '{}' title 'after'\n", kPlotBlue);
  return {script, 960, 380};
}

}  // namespace dampline::app
