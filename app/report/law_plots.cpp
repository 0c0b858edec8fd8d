// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

#include "app/report/plots.hpp"

namespace dampline::app {
namespace {

using svg::Ink;
using svg::Point;
using svg::Stroke;

/// The edges half-way between neighbours; the outermost cells are symmetric.
std::vector<double> cell_edges(const std::vector<CurveRow>& curve) {
  std::vector<double> edges;
  for (std::size_t i = 0; i + 1 < curve.size(); ++i)
    edges.push_back(0.5 * (curve[i].velocity_mps + curve[i + 1].velocity_mps));
  edges.insert(edges.begin(), 2.0 * curve.front().velocity_mps - edges.front());
  edges.push_back(2.0 * curve.back().velocity_mps - edges.back());
  return edges;
}

/// Below this speed the curve is not resolved: the law's width, seen from its middle to its flank.
double resolved_from_mps(const RunResult& result) {
  return 1.5 * estimate_of(result.parameters, "law_width").value;
}

/// What is drawn of a curve.
struct Branches {
  std::vector<CurveRow> negative;
  std::vector<CurveRow> positive;
};

/// The resolved part. Of two rows at 0, the first belongs to v < 0 and the second to v > 0.
Branches resolved(const std::vector<CurveRow>& curve, double from_mps) {
  Branches out;
  bool past_zero = false;
  for (const CurveRow& r : curve) {
    const bool positive = r.velocity_mps > 0.0 || past_zero;
    past_zero = past_zero || r.velocity_mps == 0.0;
    if (std::fabs(r.velocity_mps) < from_mps) continue;
    (positive ? out.positive : out.negative).push_back(r);
  }
  return out;
}

/// A branch, in mm/s and the plot's unit, `factor` with the sign under which it is seen.
void add_branch(const std::vector<CurveRow>& rows, double factor, const std::string& name,
                svg::Panel& panel) {
  std::vector<Point> middle;
  std::vector<Point> lower;
  std::vector<Point> upper;
  for (const CurveRow& r : rows) {
    const double v = 1e3 * r.velocity_mps;
    const double half = 2.0 * std::fabs(factor) * r.std_n;
    middle.push_back({v, factor * r.force_n});
    lower.push_back({v, factor * r.force_n - half});
    upper.push_back({v, factor * r.force_n + half});
  }
  panel.band(lower, upper, Ink::kBlue, name.empty() ? "" : "± 2 standard deviations");
  panel.dots(middle, Ink::kBlue, 2.0);
  panel.line(std::move(middle), {Ink::kBlue, 2.0}, name);
}

std::vector<Point> jump_of(const Branches& curve, double factor) {
  if (curve.negative.empty() || curve.positive.empty()) return {};
  const CurveRow& left = curve.negative.back();
  const CurveRow& right = curve.positive.front();
  return {{1e3 * left.velocity_mps, factor * left.force_n},
          {0.0, factor * left.force_n},
          {0.0, factor * right.force_n},
          {1e3 * right.velocity_mps, factor * right.force_n}};
}

std::vector<svg::Box> support_of(const std::vector<CurveRow>& curve) {
  constexpr double kBelowOne = 0.7;  // a logarithmic axis has no 0
  std::vector<CurveRow> cells;       // the two sides of the jump at 0 support no cell of their own
  std::copy_if(curve.begin(), curve.end(), std::back_inserter(cells),
               [](const CurveRow& r) { return r.velocity_mps != 0.0; });
  if (cells.size() < 2) return {};
  const std::vector<double> edges = cell_edges(cells);
  std::vector<svg::Box> boxes;
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (cells[i].samples > 0)
      boxes.push_back(
          {1e3 * edges[i], 1e3 * edges[i + 1], kBelowOne, static_cast<double>(cells[i].samples)});
  return boxes;
}

constexpr const char* kVelocityLabel = "relative velocity v (mm/s)";

}  // namespace

Plot plot_curve(const RunResult& result) {
  if (result.curve.empty()) return {};
  constexpr double kLowPanel = 130.0;
  const double fastest_mps = std::max(std::fabs(result.curve.front().velocity_mps),
                                      std::fabs(result.curve.back().velocity_mps));
  const double limit = 1.05e3 * fastest_mps;
  const PlotUnit unit = force_unit(result.curve, &CurveRow::force_n);
  const double from_mps = resolved_from_mps(result);
  // Where not one velocity is resolved, all are drawn, and the grey zone says so.
  const Branches drawn = resolved(result.curve, from_mps < fastest_mps ? from_mps : 0.0);
  const svg::Axis axis{kVelocityLabel, -limit, limit};
  svg::Panel force{axis, {fmt::format("damping force F ({})", unit.name)}};
  add_branch(drawn.negative, unit.factor, drawn.positive.empty() ? "damping force" : "", force);
  add_branch(drawn.positive, unit.factor, "damping force", force);
  force.line(jump_of(drawn, unit.factor), {Ink::kBlue, 1.5, true}, "jump");
  // The jump dwarfs everything else: the same curve against the direction of motion, enlarged.
  svg::Panel enlarged{axis, {fmt::format("F sign v ({})", unit.name)}, kLowPanel};
  enlarged.title("The same curve times the sign of v, enlarged");
  add_branch(drawn.negative, -unit.factor, "", enlarged);
  add_branch(drawn.positive, unit.factor, "", enlarged);
  if (from_mps > 0.0) force.zone(-1e3 * from_mps, 1e3 * from_mps, "not resolved");
  if (from_mps > 0.0) enlarged.zone(-1e3 * from_mps, 1e3 * from_mps, "");
  svg::Panel support{axis, {"samples", {}, {}, true}, kLowPanel};
  support.title("Samples that support each part");
  support.boxes(support_of(result.curve), Ink::kOrange);
  return {{force, enlarged, support}};
}

namespace {

/// F sign v of one method; nothing joins the branches.
template <class Value>
std::vector<Point> against_motion(const RunResult& result, double factor, Value value) {
  std::vector<Point> out;
  for (std::size_t i = 0; i < result.curve.size(); ++i) {
    const double v = result.curve[i].velocity_mps;
    out.push_back(v == 0.0 ? svg::kBreak : Point{1e3 * v, (v < 0.0 ? -factor : factor) * value(i)});
  }
  return out;
}

}  // namespace

Plot plot_methods(const RunResult& result) {
  if (result.methods.empty() || result.curve.empty()) return {};
  constexpr std::array kTrusted{Ink::kOrange, Ink::kGreen, Ink::kPink};
  const PlotUnit unit = force_unit(result.curve, &CurveRow::force_n);
  svg::Panel panel{{kVelocityLabel}, {fmt::format("F sign v ({})", unit.name), 0.0}};
  const auto along = [&](const auto& node, double deviations) {
    return against_motion(result, unit.factor, [&, deviations](std::size_t i) {
      const Estimate force_n = node(i);
      const double out = result.curve[i].velocity_mps < 0.0 ? -deviations : deviations;
      return force_n.value + out * force_n.std;
    });
  };
  // Each side by itself: a band is one outline.
  const auto draw_band = [&](const auto& node, Ink ink) {
    const std::vector<Point> lower = along(node, -2.0);
    const std::vector<Point> upper = along(node, 2.0);
    for (const double side : {-1.0, 1.0}) {
      std::array<std::vector<Point>, 2> of_side;
      for (std::size_t i = 0; i < lower.size(); ++i) {
        if (!(side * lower[i].x > 0.0)) continue;
        of_side[0].push_back(lower[i]);
        of_side[1].push_back(upper[i]);
      }
      panel.band(of_side[0], of_side[1], ink);
    }
  };
  const auto windows = [&](std::size_t i) {
    return Estimate{result.curve[i].force_n, result.curve[i].std_n};
  };
  draw_band(windows, Ink::kBlue);
  panel.line(along(windows, 0.0), {Ink::kBlue, 2.4}, "wavelet windows");
  std::size_t colour = 0;
  for (const MethodSummary& method : result.methods) {
    if (!method.has_level) continue;
    const auto node = [&](std::size_t i) { return method.curve_n.at(i); };
    const std::vector<Point> line = along(node, 0.0);
    const Ink ink = method.trusted ? kTrusted.at(colour++ % kTrusted.size()) : Ink::kGrey;
    if (method.trusted) draw_band(node, ink);
    panel.line(line, {ink, 2.0, !method.trusted},
               method.title + (method.trusted ? "" : " (not to be trusted)"));
    panel.dots(line, ink, 2.0);
  }
  return {{panel}};
}

Plot plot_law(const Evidence& evidence) {
  if (evidence.law.size() < 2) return {};
  const PlotUnit unit = force_unit(evidence.law, &LawRow::final_n);
  std::vector<Point> before;
  std::vector<Point> after;
  double last = evidence.law.front().velocity_mps;
  for (const LawRow& r : evidence.law) {
    if (last < 0.0 && r.velocity_mps > 0.0) {  // nothing joins the branches
      before.push_back(svg::kBreak);
      after.push_back(svg::kBreak);
    }
    last = r.velocity_mps;
    before.push_back({1e3 * r.velocity_mps, unit.factor * r.base_n});
    after.push_back({1e3 * r.velocity_mps, unit.factor * r.final_n});
  }
  svg::Panel panel{{"velocity v (mm/s)"}, {fmt::format("damping force F ({})", unit.name)}};
  panel.line(std::move(before), {Ink::kOrange, 2.0}, "before");
  panel.line(std::move(after), {Ink::kBlue, 2.4}, "after");
  return {{panel}};
}

}  // namespace dampline::app
