// SPDX-License-Identifier: MIT
#include "app/verify/phase/pictures.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "app/verify/printed/printed.hpp"
#include "dampline/numeric/cholesky.hpp"

namespace dampline::app {
namespace {

using sim::StrobedPoint;
using Three = Eigen::Vector3d;

constexpr int kPhasesDrawn = 120;  // points of a period on a trajectory

/// One drive and 16 starts: every section is at the same input.
std::vector<StrobedPoint> trajectories(const sim::OscillatorLaw& law) {
  return sim::strobe(law, {.regimes = {{0.5, 3.0, 0.8, 0.0}},
                           .phases = kPhasesDrawn,
                           .periods = 4,
                           .skipped_periods = 0,
                           .steps_per_flash = 8,
                           .start_spread = 3.0,
                           .starts = 16,
                           .seed = 2200});
}

struct PlaneFit {
  Three coefficients = Three::Zero();  ///< a = c0 + c1 y + c2 v
  double off{0.0};                     ///< rms distance over rms a
  [[nodiscard]] double at(const PhasePoint& p) const {
    return coefficients.dot(Three{1.0, p.deflection_m, p.velocity_mps});
  }
};

PlaneFit fit_plane(const std::vector<PhasePoint>& section) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Three right = Three::Zero();
  for (const PhasePoint& p : section) {
    const Three row{1.0, p.deflection_m, p.velocity_mps};
    gram += row * row.transpose();
    right += row * p.accel_mps2;
  }
  PlaneFit fit;
  Cholesky<3> cholesky;
  if (!cholesky.factor(gram, 3)) return fit;
  cholesky.solve(right);
  fit.coefficients = right;
  double left = 0.0;
  double all = 0.0;
  for (const PhasePoint& p : section) {
    left += std::pow(p.accel_mps2 - fit.at(p), 2);
    all += p.accel_mps2 * p.accel_mps2;
  }
  fit.off = std::sqrt(left / all);
  return fit;
}

struct Channel {
  const char* label;
  double PhasePoint::*of;
};
constexpr Channel kDeflection{"y (m)", &PhasePoint::deflection_m};
constexpr Channel kVelocity{"y' (m/s)", &PhasePoint::velocity_mps};
constexpr Channel kAccel{"y'' (m/s²)", &PhasePoint::accel_mps2};

/// A trajectory of the first starts as lines, the section of all of them as dots.
svg::Panel plane(const std::vector<StrobedPoint>& points, const std::vector<PhasePoint>& section,
                 const Channel& x, const Channel& y) {
  constexpr int kDrawnStarts = 3;
  constexpr double kSquare = 320.0;
  svg::Panel panel{{x.label}, {y.label}, kSquare};
  std::vector<svg::Point> path;
  int regime = 0;
  for (const StrobedPoint& p : points) {
    if (p.regime >= kDrawnStarts) break;
    if (p.regime != regime) path.push_back(svg::kBreak);
    regime = p.regime;
    path.push_back({p.point.*x.of, p.point.*y.of});
  }
  std::vector<svg::Point> dots;
  dots.reserve(section.size());
  for (const PhasePoint& p : section) dots.push_back({p.*x.of, p.*y.of});
  panel.line(std::move(path), {svg::Ink::kBlue, 1.0}, "trajectories");
  panel.dots(std::move(dots), svg::Ink::kOrange, 2.6, "section");
  return panel;
}

svg::Panel along_plane(const std::vector<PhasePoint>& section, const PlaneFit& fit) {
  constexpr double kSquare = 320.0;
  svg::Panel panel{{"y'' of the best plane (m/s²)"}, {kAccel.label}, kSquare};
  std::vector<svg::Point> dots;
  double low = 0.0;
  double high = 0.0;
  for (const PhasePoint& p : section) {
    dots.push_back({fit.at(p), p.accel_mps2});
    low = std::min(low, fit.at(p));
    high = std::max(high, fit.at(p));
  }
  panel.line({{low, low}, {high, high}}, {svg::Ink::kGrey, 1.5, true}, "plane");
  panel.dots(std::move(dots), svg::Ink::kOrange, 2.6, "section, seen along the plane");
  return panel;
}

PhasePictures pictures_of(const std::string& name, const sim::OscillatorLaw& law) {
  const std::vector<StrobedPoint> points = trajectories(law);
  std::vector<PhasePoint> section;
  for (const StrobedPoint& p : points)
    if (p.phase == 0 && !p.sticks && p.point.velocity_mps != 0.0) section.push_back(p.point);
  const PlaneFit fit = fit_plane(section);
  return {
      name,
      fit.off,
      section.size(),
      {{plane(points, section, kDeflection, kVelocity), plane(points, section, kDeflection, kAccel),
        plane(points, section, kVelocity, kAccel), along_plane(section, fit)},
       true}};
}

std::vector<double> printed_inputs(const char* row) {
  const PrintedTable& printed = printed_table(phase_mappings(), "inputs");
  std::vector<double> out;
  out.reserve(printed.columns.size());
  for (const std::string& column : printed.columns) out.push_back(printed.at(row, column).value);
  return out;
}

constexpr std::array kInks{svg::Ink::kBlue, svg::Ink::kGreen, svg::Ink::kPink};

double published_friction(double deflection_m) {
  return std::abs(1.0 + deflection_m / kStudyReversalM);
}

/// What is found less `of` it, over the nodes that are resolved, broken where one is not.
template <class Of>
void add_curve(const std::string& name, const FrictionStudy& study, svg::Ink ink, const Of& of,
               svg::Panel& panel) {
  constexpr double kTwice = 2.0;
  std::vector<svg::Point> found;
  std::vector<svg::Point> lower;
  std::vector<svg::Point> upper;
  for (const FrictionNode& node : study.curve.nodes) {
    if (!node.resolved) {
      found.push_back(svg::kBreak);
      continue;
    }
    const Estimate& g = node.friction_mps2;
    const double value = g.value - of(node.deflection_m);
    found.push_back({node.deflection_m, value});
    lower.push_back({node.deflection_m, value - kTwice * g.std});
    upper.push_back({node.deflection_m, value + kTwice * g.std});
  }
  panel.band(lower, upper, ink);
  panel.line(found, {ink, 1.5}, name);
  panel.dots(found, ink, 2.6);
}

/// A family's curves less `of`; what is left of the published law is the dashed line.
template <class Of>
svg::Panel family_panel(const FrictionFamily& family, const char* label, const Of& of) {
  constexpr double kHeight = 300.0;
  constexpr double kReachM = 4.0;  // beyond, next to nothing moves
  svg::Panel panel{{"y (m)", -kReachM, kReachM}, {label}, kHeight};
  const auto printed = [&](double y) { return svg::Point{y, published_friction(y) - of(y)}; };
  panel.line({printed(-kReachM), printed(-kStudyReversalM), printed(kReachM)},
             {svg::Ink::kGrey, 1.5, true}, "published law");
  std::size_t i = 0;
  for (const FrictionFamily::Curve& curve : family.curves)
    add_curve(fmt::format("{} = {}", family.name, curve.value), curve.started,
              kInks.at(i++ % kInks.size()), of, panel);
  return panel;
}

}  // namespace

std::vector<PhasePictures> phase_pictures() {
  return {pictures_of("viscous, c = 0.3", {.viscous_per_s = 0.3}),
          pictures_of("Coulomb friction, H1 = 1", {.friction_mps2 = 1.0}),
          pictures_of("structural friction |1 + y / y_c|, H1 = 1, y_c = 0.5",
                      {.friction_mps2 = 1.0, .reversal_m = kStudyReversalM}),
          pictures_of("cubic spring, k3 = 0.1, c = 0.3",
                      {.viscous_per_s = 0.3, .cubic_per_m2s2 = 0.1})};
}

std::vector<FrictionFamily> friction_families() {
  constexpr double kStartSpread = 3.0;
  constexpr std::uint64_t kSeed = 2100;
  const PublishedInputs all{printed_inputs("omega"), printed_inputs("P1"), printed_inputs("P0")};
  const auto family = [&](const char* name, std::vector<double> PublishedInputs::*of) {
    FrictionFamily out{name, {}};
    for (const double value : all.*of) {
      PublishedInputs inputs = all;
      inputs.*of = {value};
      out.curves.push_back({value, study_published_inputs(inputs, 0.0, 0.0, kSeed),
                            study_published_inputs(inputs, kStartSpread, 0.0, kSeed)});
    }
    return out;
  };
  return {family("omega", &PublishedInputs::rates_rad_s),
          family("P1", &PublishedInputs::swings_mps2), family("P0", &PublishedInputs::means_mps2)};
}

Plot plot_families(const std::vector<FrictionFamily>& families) {
  Plot plot{{}, true};
  for (const FrictionFamily& family : families) {
    plot.panels.push_back(family_panel(family, "g(y) (m/s²)", [](double) { return 0.0; }));
    plot.panels.push_back(family_panel(family, "g(y) - published (m/s²)", published_friction));
  }
  return plot;
}

}  // namespace dampline::app
