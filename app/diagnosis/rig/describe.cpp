// SPDX-License-Identifier: MIT
// What the search found, in parameters with units.
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "app/diagnosis/rig/search.hpp"

namespace dampline::app::rig {
namespace {

/// What the first coefficient of an effect in its smallest form is.
struct First {
  std::string_view effect;
  const char* name;
  const char* unit;
  double times{1.0};
};
constexpr std::array kFirst{
    First{"quadratic_damping", "quadratic_damping", "N s^2/m^2"},
    First{"coulomb", "coulomb", "N"},
    First{"offset_force", "offset", "N"},
    First{"stribeck", "stribeck_force", "N"},
    First{"cubic_stiffness", "cubic_stiffness", "N/m^3"},
    First{"quadratic_stiffness", "quadratic_stiffness", "N/m^2"},
    First{"asymmetric_stiffness", "asymmetric_stiffness_difference", "N/m", 2.0},
    First{"bump_stop", "bump_stop_stiffness", "N/m"},
    First{"presliding_hysteresis", "presliding_hysteresis_force", "N"},
    First{"backlash", "backlash_force", "N"},
    First{"unmodelled_mode", "unmodelled_mode_mass", "kg"},
    First{"progressive_friction", "progressive_friction_slope", "N/m"}};

/// The length or speed of an effect in its smallest form; none where it has no name. Its deviation
/// is what the grid leaves open.
Parameter place_parameter(const Candidate& c, const Scale& scale) {
  constexpr double kMemoryPlace = 0.1;  // of a length known to one step of its grid
  constexpr double kSpeedPlace = 0.3;
  constexpr double kGapPlace = 0.03;  // of the motion's size
  const double place = c.place;
  if (c.effect == "stribeck") return {"stribeck_speed", place, kSpeedPlace * place, "m/s"};
  if (c.effect == "bump_stop") return {"bump_stop_gap", place, kGapPlace * scale.deflection_m, "m"};
  if (!is_memory(c.effect)) return {};
  return {c.effect + "_travel", 2.0 * place, kMemoryPlace * (2.0 * place), "m"};
}

}  // namespace

void Search::describe(Model& model, const Judged& judged) const {
  constexpr double kWidthPlace = 0.0132;  // of a width: the deviation within the finest grid
  model.terms = terms();
  model.fit = judged.fit;
  model.ridge = ridge();
  for (const Eigen::Index i : judged.set) {
    const Regressor& column = library_.at(i);
    const auto add = [&](const char* name, const char* unit) {
      const Estimate e = judged.of(i);
      model.coefficients.emplace_back(model.parameters.size(), place_of(judged.set, i));
      model.parameters.push_back({name, e.value, e.std, unit});
    };
    model.columns.push_back(column);
    if (column.kind == Kind::kInertia || column.kind == Kind::kAcceleration)
      add("moving_mass", "kg");
    else if (i == library_.spring)
      add("stiffness", "N/m");
    else if (column.kind == Kind::kVelocity)
      add("viscous", "N s/m");
    else if (column.kind == Kind::kOne)
      add("offset", "N");
    else if (is_friction(i, judged))
      add("coulomb", "N");
    if (is_smooth(column, scale_))
      model.parameters.push_back({"law_width", column.a, kWidthPlace * column.a, "m/s"});
  }
}

/// The parameters of an effect in its smallest form, from its first coefficient.
void Search::describe_small(Chosen& c, const Estimate& first) const {
  const auto* const what = std::find_if(kFirst.begin(), kFirst.end(),
                                        [&](const First& f) { return f.effect == c.step.effect; });
  if (what == kFirst.end())
    c.step.parameters.push_back({c.step.effect, first.value, first.std, "N s/m"});
  else
    c.step.parameters.push_back(
        {what->name, what->times * first.value, what->times * first.std, what->unit});
  const Parameter place = place_parameter(c.candidate, scale_);
  if (!place.name.empty()) c.step.parameters.push_back(place);
}

void Search::describe_sides(Chosen& c, const Judged& now) const {
  const auto place = [&](Kind kind) {
    return std::find_if(now.set.begin(), now.set.end(),
                        [&](Eigen::Index i) { return library_.at(i).kind == kind; }) -
           now.set.begin();
  };
  const auto odd = place(Kind::kVelocity);
  const auto even = place(Kind::kSpeed);
  const auto& covariance = now.fit.covariance;
  const double squares = covariance(odd, odd) + covariance(even, even);
  const double both = 2.0 * covariance(odd, even);
  const double level = now.fit.theta[odd];
  const double difference = now.fit.theta[even];
  c.step.parameters.push_back(
      {"viscous_positive", level + difference, std::sqrt(std::max(squares + both, 0.0)), "N s/m"});
  c.step.parameters.push_back(
      {"viscous_negative", level - difference, std::sqrt(std::max(squares - both, 0.0)), "N s/m"});
}

/// The change over the record, of the mean or of the value before it.
void Search::describe_drift(Chosen& c, const Judged& now) const {
  const Regressor& drifting = library_.at(c.candidate.columns.front());
  const Estimate change = now.of(c.candidate.columns.front());
  Parameter& out = c.step.parameters.front();
  if (drifting.kind == Kind::kOne) {
    out = {out.name, change.value, change.std, "N"};
    return;
  }
  const bool linear = drifting.kind == Kind::kVelocity || drifting.kind == Kind::kDeflection;
  double of = 0.0;
  for (const Eigen::Index i : now.set) {
    const Regressor& steady = library_.at(i);
    const bool same = steady.kind == drifting.kind || (!linear && is_friction(i, now));
    if (same && steady.time == Regressor::Time::kSteady) of = now.of(i).value;
  }
  if (of == 0.0) return;
  const double percent = 100.0 / std::abs(of);
  out.value = percent * std::copysign(1.0, of) * change.value;
  out.std = percent * change.std;
}

void Search::describe_steps(const Judged& now) {
  for (Chosen& c : chosen_) {
    if (c.step.effect == "time_skew" || c.step.effect == "impulsive_input" ||
        c.candidate.columns.empty())
      continue;
    const Eigen::Index column = c.candidate.columns.front();
    if (c.step.effect == "time_drift")
      describe_drift(c, now);
    else if (library_.at(column).kind == Kind::kBoucWen)
      describe_bouc_wen(c, now.of(column));
    else if (c.ridge > 0.0)
      describe_bank(c, now);
    else if (c.step.effect == "asymmetric_viscous")
      describe_sides(c, now);
    else
      describe_small(c, now.of(column));
  }
}

}  // namespace dampline::app::rig
