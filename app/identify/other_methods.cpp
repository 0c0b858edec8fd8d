// SPDX-License-Identifier: MIT
#include "app/identify/other_methods.hpp"

#include <cmath>
#include <limits>
#include <span>

namespace dampline::app {
namespace {

template <class Histogram>
DensityTable density_table(const Histogram& histogram, const char* quantity, double factor) {
  DensityTable table{quantity, histogram.share_outside(), {}};
  for (std::size_t b = 0; b < Histogram::kBins; ++b)
    table.rows.push_back(
        {factor * histogram.axis().centre(b), histogram.density(b) / factor, histogram.mass(b)});
  return table;
}

/// The broken line at `velocity_mps` on the branch of `side`; NaN outside its support.
Estimate force_at(std::span<const CurvePoint> points, double velocity_mps, bool positive) {
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const CurvePoint& a = points[i];
    const CurvePoint& b = points[i + 1];
    const bool branch = positive ? a.velocity_mps >= 0.0 : b.velocity_mps <= 0.0;
    if (!branch || !(a.velocity_mps < b.velocity_mps)) continue;
    if (velocity_mps < a.velocity_mps || velocity_mps > b.velocity_mps) continue;
    const double t = (velocity_mps - a.velocity_mps) / (b.velocity_mps - a.velocity_mps);
    return {(1.0 - t) * a.force_n + t * b.force_n, (1.0 - t) * a.std_n + t * b.std_n};
  }
  return {kNothing, kNothing};
}

std::vector<Estimate> along(const std::vector<CurveRow>& curve, std::span<const CurvePoint> points,
                            double nominal_per_true) {
  std::vector<Estimate> out;
  bool past_zero = false;
  for (const CurveRow& row : curve) {
    const bool positive = row.velocity_mps > 0.0 || past_zero;
    past_zero = past_zero || row.velocity_mps == 0.0;
    out.push_back(force_at(points, row.velocity_mps * nominal_per_true, positive));
  }
  return out;
}

std::vector<Objection> objections_of(const TrustVerdict& verdict) {
  std::vector<Objection> out;
  for (std::size_t i = 0; i < kReasons; ++i) {
    const auto reason = static_cast<Reason>(i);
    const Finding& finding = verdict[reason];
    if (finding.violated) out.push_back({text(reason), finding.size, finding.limit, unit(reason)});
  }
  return out;
}

/// The same picture with its axes in other units.
void stretch(PhasePicture& picture, double x, double y) {
  picture.x_low *= x;
  picture.x_high *= x;
  picture.y_low *= y;
  picture.y_high *= y;
  for (auto& column : picture.density) {
    for (float& density : column) density /= static_cast<float>(x * y);
  }
}

}  // namespace

void fill_densities(const FokkerPlanck& statistics, const TruckRecord& record, RunResult& result) {
  if (statistics.samples() == 0) return;
  result.densities = {
      density_table(statistics.deflections(), "deflection_m", record.correction.deflection()),
      density_table(statistics.velocities(), "velocity_mps", record.correction.velocity())};
}

void fill_phase(const PhaseView& view, const TruckRecord& record, RunResult& result) {
  const auto phase = std::make_shared<PhaseSnapshot>();
  view.snapshot(*phase);
  const double y = record.correction.deflection();
  const double v = record.correction.velocity();
  stretch(phase->velocity_over_deflection, y, v);
  stretch(phase->accel_over_deflection, y, 1.0);
  stretch(phase->accel_over_velocity, v, 1.0);
  phase->period.period_s /= record.correction.ratio;
  phase->period.period_std_s /= record.correction.ratio;
  for (std::size_t p = 0; p < kSectionPhases; ++p) {
    for (std::size_t i = 0; i < phase->section_count[p]; ++i) {
      phase->section[p][i].deflection_m *= y;
      phase->section[p][i].velocity_mps *= v;
    }
  }
  result.phase = phase;
}

void fill_methods(const FokkerPlanck& statistics, double mass_kg, double nominal_stiffness_npm,
                  const TruckRecord& record, RunResult& result) {
  const FokkerPlanckEstimates found = statistics.estimates(mass_kg, nominal_stiffness_npm);
  const auto add = [&](const char* name, const char* title, const MethodResult& method) {
    const std::span<const CurvePoint> points{method.curve.data(),
                                             method.verdict.has_number ? method.points : 0};
    result.methods.push_back({name, title, method.level_n, method.verdict.has_number,
                              method.verdict.trusted, objections_of(method.verdict),
                              along(result.curve, points, 1.0 / record.correction.velocity())});
  };
  add("fokker_planck_paper", "Fokker-Planck, Kisilowski and Urbanski 1987", found.paper);
  add("fokker_planck_weak", "Fokker-Planck, weak form", found.weak);
  add("known_input", "conditional mean with the known input", found.known_input);
}

}  // namespace dampline::app
