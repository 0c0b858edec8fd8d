// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "app/report/plots.hpp"

namespace dampline::app {
namespace {

using svg::Ink;
using svg::Point;

/// Over what the residual is seen.
struct Residue {
  std::string_view over;
  const char* label;
  double factor;
  bool mean;  // beside the rms
};
constexpr std::array kResidues{Residue{"deflection_m", "deflection y (mm)", 1e3, true},
                               Residue{"velocity_mps", "velocity v (mm/s)", 1e3, true},
                               Residue{"frequency_hz", "frequency (Hz)", 1.0, false},
                               Residue{"time_s", "time in the record (s)", 1.0, false}};

std::vector<Point> points_of(const Evidence& evidence, const Residue& residue, double factor,
                             double ResidualRow::*force) {
  std::vector<Point> out;
  for (const ResidualRow& r : evidence.residual)
    if (r.over == residue.over) out.push_back({residue.factor * r.place, factor * r.*force});
  return out;
}

}  // namespace

Plot plot_residual(const Evidence& evidence) {
  const PlotUnit unit = force_unit(evidence.residual, &ResidualRow::before_rms_n);
  Plot plot{{}, true};
  for (const Residue& residue : kResidues) {
    const auto points = [&](double ResidualRow::*force) {
      return points_of(evidence, residue, unit.factor, force);
    };
    if (points(&ResidualRow::before_rms_n).empty()) continue;
    svg::Panel panel{{residue.label, {}, {}, residue.over == "frequency_hz"},
                     {fmt::format("force left ({})", unit.name)}};
    panel.line(points(&ResidualRow::before_rms_n), {Ink::kOrange, 2.0}, "rms before");
    panel.line(points(&ResidualRow::after_rms_n), {Ink::kBlue, 2.0}, "rms after");
    if (residue.mean) {
      panel.line(points(&ResidualRow::before_mean_n), {Ink::kOrange, 1.4, true}, "mean before");
      panel.line(points(&ResidualRow::after_mean_n), {Ink::kBlue, 1.4, true}, "mean after");
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

Plot plot_loops(const Evidence& evidence) {
  if (evidence.loops.size() < 2) return {};
  const PlotUnit unit = force_unit(evidence.loops, &LoopRow::measured_n);
  double most = 0.0;
  double least = 0.0;
  for (const LoopRow& r : evidence.loops) {
    most = std::max({most, r.measured_n, r.base_n, r.final_n});
    least = std::min({least, r.measured_n, r.base_n, r.final_n});
  }
  Plot plot{{}, true};
  const auto add = [&](double LoopRow::*place, const char* label, double LoopRow::*model,
                       const svg::Stroke& stroke, const char* name) {
    std::vector<Point> measured;
    std::vector<Point> modelled;
    for (const LoopRow& r : evidence.loops) {
      measured.push_back({1e3 * r.*place, unit.factor * r.measured_n});
      modelled.push_back({1e3 * r.*place, unit.factor * r.*model});
    }
    svg::Panel panel{{label},
                     {fmt::format("force ({})", unit.name), 1.05 * unit.factor * least,
                      1.05 * unit.factor * most}};
    panel.line(std::move(measured), {Ink::kGrey, 3.0}, "measured");
    panel.line(std::move(modelled), stroke, name);
    plot.panels.push_back(std::move(panel));
  };
  for (const auto& [place, label] : {std::pair{&LoopRow::velocity_mps, "velocity v (mm/s)"},
                                     std::pair{&LoopRow::deflection_m, "deflection y (mm)"}}) {
    add(place, label, &LoopRow::base_n, {Ink::kOrange, 1.0}, "before");
    add(place, label, &LoopRow::final_n, {Ink::kBlue, 1.0}, "after");
  }
  return plot;
}

namespace {

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

Plot plot_prediction(const Evidence& evidence, std::uint32_t record) {
  const std::vector<PredictedRow> rows = stretch_of(evidence, record);
  if (rows.size() < 2) return {};
  const PlotUnit unit = force_unit(rows, &PredictedRow::measured_n);
  svg::Panel panel{{"time in the record (s)"}, {fmt::format("force ({})", unit.name)}};
  const auto add = [&](double PredictedRow::*force, const svg::Stroke& stroke, const char* name) {
    std::vector<Point> points;
    for (std::size_t i = 0; i < rows.size(); i += plot_stride(rows.size()))
      points.push_back({rows[i].time_s, unit.factor * rows[i].*force});
    panel.line(std::move(points), stroke, name);
  };
  add(&PredictedRow::measured_n, {Ink::kGrey, 3.0}, "measured");
  add(&PredictedRow::base_n, {Ink::kOrange, 1.0}, "before");
  if (std::any_of(rows.begin(), rows.end(),
                  [](const PredictedRow& r) { return std::isfinite(r.reference_n); }))
    add(&PredictedRow::reference_n, {Ink::kGreen, 1.0}, "reference");
  add(&PredictedRow::predicted_n, {Ink::kBlue, 1.2}, "after");
  return {{panel}};
}

}  // namespace dampline::app
