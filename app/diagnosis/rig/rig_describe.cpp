// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/rig_rank.hpp"
#include "app/diagnosis/rig/rig_search.hpp"

namespace dampline::app {
namespace {

constexpr double kMemoryPlace = 0.1;  // of a length known to one step of its grid
constexpr double kSpeedPlace = 0.3;
constexpr double kGapPlace = 0.03;  // of the motion's size
constexpr double kWidthPlace =
    0.0132;  // of a width: the deviation within a step of the finest grid

}  // namespace

void RigSearch::describe(RigModel& model, const Judged& judged, const ColumnSet& more) const {
  model.terms = terms();
  model.fit = judged.fit;
  const ColumnSet set = set_of(more, judged.width);
  for (std::size_t i = 0; i < set.size(); ++i) {
    const RigColumn& column = library_.columns[static_cast<std::size_t>(set[i])];
    model.columns.push_back(column);
    const auto at = static_cast<Eigen::Index>(i);
    const double value = judged.fit.theta[at];
    const double std = std::sqrt(std::max(judged.fit.covariance(at, at), 0.0));
    using Kind = RigColumn::Kind;
    if (column.kind == Kind::kInertia || column.kind == Kind::kAcceleration)
      model.parameters.push_back({"moving_mass", value, std, "kg"});
    else if (set[i] == library_.spring)
      model.parameters.push_back({"stiffness", value, std, "N/m"});
    else if (column.kind == Kind::kVelocity)
      model.parameters.push_back({"viscous", value, std, "N s/m"});
    else if (column.kind == Kind::kOne)
      model.parameters.push_back({"offset", value, std, "N"});
    else if (library_.base_friction && set[i] == library_.friction[judged.width])
      model.parameters.push_back({"coulomb", value, std, "N"});
    if (is_smooth(column, scale_))
      model.parameters.push_back({"law_width", column.a, kWidthPlace * column.a, "m/s"});
  }
}

/// The parameters of an effect in its smallest form, from its first coefficient.
void RigSearch::describe_small(Chosen& c, const Estimate& first) const {
  const std::string& effect = c.step.effect;
  auto& out = c.step.parameters;
  if (effect == "quadratic_damping") {
    out.push_back({effect, first.value, first.std, "N s^2/m^2"});
  } else if (effect == "coulomb") {
    out.push_back({effect, first.value, first.std, "N"});
  } else if (effect == "offset_force") {
    out.push_back({"offset", first.value, first.std, "N"});
  } else if (effect == "stribeck") {
    out.push_back({"stribeck_force", first.value, first.std, "N"});
    out.push_back({"stribeck_speed", c.candidate.place, kSpeedPlace * c.candidate.place, "m/s"});
  } else if (effect == "cubic_stiffness") {
    out.push_back({effect, first.value, first.std, "N/m^3"});
  } else if (effect == "quadratic_stiffness") {
    out.push_back({effect, first.value, first.std, "N/m^2"});
  } else if (effect == "asymmetric_stiffness") {
    out.push_back({"asymmetric_stiffness_difference", 2.0 * first.value, 2.0 * first.std, "N/m"});
  } else if (effect == "bump_stop") {
    out.push_back({"bump_stop_stiffness", first.value, first.std, "N/m"});
    out.push_back({"bump_stop_gap", c.candidate.place, kGapPlace * scale_.deflection_m, "m"});
  } else if (effect == "presliding_hysteresis" || effect == "backlash") {
    const double travel_m = 2.0 * c.candidate.place;
    out.push_back({effect + "_force", first.value, first.std, "N"});
    out.push_back({effect + "_travel", travel_m, kMemoryPlace * travel_m, "m"});
  } else if (effect == "unmodelled_mode") {
    out.push_back({"unmodelled_mode_mass", first.value, first.std, "kg"});
  } else if (effect == "progressive_friction") {
    out.push_back({"progressive_friction_slope", first.value, first.std, "N/m"});
  } else {
    out.push_back({effect, first.value, first.std, "N s/m"});
  }
}

void RigSearch::describe_sides(Chosen& c, const Judged& now, const ColumnSet& set) const {
  const auto place = [&](RigColumn::Kind kind) {
    return std::find_if(set.begin(), set.end(),
                        [&](Eigen::Index i) {
                          return library_.columns[static_cast<std::size_t>(i)].kind == kind;
                        }) -
           set.begin();
  };
  const auto odd = place(RigColumn::Kind::kVelocity);
  const auto even = place(RigColumn::Kind::kSpeed);
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
void RigSearch::describe_drift(Chosen& c, const Judged& now, const ColumnSet& set) const {
  const Eigen::Index at = place_of(set, c.candidate.columns.front());
  const RigColumn& drifting =
      library_.columns[static_cast<std::size_t>(set[static_cast<std::size_t>(at)])];
  const double change = now.fit.theta[at];
  const double std = std::sqrt(std::max(now.fit.covariance(at, at), 0.0));
  if (drifting.kind == RigColumn::Kind::kOne) {
    c.step.parameters.front() = {c.step.parameters.front().name, change, std, "N"};
    return;
  }
  double of = 0.0;
  for (std::size_t i = 0; i < set.size(); ++i) {
    const RigColumn& steady = library_.columns[static_cast<std::size_t>(set[i])];
    const bool same = steady.kind == drifting.kind ||
                      (drifting.kind != RigColumn::Kind::kVelocity &&
                       drifting.kind != RigColumn::Kind::kDeflection && library_.base_friction &&
                       set[i] == library_.friction[now.width]);
    if (same && steady.time == RigColumn::Time::kSteady)
      of = now.fit.theta[static_cast<Eigen::Index>(i)];
  }
  if (of == 0.0) return;
  const double percent = 100.0 / std::abs(of);
  c.step.parameters.front().value = percent * std::copysign(1.0, of) * change;
  c.step.parameters.front().std = percent * std;
}

void RigSearch::describe_steps(const Judged& now) {
  const ColumnSet set = set_of(chosen_columns(), now.width);
  for (Chosen& c : chosen_) {
    if (c.step.effect == "time_skew" || c.step.effect == "impulsive_input" ||
        c.candidate.columns.empty())
      continue;
    if (c.step.effect == "time_drift") {
      describe_drift(c, now, set);
      continue;
    }
    const Eigen::Index at = place_of(set, c.candidate.columns.front());
    const Estimate first{now.fit.theta[at], std::sqrt(std::max(now.fit.covariance(at, at), 0.0))};
    if (column_of(c).kind == RigColumn::Kind::kBoucWen)
      describe_bouc_wen(c, first);
    else if (c.ridge > 0.0)
      describe_bank(c, now);
    else if (c.step.effect == "asymmetric_viscous")
      describe_sides(c, now, set);
    else
      describe_small(c, first);
  }
}

}  // namespace dampline::app
