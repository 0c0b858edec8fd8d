// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/joint.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "app/diagnosis/rig/regression.hpp"
#include "app/diagnosis/rig/thresholds.hpp"
#include "app/diagnosis/rig/trials.hpp"

namespace dampline::app::rig {
namespace {

using Of = Place::Of;

constexpr double kOfLength = 0.01;  // of a travel, gap or width: the step of a difference
constexpr double kOfSpeed = 0.02;
constexpr double kOfShape = 0.02;
constexpr double kOfFrequency = 0.003;
constexpr double kOfDamping = 0.05;
constexpr double kOfSample = 0.1;
constexpr int kHalvings = 3;

/// Kinds that share a length.
Kind family_of(Kind kind) {
  if (kind == Kind::kBumpDown) return Kind::kBumpUp;
  if (kind == Kind::kGapDown) return Kind::kGapUp;
  return kind;
}

void add_places(const Regressor& c, std::size_t column, const Scale& scale, const Model& model,
                std::vector<Place>& out) {
  const auto add = [&](Of of, double step) {
    for (Place& p : out) {
      const bool shared = p.of == of && of == Of::kA && !p.columns.empty() &&
                          family_of(model.columns[p.columns[0]].kind) == family_of(c.kind) &&
                          model.columns[p.columns[0]].a == c.a;
      if (!shared) continue;
      p.columns.push_back(column);
      return;
    }
    out.push_back({of, {column}, step});
  };
  switch (c.kind) {
    case Kind::kFading:
    case Kind::kFadingSquare:
    case Kind::kFadingSlowly:
      return add(Of::kB, kOfSpeed * c.b);
    case Kind::kSign:
      if (is_smooth(c, scale)) add(Of::kA, kOfLength * c.a);
      return;
    case Kind::kStop:
      if (is_memory_travel(c.a, scale)) add(Of::kA, kOfLength * c.a);
      return;
    case Kind::kBumpUp:
    case Kind::kBumpDown:
    case Kind::kGapUp:
    case Kind::kGapDown:
    case Kind::kEdge:
    case Kind::kMaxwell:
      return add(Of::kA, kOfLength * c.a);
    case Kind::kBoucWen:
      add(Of::kA, kOfLength * c.a);
      return add(Of::kB, kOfShape);
    case Kind::kAttached:
      add(Of::kA, kOfFrequency * c.a);
      return add(Of::kB, kOfDamping * c.b);
    default:
      return;
  }
}

std::vector<Place> places_of(const Model& model, const std::vector<Series>& records,
                             const Scale& scale) {
  std::vector<Place> out;
  for (std::size_t c = 0; c < model.columns.size(); ++c)
    add_places(model.columns[c], c, scale, model, out);
  if (model.skew_s != 0.0) out.push_back({Of::kSkew, {}, kOfSample * records.front().interval_s});
  if (model.path.hz > 0.0) {
    out.push_back({Of::kFrequency, {}, kOfFrequency * model.path.hz});
    out.push_back({Of::kDamping, {}, kOfDamping * model.path.damping});
  }
  return out;
}

double& value_of(Model& model, const Place& p) {
  switch (p.of) {
    case Of::kA:
      return model.columns[p.columns[0]].a;
    case Of::kB:
      return model.columns[p.columns[0]].b;
    case Of::kSkew:
      return model.skew_s;
    case Of::kFrequency:
      return model.path.hz;
    default:
      return model.path.damping;
  }
}

void move(const Place& p, double by, Model& model, std::vector<Series>& records) {
  const double to = value_of(model, p) + by;
  value_of(model, p) = to;
  for (const std::size_t c : p.columns)
    (p.of == Of::kA ? model.columns[c].a : model.columns[c].b) = to;
  for (Series& r : records) {
    if (p.of == Of::kSkew) r = delayed(r, by);
    if (p.of == Of::kFrequency || p.of == Of::kDamping) r.path = model.path;
  }
}

/// What a place moves of the force, with it elsewhere and the coefficients as they are.
std::vector<Eigen::VectorXd> forces_at(Model model, std::vector<Series> records, const Place& p,
                                       double by) {
  move(p, by, model, records);
  std::vector<Regressor> columns;
  std::vector<double> theta;
  for (std::size_t c = 0; c < model.columns.size(); ++c) {
    if (!p.columns.empty() && std::count(p.columns.begin(), p.columns.end(), c) == 0) continue;
    columns.push_back(model.columns[c]);
    theta.push_back(model.fit.theta[static_cast<Eigen::Index>(c)]);
  }
  const Eigen::VectorXd coefficients = vector_of(theta);
  std::vector<Eigen::VectorXd> out;
  for (const Equations& e : equations_of(columns, records, is_filtered(model.columns)))
    out.emplace_back(e.values.leftCols(coefficients.size()) * coefficients);
  return out;
}

/// Puts columns before the force.
void insert(const Eigen::MatrixXd& more, Equations& equations) {
  const Eigen::Index n = equations.values.cols() - 1;
  Eigen::MatrixXd all{equations.values.rows(), n + more.cols() + 1};
  all << equations.values.leftCols(n), more, equations.values.rightCols<1>();
  equations.values = std::move(all);
}

bool is_changed(const Regressor& column, int side) {
  return is_friction_like(column) && (side == 0 || side_of(column) == side);
}

double weight_of(const Change& change, double share) {
  if (change.time == Regressor::Time::kSlope) return share - 0.5;
  return share > change.at ? 1.0 : 0.0;
}

/// The friction's part of each row's force, times what changes.
void insert_changes(const Model& model, const std::vector<Change>& changes,
                    const std::vector<Series>& records, std::vector<Equations>& equations) {
  for (std::size_t r = 0; r < equations.size(); ++r) {
    Equations& e = equations[r];
    Eigen::MatrixXd sides = Eigen::MatrixXd::Zero(e.values.rows(), 3);
    for (std::size_t c = 0; c < model.columns.size(); ++c)
      for (const int side : {-1, 0, 1})
        if (is_changed(model.columns[c], side))
          sides.col(side + 1) += model.fit.theta[static_cast<Eigen::Index>(c)] *
                                 e.values.col(static_cast<Eigen::Index>(c));
    Eigen::MatrixXd more{e.values.rows(), static_cast<Eigen::Index>(changes.size())};
    const auto whole = static_cast<double>(records[r].size() - 1);
    for (Eigen::Index i = 0; i < more.rows(); ++i)
      for (std::size_t k = 0; k < changes.size(); ++k)
        more(i, static_cast<Eigen::Index>(k)) =
            sides(i, changes[k].side + 1) *
            weight_of(changes[k],
                      static_cast<double>(e.sample[static_cast<std::size_t>(i)]) / whole);
    insert(more, e);
  }
}

ColumnSet first(std::size_t count) {
  ColumnSet out(count);
  std::iota(out.begin(), out.end(), 0);
  return out;
}

/// Coefficients, moves of the places, changes.
Fit fit_all(const Model& model, const std::vector<Series>& records,
            const std::vector<Place>& places, double ridge) {
  std::vector<Equations> equations = equations_of(model.columns, records);
  const std::vector<Equations> plain = equations;
  for (const Place& p : places) {
    const auto up = forces_at(model, records, p, p.step);
    const auto down = forces_at(model, records, p, -p.step);
    for (std::size_t r = 0; r < equations.size(); ++r)
      insert((up[r] - down[r]) / (2.0 * p.step), equations[r]);
  }
  if (!model.changes.empty()) insert_changes(model, model.changes, records, equations);
  return Regression{equations}.fit(
      first(model.columns.size() + places.size() + model.changes.size()), ridge);
}

Fit fit_linear(const Model& model, const std::vector<Series>& records, double ridge) {
  return Regression{model.columns, records}.fit(first(model.columns.size()), ridge);
}

/// Whether the places moved to where less is left.
bool step(const Fit& all, const std::vector<Place>& places, double ridge, Model& model,
          std::vector<Series>& records) {
  double share = 1.0;
  bool far = false;
  const auto n = static_cast<Eigen::Index>(model.columns.size());
  for (std::size_t k = 0; k < places.size(); ++k) {
    const Estimate by = all.estimate(n + static_cast<Eigen::Index>(k));
    const double reach =
        std::max(kLongestMove * std::abs(value_of(model, places[k])), places[k].step);
    share = std::min(share, reach / std::max(std::abs(by.value), 1e-300));
    far = far || std::abs(by.value) > kArrived * by.std;
  }
  if (!far) return false;
  for (int i = 0; i < kHalvings; ++i, share *= 0.4) {
    Model there = model;
    std::vector<Series> then = records;
    for (std::size_t k = 0; k < places.size(); ++k)
      move(places[k], share * all.theta[n + static_cast<Eigen::Index>(k)], there, then);
    Fit fit = fit_linear(there, then, ridge);
    if (!fit.beats(model.fit)) continue;
    model = std::move(there);
    model.fit = std::move(fit);
    records = std::move(then);
    return true;
  }
  return false;
}

/// A column more for each that changes.
void write_changes(const Eigen::VectorXd& shares, Model& model) {
  const std::size_t count = model.columns.size();
  std::vector<double> theta{model.fit.theta.begin(), model.fit.theta.end()};
  for (std::size_t k = 0; k < model.changes.size(); ++k)
    for (std::size_t c = 0; c < count; ++c) {
      if (!is_changed(model.columns[c], model.changes[k].side)) continue;
      model.columns.push_back(model.columns[c]);
      model.columns.back().time = model.changes[k].time;
      model.columns.back().at = model.changes[k].at;
      theta.push_back(shares[static_cast<Eigen::Index>(k)] * theta[c]);
    }
  model.fit.theta = vector_of(theta);
}

}  // namespace

Eigen::Index Joint::of_column(std::size_t column, Of of) const {
  for (std::size_t k = 0; k < places.size(); ++k)
    if (places[k].of == of &&
        std::count(places[k].columns.begin(), places[k].columns.end(), column))
      return static_cast<Eigen::Index>(coefficients + k);
  return -1;
}

Eigen::Index Joint::of_records(Of of) const {
  for (std::size_t k = 0; k < places.size(); ++k)
    if (places[k].of == of) return static_cast<Eigen::Index>(coefficients + k);
  return -1;
}

bool is_friction_like(const Regressor& column) noexcept {
  return column.kind == Kind::kSign || law::is_fading(column.kind) ||
         column.kind == Kind::kBoucWen || law::has_stop(column.kind);
}

int side_of(const Regressor& column) noexcept {
  constexpr double kMiddle = 0.5 * (Regressor::kHats - 1);
  switch (column.kind) {
    case Kind::kGapUp:
      return 1;
    case Kind::kGapDown:
      return -1;
    case Kind::kHat:
      return static_cast<int>(column.b > kMiddle) - static_cast<int>(column.b < kMiddle);
    case Kind::kFall:
    case Kind::kBreakaway:
      return column.b > 0.0 ? 1 : -1;
    default:
      return 0;
  }
}

Joint fit_jointly(Model& model, std::vector<Series>& records, double ridge, const Scale& scale) {
  Joint out;
  out.places = places_of(model, records, scale);
  out.coefficients = model.columns.size();
  model.fit = fit_linear(model, records, ridge);
  if (!model.fit.ok) return out;
  Fit all = fit_all(model, records, out.places, ridge);
  for (int i = 0; all.ok && i < kJointRounds; ++i) {
    if (!step(all, out.places, ridge, model, records)) break;
    all = fit_all(model, records, out.places, ridge);
  }
  if (!all.ok) return out;
  out.ok = true;
  out.covariance = all.covariance;
  out.half_difference = all.half_difference;
  if (model.changes.empty()) return out;
  std::vector<Equations> equations = equations_of(model.columns, records);
  insert_changes(model, model.changes, records, equations);
  const auto n = static_cast<Eigen::Index>(out.coefficients);
  Fit changed = Regression{equations}.fit(first(out.coefficients + model.changes.size()), ridge);
  if (!changed.ok) return out;
  const Eigen::VectorXd before = model.fit.theta;
  out.changes = changed.theta.tail(static_cast<Eigen::Index>(model.changes.size()));
  changed.theta = changed.theta.head(n).eval();
  model.fit = std::move(changed);
  const Eigen::VectorXd now = model.fit.theta;
  model.fit.theta = before;
  write_changes(out.changes, model);
  model.fit.theta.head(n) = now;
  return out;
}

std::optional<Trial> try_change(const Model& model, const std::vector<Series>& records,
                                double ridge) {
  const std::vector<double> places = places_of_steps(records);
  std::vector<Change> changes;
  for (const int side : {0, 1, -1}) {
    changes.push_back({Regressor::Time::kSlope, 0.0, side});
    for (const double place : places) changes.push_back({Regressor::Time::kStep, place, side});
  }
  std::vector<Equations> equations = equations_of(model.columns, records);
  insert_changes(model, changes, records, equations);
  const Regression regression{equations};
  const std::size_t n = model.columns.size();
  const Fit without = regression.fit(first(n), ridge);
  if (!without.ok) return std::nullopt;
  Trial best;
  best.effect = "time_drift";
  best.parameter = "coulomb";
  best.fit = without;
  const auto look = [&](const std::vector<std::size_t>& set, double clearly) {
    ColumnSet columns = first(n);
    for (const std::size_t k : set) columns.push_back(static_cast<Eigen::Index>(n + k));
    Fit fit = regression.fit(columns, ridge);
    if (!fit.ok || fit.held_out_nmse >= clearly * best.fit.held_out_nmse) return;
    best.fit = std::move(fit);
    best.changes.clear();
    for (const std::size_t k : set) best.changes.push_back(changes[k]);
    const int side = changes[set[0]].side;
    best.parameter = side == 0 ? "coulomb" : side > 0 ? "coulomb_positive" : "coulomb_negative";
    best.at_share = set.size() == 1 ? changes[set[0]].at : 0.0;
  };
  for (std::size_t k = 0; k < changes.size(); ++k) look({k}, 1.0);
  for (std::size_t from = 0; from < changes.size() && places.size() > 1;
       from += 1 + places.size()) {
    std::vector<std::size_t> steps(places.size());
    std::iota(steps.begin(), steps.end(), from + 1);
    look(steps, kBetter);
  }
  if (best.changes.empty()) return std::nullopt;
  const Fit with = best.fit;
  best.judge(without, with);
  return best;
}

Model with_unknowns(Model model, const Joint& joint, const Eigen::VectorXd& unknowns) {
  const auto n = static_cast<Eigen::Index>(joint.coefficients);
  model.fit.theta = unknowns.head(n);
  for (std::size_t k = 0; k < joint.places.size(); ++k)
    for (const std::size_t c : joint.places[k].columns)
      (joint.places[k].of == Place::Of::kA ? model.columns[c].a : model.columns[c].b) =
          unknowns[n + static_cast<Eigen::Index>(k)];
  return model;
}

Eigen::VectorXd unknowns_of(const Model& model, const Joint& joint) {
  const auto n = static_cast<Eigen::Index>(joint.coefficients);
  Eigen::VectorXd out{n + static_cast<Eigen::Index>(joint.places.size())};
  out.head(n) = model.fit.theta;
  for (std::size_t k = 0; k < joint.places.size(); ++k) {
    const Regressor& c = model.columns[joint.places[k].columns[0]];
    out[n + static_cast<Eigen::Index>(k)] = joint.places[k].of == Place::Of::kA ? c.a : c.b;
  }
  return out;
}

}  // namespace dampline::app::rig
