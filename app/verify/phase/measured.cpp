// SPDX-License-Identifier: MIT
#include "app/verify/phase/measured.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dampline::app {
namespace {

constexpr int kSections = 8;
constexpr double kAlike = 0.05;       // of a cycle's length and amplitude
constexpr double kSamePeriod = 0.02;  // of two records
constexpr double kSlow = 0.05;        // of the rms velocity

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// Between samples, at a place counted in samples.
double between(const std::vector<double>& values, double place) {
  const auto before = static_cast<std::size_t>(std::max(place, 0.0));
  if (before + 1 >= values.size()) return values.back();
  const double share = place - static_cast<double>(before);
  return (1.0 - share) * values[before] + share * values[before + 1];
}

/// Places, in samples, where the deflection rises through the middle of its range after having been
/// a tenth of the range below it.
std::vector<double> rises(const std::vector<double>& deflection_m) {
  constexpr double kDeep = 0.1;
  const auto [low, high] = std::minmax_element(deflection_m.begin(), deflection_m.end());
  const double middle = 0.5 * (*low + *high);
  const double deep = middle - kDeep * (*high - *low);
  std::vector<double> out;
  bool armed = false;
  for (std::size_t i = 1; i < deflection_m.size(); ++i) {
    armed = armed || deflection_m[i - 1] < deep;
    if (!armed || deflection_m[i] < middle) continue;
    const double step = deflection_m[i] - deflection_m[i - 1];
    out.push_back(static_cast<double>(i) - (deflection_m[i] - middle) / step);
    armed = false;
  }
  return out;
}

/// A stretch from one rise to the next, in samples.
struct Cycle {
  double from, length, amplitude_m;
};

std::vector<Cycle> cycles_of(const std::vector<double>& deflection_m) {
  const std::vector<double> at = rises(deflection_m);
  std::vector<Cycle> out;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const auto begin = deflection_m.begin() + static_cast<std::ptrdiff_t>(at[i]);
    const auto end = deflection_m.begin() + static_cast<std::ptrdiff_t>(at[i + 1]);
    const auto [low, high] = std::minmax_element(begin, end);
    out.push_back({at[i], at[i + 1] - at[i], 0.5 * (*high - *low)});
  }
  return out;
}

double median_of(const std::vector<Cycle>& cycles, double Cycle::*of) {
  std::vector<double> values;
  values.reserve(cycles.size());
  for (const Cycle& cycle : cycles) values.push_back(cycle.*of);
  return median(std::move(values));
}

/// Equation 5 holds "in the vicinity of that plane": so far from it in the mean, over rms force. A
/// section that is farther and yet not bent by sgn v, y sgn v or y^3 has another force in it.
constexpr double kVicinity = 0.1;

const char* name_of(const PlanarityVerdict& verdict) {
  switch (verdict.state) {
    case PlanarityState::kNotEnough:
      return "not enough points";
    case PlanarityState::kNoMotion:
      return "no motion";
    case PlanarityState::kNotDetermined:
      return "cannot be told";
    case PlanarityState::kLinear:
      return verdict.index < kVicinity
                 ? "linear"
                 : "neither a plane nor bent by friction or a cubic spring: a mass, or a memory";
    case PlanarityState::kNonlinear:
      break;
  }
  return "non-linear";
}

const char* name_of(ScalingState state) {
  switch (state) {
    case ScalingState::kNotEnough:
      return "fewer than three cycles";
    case ScalingState::kNoInput:
    case ScalingState::kNoMotion:
      return "no motion";
    case ScalingState::kSameInput:
      return "the same motion: nothing to compare";
    case ScalingState::kOtherShape:
      return "the motions have different shapes: nothing to compare";
    case ScalingState::kProportional:
      return "linear: in proportion";
    case ScalingState::kDisproportional:
      break;
  }
  return "non-linear: not in proportion";
}

bool judged(ScalingState state) {
  return state == ScalingState::kProportional || state == ScalingState::kDisproportional;
}

PhaseRow plane_row(const MeasuredRecord& record) {
  const PlanarityVerdict verdict = study_measured_plane(record);
  PhaseRow row{.table = "records",
               .what = record.name + ": plane over deflection and velocity",
               .unit = "rms distance / rms force",
               .remark = fmt::format("{}; {} points", name_of(verdict), verdict.points)};
  if (verdict.state != PlanarityState::kLinear && verdict.state != PlanarityState::kNonlinear)
    return row;
  row.found = verdict.index;
  row.remark += fmt::format(
      "; sgn v, y sgn v and y^3 take {:.0f} % of what is left, F = {:.3g}; of sgn v: {:.4g} N",
      100.0 * verdict.gain, verdict.f, verdict.sign_mps2.value);
  return row;
}

PhaseRow scaling_row(const std::string& pair, const ScalingVerdict& verdict) {
  PhaseRow row{.table = "records",
               .what = pair + ": force in proportion to motion",
               .unit = "departure / force",
               .remark = name_of(verdict.state)};
  if (!judged(verdict.state)) return row;
  row.found = verdict.departure;
  row.deviation = verdict.departure_std;
  row.remark += fmt::format("; {:.3g} times the motion", verdict.input_ratio);
  return row;
}

}  // namespace

std::optional<MeasuredCycles> measured_cycles(const MeasuredRecord& record) {
  const std::vector<Cycle> all = cycles_of(record.deflection_m);
  if (all.size() < 3) return std::nullopt;
  const double length = median_of(all, &Cycle::length);
  const double amplitude_m = median_of(all, &Cycle::amplitude_m);
  const auto near = [](double value, double wanted) {
    return std::abs(value / wanted - 1.0) < kAlike;
  };
  MeasuredCycles out;
  out.period_s = length * record.interval_s;
  out.amplitude_m = amplitude_m;
  for (const Cycle& cycle : all) {
    if (!near(cycle.length, length) || !near(cycle.amplitude_m, amplitude_m)) continue;
    ++out.cycles;
    for (int phase = 0; phase < kSections; ++phase) {
      const double place = cycle.from + cycle.length * phase / kSections;
      out.sections.add(phase, {0.0, 0.0, between(record.force_n, place)},
                       between(record.deflection_m, place));
    }
  }
  const bool repeats = out.cycles >= 3 && 2 * out.cycles >= static_cast<int>(all.size());
  return repeats ? std::optional{out} : std::nullopt;
}

PlanarityVerdict study_measured_plane(const MeasuredRecord& record) {
  if (record.velocity_mps.empty()) return {};
  PlanarityTest<0> test{kSlow * rms(record.velocity_mps)};
  for (std::size_t i = 0; i < record.force_n.size(); ++i)
    test.add({record.deflection_m[i], record.velocity_mps[i], record.force_n[i]}, 0.0);
  return test.verdict();
}

std::optional<ScalingVerdict> study_measured_scaling(const MeasuredRecord& one,
                                                     const MeasuredRecord& other) {
  const auto a = measured_cycles(one);
  const auto b = measured_cycles(other);
  if (!a || !b || std::abs(a->period_s / b->period_s - 1.0) > kSamePeriod) return std::nullopt;
  return a->amplitude_m < b->amplitude_m ? judge_scaling(a->sections, b->sections)
                                         : judge_scaling(b->sections, a->sections);
}

std::vector<PhaseRow> record_rows(const std::vector<MeasuredRecord>& records) {
  std::vector<PhaseRow> rows;
  rows.reserve(records.size());
  for (const MeasuredRecord& record : records) rows.push_back(plane_row(record));
  for (std::size_t i = 0; i < records.size(); ++i) {
    for (std::size_t j = i + 1; j < records.size(); ++j) {
      const auto verdict = study_measured_scaling(records[i], records[j]);
      if (verdict) rows.push_back(scaling_row(records[i].name + ", " + records[j].name, *verdict));
    }
  }
  return rows;
}

Plot plot_measured(const MeasuredRecord& record) {
  constexpr std::size_t kMostPoints = 4000;
  constexpr double kSquare = 320.0;
  const std::size_t stride = std::max<std::size_t>(1, record.force_n.size() / kMostPoints);
  const std::vector<Cycle> cycles =
      measured_cycles(record) ? cycles_of(record.deflection_m) : std::vector<Cycle>{};
  const auto panel_of = [&](const char* x, const std::vector<double>& xs, double x_factor,
                            const char* y, const std::vector<double>& ys, double y_factor) {
    std::vector<svg::Point> path;
    for (std::size_t i = 0; i < xs.size(); i += stride)
      path.push_back({x_factor * xs[i], y_factor * ys[i]});
    svg::Panel panel{{x}, {y}, kSquare};
    panel.line(std::move(path), {svg::Ink::kBlue, 0.8}, "measured");
    std::vector<svg::Point> dots;
    for (const Cycle& cycle : cycles) {
      for (int phase = 0; phase < kSections; ++phase) {
        const double place = cycle.from + cycle.length * phase / kSections;
        dots.push_back({x_factor * between(xs, place), y_factor * between(ys, place)});
      }
    }
    if (!cycles.empty()) panel.dots(std::move(dots), svg::Ink::kOrange, 2.6, "sections");
    return panel;
  };
  constexpr double kMilli = 1e3;
  return {{panel_of("y (mm)", record.deflection_m, kMilli, "v (mm/s)", record.velocity_mps, kMilli),
           panel_of("y (mm)", record.deflection_m, kMilli, "force (N)", record.force_n, 1.0),
           panel_of("v (mm/s)", record.velocity_mps, kMilli, "force (N)", record.force_n, 1.0)},
          true};
}

}  // namespace dampline::app
