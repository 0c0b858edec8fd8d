// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/state.hpp"

#include <algorithm>
#include <utility>

#include "app/diagnosis/rig/regression.hpp"

namespace dampline::app::rig {

State::State(const Config& config, const std::vector<Series>& given)
    : records{given}, scale{scale_of(given)}, library{make_library(config, scale)} {
  evaluate_columns(*this);
}

namespace {

void evaluate(State& s, std::vector<Equations> equations) {
  Regression regression{equations};
  s.evaluated =
      std::make_shared<const Evaluated>(Evaluated{std::move(equations), std::move(regression)});
}

}  // namespace

void evaluate_columns(State& s) { evaluate(s, equations_of(s.library.columns, s.records)); }

void evaluate_added(State& s) {
  const std::vector<Equations>& before = s.evaluated->equations;
  const Eigen::Index known = before.front().values.cols() - 1;
  const auto first = s.library.columns.begin() + known;
  if (filtered(s) != is_filtered({s.library.columns.begin(), first})) return evaluate_columns(s);
  std::vector<Equations> all =
      equations_of({first, s.library.columns.end()}, s.records, filtered(s));
  for (std::size_t r = 0; r < all.size(); ++r) {
    Eigen::MatrixXd values{all[r].values.rows(), known + all[r].values.cols()};
    values << before[r].values.leftCols(known), all[r].values;
    all[r].values = std::move(values);
  }
  evaluate(s, std::move(all));
}

bool has_friction(const State& s) { return s.library.base_friction && s.base_friction_left; }

ColumnSet beside_both(const State& s, const ColumnSet& more) {
  return joined(joined(chosen_columns(s), {s.library.spring, s.library.offset}), more);
}

bool filtered(const State& s) { return is_filtered(s.library.columns); }

ColumnSet set_of(const State& s, const ColumnSet& more, std::size_t width) {
  ColumnSet out;
  if (has_friction(s)) out.push_back(s.library.friction[width]);
  out = joined(out, s.library.base);
  if (s.spring_added) out = joined(out, {s.library.spring});
  if (s.mass_added) out = joined(out, {s.library.mass});
  return joined(out, more);
}

double ridge(const State& s) {
  double out = 0.0;
  for (const Chosen& c : s.chosen) out = std::max(out, c.ridge);
  return out;
}

Judged judge(const State& s, const ColumnSet& more) {
  Judged best;
  const bool profiled = has_friction(s);
  for (std::size_t w = 0; w < (profiled ? s.library.friction.size() : 1); ++w) {
    ColumnSet set = set_of(s, more, w);
    Fit fit = s.evaluated->regression.fit(set, ridge(s));
    if (fit.beats(best.fit)) best = {std::move(fit), w, std::move(set)};
  }
  return best;
}

std::size_t count_of_base(const State& s) {
  return static_cast<std::size_t>(
      std::count_if(s.chosen.begin(), s.chosen.end(), [](const Chosen& c) { return c.of_base; }));
}

ColumnSet chosen_columns(const State& s) {
  ColumnSet out;
  for (const Chosen& c : s.chosen) out = joined(out, c.candidate.columns);
  return out;
}

std::vector<Regressor> columns_of(const State& s, const ColumnSet& set) {
  std::vector<Regressor> out;
  out.reserve(set.size());
  for (const Eigen::Index i : set) out.push_back(s.library.at(i));
  return out;
}

Floor floor_of(const State& s, const ColumnSet& more) {
  const Judged judged = judge(s, more);
  if (!judged.fit.ok) return {};
  return surrogate_floor(s.records, {columns_of(s, judged.set), judged.fit.theta,
                                     columns_of(s, s.library.friction), ridge(s), s.scale});
}

/// The way to write sign v that a fit has of the base's friction.
bool is_friction(const State& s, Eigen::Index column, const Judged& judged) {
  return s.library.base_friction && column == s.library.friction[judged.width];
}

bool can_add(const State& s, const Candidate& candidate) {
  return std::none_of(s.chosen.begin(), s.chosen.end(), [&](const Chosen& c) {
    return c.candidate.effect == candidate.effect ||
           (is_memory(c.candidate.effect) && is_memory(candidate.effect));
  });
}

std::vector<std::string> terms(const State& s) {
  std::vector<std::string> out = s.library.base_terms;
  if (s.spring_added) out.emplace_back("linear spring");
  if (s.mass_added) out.emplace_back("moving mass");
  for (const Chosen& c : s.chosen) out.push_back(c.candidate.effect);
  return out;
}

void choose(State& s, Candidate candidate, double gain, double t) {
  Chosen chosen;
  chosen.step.effect = candidate.effect;
  chosen.candidate = std::move(candidate);
  chosen.step.gain = gain;
  chosen.step.block_t = t;
  s.chosen.push_back(std::move(chosen));
}

bool remembers(const State& s) {
  return std::any_of(s.chosen.begin(), s.chosen.end(),
                     [](const Chosen& c) { return is_memory(c.step.effect); });
}

TrialBase trial_base(const State& s) {
  TrialBase out;
  const bool sign = has_friction(s);
  ColumnSet set = set_of(s, beside_both(s), 0);
  if (sign) {
    std::erase(set, s.library.friction[0]);
    out.friction = columns_of(s, s.library.friction);
  }
  out.columns = columns_of(s, set);
  out.ridge = ridge(s);
  return out;
}

}  // namespace dampline::app::rig
