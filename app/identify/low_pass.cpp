// SPDX-License-Identifier: MIT
#include "app/identify/low_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "app/identify/identify_source.hpp"
#include "app/identify/truck_result.hpp"
#include "app/record/source_kind.hpp"
#include "app/run/trust.hpp"

namespace dampline::app {
namespace {

constexpr double kStep = 0.88;  // from one corner to the next
constexpr double kLowestHz = 25.0;
constexpr double kLower = 0.85;  // times the declared: another one
constexpr double kHigher = 1.08;
constexpr double kClearly = 0.95;  // of what is left otherwise
constexpr double kStretchS = 120.0;

/// What the base leaves of the record behind a corner, held out.
class Trials {
 public:
  Trials(const Config& config, const SourceOptions& source, double most_s)
      : config_{config}, source_{source}, kind_{detect_source(config, source)}, most_s_{most_s} {}
  [[nodiscard]] double declared_hz() const { return config_.input.anti_alias.corner_hz; }
  [[nodiscard]] double nmse(double corner_hz) {
    const auto [known, is_new] = known_.try_emplace(corner_hz, 1.0);
    if (!is_new) return known->second;
    Config there = config_;
    there.input.anti_alias.corner_hz = corner_hz;
    const RunResult result = identify_truck(there, source_, kind_, false, most_s_).result;
    return known->second = result.fit.held_out_nmse.value_or(1.0);
  }

 private:
  const Config& config_;
  const SourceOptions& source_;
  SourceKind kind_;
  double most_s_;
  std::map<double, double> known_;
};

struct Trial {
  double corner_hz;
  double nmse;
};

/// Steps by a factor while less is left.
struct Course {
  Trial before;
  Trial best;
  Trial after;
};
Course walk(Trials& trials, Trial from, double factor) {
  Course out{from, from, from};
  while (true) {
    const double next_hz = out.best.corner_hz * factor;
    if (next_hz < kLowestHz || next_hz > kUsualHz / kStep) return out;
    out.after = {next_hz, trials.nmse(next_hz)};
    if (!(out.after.nmse < out.best.nmse)) return out;
    out.before = out.best;
    out.best = out.after;
  }
}

/// Of the parabola through three trials, equally spaced in the logarithm.
double least_of(const Course& c) {
  const double bend = c.before.nmse - 2.0 * c.best.nmse + c.after.nmse;
  if (!(bend > 0.0) || c.before.corner_hz == c.best.corner_hz) return c.best.corner_hz;
  const double steps = 0.5 * (c.before.nmse - c.after.nmse) / bend;
  return c.best.corner_hz * std::pow(c.after.corner_hz / c.best.corner_hz, steps);
}

std::optional<double> other_corner_hz(Trials& trials, double as_declared,
                                      std::optional<double> left_nmse) {
  const double declared_hz = trials.declared_hz();
  const double start_hz = declared_hz > 0.0 ? std::min(declared_hz, kUsualHz) : kUsualHz;
  if (start_hz != declared_hz && trials.nmse(kStep * start_hz) >= as_declared) return std::nullopt;
  const Trial start{start_hz, start_hz == declared_hz ? as_declared : trials.nmse(start_hz)};
  Course course = walk(trials, start, kStep);
  if (course.best.corner_hz == start_hz && start_hz < kUsualHz) {
    const Trial below = course.after;
    course = walk(trials, start, 1.0 / kStep);
    if (course.best.corner_hz == start_hz) course.before = below;
  }
  const double found_hz = least_of(course);
  const bool is_other =
      found_hz < kLower * start_hz || (found_hz > kHigher * start_hz && start_hz < kUsualHz);
  const double nmse = course.best.nmse;
  if (!is_other || nmse > kClearly * as_declared || nmse > left_nmse.value_or(nmse))
    return std::nullopt;
  return found_hz;
}

}  // namespace

std::optional<double> other_low_pass_hz(const Config& config, const SourceOptions& source,
                                        double as_declared, std::optional<double> left_nmse) {
  Trials trials{config, source, std::numeric_limits<double>::infinity()};
  return other_corner_hz(trials, as_declared, left_nmse);
}

void look_for_low_pass(const Config& config, const SourceOptions& source, RunResult& result) {
  if (result.trust != Trust::kTrusted || !result.fit.held_out_nmse) return;
  Trials trials{config, source, kStretchS};
  const double as_declared = result.duration_s <= kStretchS ? *result.fit.held_out_nmse
                                                            : trials.nmse(trials.declared_hz());
  const auto corner_hz = other_corner_hz(trials, as_declared, std::nullopt);
  if (!corner_hz) return;
  add_fault(FaultKind::kWrongLowPass, FaultChannel::kAll, *corner_hz, result);
  judge_trust(nullptr, result);
}

}  // namespace dampline::app
