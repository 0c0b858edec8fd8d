// SPDX-License-Identifier: MIT
#include "app/identify/low_pass.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "app/identify/source.hpp"
#include "app/identify/truck_result.hpp"
#include "app/record/source_kind.hpp"
#include "app/run/trust.hpp"

namespace dampline::app {
namespace {

constexpr double kStep = 0.88;  // from one corner to the next
constexpr double kLowestHz = 25.0;
constexpr double kHighestHz = 250.0;  // of one sensor: its delay still shows
constexpr double kHigher = 1.08;      // times the declared: another one
constexpr double kClearly = 0.95;     // of what is left otherwise
constexpr double kStretchS = 120.0;

/// Of whom another corner is tried.
struct Group {
  FaultChannel name;
  std::vector<std::size_t> channels;
};

AntiAliasInput with_corner(AntiAliasInput low_pass, const Group& group, double corner_hz) {
  if (group.name == FaultChannel::kAll) {
    for (std::optional<double>& own_hz : low_pass.own_hz)
      if (own_hz) *own_hz *= corner_hz / low_pass.corner_hz;
    low_pass.corner_hz = corner_hz;
  }
  for (const std::size_t c : group.channels) low_pass.own_hz[c] = corner_hz;
  return low_pass;
}

/// What the base leaves of the record behind a group's corner, held out.
class Trials {
 public:
  Trials(const Config& config, const SourceOptions& source, Group group, double most_s)
      : config_{config},
        source_{source},
        kind_{detect_source(config, source)},
        group_{std::move(group)},
        most_s_{most_s} {}
  [[nodiscard]] double declared_hz() const {
    const AntiAliasInput& declared = config_.input.anti_alias;
    if (group_.channels.empty()) return declared.corner_hz;
    return declared.own_hz[group_.channels.front()].value_or(declared.corner_hz);
  }
  /// Above, corners are hardly told apart.
  [[nodiscard]] double highest_hz() const {
    return group_.channels.empty() ? kUsualHz : kHighestHz;
  }
  [[nodiscard]] double nmse(double corner_hz) {
    const auto [known, is_new] = known_.try_emplace(corner_hz, 1.0);
    if (!is_new) return known->second;
    Config there = config_;
    there.input.anti_alias = with_corner(there.input.anti_alias, group_, corner_hz);
    const RunResult result = identify_truck(there, source_, kind_, false, most_s_).result;
    return known->second = result.fit.held_out_nmse.value_or(1.0);
  }

 private:
  const Config& config_;
  const SourceOptions& source_;
  SourceKind kind_;
  Group group_;
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
    if (next_hz < kLowestHz || next_hz > trials.highest_hz() / kStep) return out;
    out.after = {next_hz, trials.nmse(next_hz)};
    if (!(out.after.nmse < out.best.nmse)) return out;
    out.before = out.best;
    out.best = out.after;
  }
}

/// Down, and where that leaves no less up.
Course walk_from(Trials& trials, Trial start) {
  Course course = walk(trials, start, kStep);
  if (course.best.corner_hz != start.corner_hz || start.corner_hz >= trials.highest_hz())
    return course;
  const Trial below = course.after;
  course = walk(trials, start, 1.0 / kStep);
  if (course.best.corner_hz == start.corner_hz) course.before = below;
  return course;
}

/// Of the parabola through three trials, equally spaced in the logarithm.
double least_of(const Course& c) {
  const double bend = c.before.nmse - 2.0 * c.best.nmse + c.after.nmse;
  if (!(bend > 0.0) || c.before.corner_hz == c.best.corner_hz) return c.best.corner_hz;
  const double steps = 0.5 * (c.before.nmse - c.after.nmse) / bend;
  return c.best.corner_hz * std::pow(c.after.corner_hz / c.best.corner_hz, steps);
}

bool is_other(double found_hz, double declared_hz, double highest_hz) {
  return found_hz < kLower * declared_hz ||
         (found_hz > kHigher * declared_hz && declared_hz < highest_hz);
}

std::optional<OtherLowPass> other_of_all(Trials& trials, double as_declared,
                                         std::optional<double> left_nmse) {
  const double declared_hz = trials.declared_hz();
  const double start_hz = declared_hz > 0.0 ? std::min(declared_hz, kUsualHz) : kUsualHz;
  if (start_hz != declared_hz && trials.nmse(kStep * start_hz) >= as_declared) return std::nullopt;
  const Course course =
      walk_from(trials, {start_hz, start_hz == declared_hz ? as_declared : trials.nmse(start_hz)});
  const double found_hz = least_of(course);
  const double nmse = course.best.nmse;
  if (!is_other(found_hz, start_hz, trials.highest_hz()) || nmse > kClearly * as_declared ||
      nmse > left_nmse.value_or(nmse))
    return std::nullopt;
  return OtherLowPass{FaultChannel::kAll, found_hz, nmse};
}

/// By how much the frame seems late to the wheelsets: where corners that would make it later and
/// earlier leave least, by a parabola, less where that lies in sound records. None where no corner
/// would make it that much earlier.
std::optional<double> frame_late_s(const Config& config, Trials& trials, double as_declared) {
  constexpr double kTriedS = 0.55e-3;
  constexpr double kOfSoundS = 0.5e-3;  // friction's kinks are behind what the low pass delays
  const int order = config.input.anti_alias.order;
  const double declared_hz = trials.declared_hz();
  if (!(declared_hz > 0.0)) return std::nullopt;
  const double delay = delay_s({.corner_hz = declared_hz, .order = order});
  if (delay < 2.0 * kTriedS) return std::nullopt;
  const double later = trials.nmse(declared_hz * delay / (delay + kTriedS));
  const double earlier = trials.nmse(declared_hz * delay / (delay - kTriedS));
  const double bend = later - 2.0 * as_declared + earlier;
  if (!(bend > 0.0)) return std::nullopt;
  return 0.5 * kTriedS * (earlier - later) / bend + kOfSoundS;
}

}  // namespace

std::optional<OtherLowPass> other_low_pass(const Config& config, const SourceOptions& source,
                                           double as_declared, std::optional<double> left_nmse) {
  Trials trials{config, source, {FaultChannel::kAll, {}}, std::numeric_limits<double>::infinity()};
  return other_of_all(trials, as_declared, left_nmse);
}

std::optional<OtherLowPass> other_low_pass_of_wheelsets(const Config& config,
                                                        const SourceOptions& source,
                                                        double as_declared, double left_nmse) {
  if (config.input.anti_alias.corner_hz == 0.0) return std::nullopt;
  const std::array groups{Group{FaultChannel::kWheelset1, {1}},
                          Group{FaultChannel::kWheelset2, {2}},
                          Group{FaultChannel::kWheelsets, {1, 2}}};
  Trials of_all{config, source, {FaultChannel::kAll, {}}, kStretchS};
  const double start = of_all.nmse(of_all.declared_hz());
  const Group* of = nullptr;
  Trial least{0.0, 1.0};
  for (const Group& group : groups) {
    Trials trials{config, source, group, kStretchS};
    const double declared_hz = trials.declared_hz();
    const Course course = walk_from(trials, {declared_hz, start});
    const double found_hz = least_of(course);
    if (!is_other(found_hz, declared_hz, kHighestHz) || course.best.nmse > least.nmse) continue;
    least = {found_hz, course.best.nmse};
    of = &group;
  }
  if (of == nullptr) return std::nullopt;
  Trials whole{config, source, *of, std::numeric_limits<double>::infinity()};
  const double nmse = whole.nmse(least.corner_hz);
  if (nmse > std::min(kClearly * as_declared, left_nmse)) return std::nullopt;
  return OtherLowPass{of->name, least.corner_hz, nmse};
}

void look_for_low_pass(const Config& config, const SourceOptions& source, RunResult& result) {
  if (result.trust != Trust::kTrusted || !result.fit.held_out_nmse) return;
  Trials trials{config, source, {FaultChannel::kAll, {}}, kStretchS};
  const double as_declared = result.duration_s <= kStretchS ? *result.fit.held_out_nmse
                                                            : trials.nmse(trials.declared_hz());
  if (const auto found = other_of_all(trials, as_declared, std::nullopt)) {
    add_fault(FaultKind::kWrongLowPass, found->channel, found->corner_hz, result);
  } else {
    Trials of_frame{config, source, {FaultChannel::kFrame, {0}}, kStretchS};
    result.frame_late_s = frame_late_s(config, of_frame, as_declared);
  }
  judge_trust(nullptr, result);
}

}  // namespace dampline::app
