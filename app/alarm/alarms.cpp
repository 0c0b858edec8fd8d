// SPDX-License-Identifier: MIT
#include "app/alarm/alarms.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/error.hpp"
#include "app/run/directory.hpp"

namespace dampline::app {
namespace {

constexpr double kFaultFreshS = 30.0;  // the guards name a fault so long after it, at most

/// Of the run that later ones are held against.
double reference_level_n(const std::string& run) {
  RunResult result;
  try {
    result = read_files(run).result;
  } catch (const RunError& error) {
    throw UsageError{fmt::format("[alarm] reference: {}", error.what())};
  }
  const Parameter* coulomb = find_parameter(result.parameters, "coulomb");
  if (coulomb == nullptr || !(coulomb->value > 0.0))
    throw UsageError{
        fmt::format("[alarm] reference: {}: found no level, expected a truck's run", run)};
  return coulomb->value;
}

}  // namespace

Alarms::Alarms(const AlarmSettings& settings)
    : hold_s_{settings.hold_s}, hysteresis_{settings.hysteresis_percent / 100.0} {
  if (settings.coulomb_below_n) add_level("coulomb_below", Kind::kBelow, *settings.coulomb_below_n);
  if (settings.coulomb_above_n) add_level("coulomb_above", Kind::kAbove, *settings.coulomb_above_n);
  add_reference(settings);
  if (settings.drift == "yes")
    rules_.push_back({Kind::kDrift, "", {"drift", false, {}, {}, "%", {}}, {}});
  for (const std::string& fault : settings.faults)
    rules_.push_back({Kind::kFault, fault, {"fault_" + fault, false, {}, {}, "", {}}, {}});
}

void Alarms::add_level(const char* name, Kind kind, double limit_n) {
  rules_.push_back({kind, "", {name, false, {}, limit_n, "N", {}}, {}});
}

void Alarms::add_reference(const AlarmSettings& settings) {
  constexpr double kPercent = 0.01;
  const bool wanted = settings.below_percent || settings.above_percent;
  if (wanted != !settings.reference.empty())
    throw UsageError{"[alarm] reference: goes with below_percent or above_percent"};
  if (!wanted) return;
  const double reference_n = reference_level_n(settings.reference);
  if (settings.below_percent)
    add_level("coulomb_below_reference", Kind::kBelow,
              reference_n * (1.0 - kPercent * *settings.below_percent));
  if (settings.above_percent)
    add_level("coulomb_above_reference", Kind::kAbove,
              reference_n * (1.0 + kPercent * *settings.above_percent));
}

std::vector<AlarmChange> Alarms::look(const RunResult& result) {
  const double now_s = result.duration_s;
  std::vector<AlarmChange> out;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    Rule& rule = rules_[i];
    const std::optional<bool> is_there = seen(rule, result);
    if (!is_there || *is_there == rule.state.active) {
      rule.pending_s.reset();
      continue;
    }
    if (!rule.pending_s) rule.pending_s = now_s;
    if (now_s - *rule.pending_s < hold_s_) continue;
    rule.state.active = *is_there;
    rule.state.since_s.reset();
    if (*is_there) rule.state.since_s = *rule.pending_s;
    rule.pending_s.reset();
    out.push_back({rule.state, static_cast<std::uint8_t>(i)});
  }
  return out;
}

std::optional<bool> Alarms::seen(Rule& rule, const RunResult& result) const {
  if (rule.kind == Kind::kDrift) {
    if (result.faults.alarms.empty()) return false;
    rule.state.value = result.faults.alarms.back().change_percent;
    return true;
  }
  if (rule.kind == Kind::kFault)
    return std::any_of(result.faults.list.begin(), result.faults.list.end(),
                       [&](const FaultFinding& fault) {
                         return (rule.fault == "all" || rule.fault == fault.name) &&
                                result.duration_s - fault.last_s <= hold_s_ + kFaultFreshS;
                       });
  return level_seen(rule, result);
}

/// Between the limit and the hysteresis everything stays as it is.
std::optional<bool> Alarms::level_seen(Rule& rule, const RunResult& result) const {
  const Parameter* coulomb = find_parameter(result.parameters, "coulomb");
  rule.state.value.reset();
  if (coulomb == nullptr || result.trust == Trust::kNotIdentified) return {};
  rule.state.value = coulomb->value;
  const double side = rule.kind == Kind::kBelow ? 1.0 : -1.0;
  const double beyond_n = side * (*rule.state.limit - coulomb->value);
  if (beyond_n > coulomb->std) return true;
  if (beyond_n < -hysteresis_ * *rule.state.limit) return false;
  return {};
}

std::vector<WatchState> Alarms::states() const {
  std::vector<WatchState> out;
  for (const Rule& rule : rules_) out.push_back(rule.state);
  return out;
}

bool Alarms::any_raised() const noexcept {
  return std::any_of(rules_.begin(), rules_.end(),
                     [](const Rule& rule) { return rule.state.active; });
}

}  // namespace dampline::app
