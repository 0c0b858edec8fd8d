// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/diagnosis/rig/thresholds.hpp"
#include "app/law/start.hpp"
#include "app/run/provenance.hpp"

namespace dampline::app::rig {
namespace {

using Part = law::Unknown::Part;

constexpr double kBlockTurns = 4.0;         // of the corner, in a mean
constexpr double kMedianOfSquare = 0.4549;  // of a normal deviate

/// Instead of a term's number.
enum NoTerm : int { kMass = -1, kNone = -2 };

/// Where the model's columns stand in the law.
std::vector<int> terms_of(const Model& model) {
  std::vector<int> out;
  int next = 0;
  for (const Regressor& c : model.columns)
    out.push_back(is_inertia(c.kind) ? kMass : c.time == Regressor::Time::kSteady ? next++ : kNone);
  return out;
}

/// The unknowns of a law, and where each stands among what was fitted together.
struct Places {
  std::vector<law::Unknown> unknowns;
  std::vector<Eigen::Index> at;
};

Places places_of(const Model& model, const Joint& joint) {
  const std::vector<int> term = terms_of(model);
  Places out;
  for (std::size_t i = 0; i < term.size(); ++i) {
    if (term[i] == kNone) continue;
    law::Unknown u{"m", Part::kMass, {}};
    if (term[i] != kMass)
      u = {
          fmt::format("c{}", term[i] + 1), Part::kCoefficient, {static_cast<std::size_t>(term[i])}};
    out.unknowns.push_back(std::move(u));
    out.at.push_back(static_cast<Eigen::Index>(i));
  }
  for (std::size_t k = 0; joint.ok && k < joint.places.size(); ++k) {
    const Place& place = joint.places[k];
    const bool a = place.of == Place::Of::kA;
    law::Unknown u{"", a ? Part::kA : Part::kB, {}};
    for (const std::size_t c : place.columns)
      if (term[c] >= 0) u.terms.push_back(static_cast<std::size_t>(term[c]));
    if (u.terms.empty()) continue;  // of the record
    u.name = fmt::format("{}{}", a ? 'a' : 'b', u.terms.front() + 1);
    out.unknowns.push_back(std::move(u));
    out.at.push_back(static_cast<Eigen::Index>(joint.coefficients + k));
  }
  return out;
}

/// Deviations no less than half of what the halves of the record differ by where that is certain.
Eigen::MatrixXd widened(Eigen::MatrixXd covariance, const Eigen::VectorXd& half_difference) {
  for (Eigen::Index i = 0; i < std::min(covariance.rows(), half_difference.size()); ++i) {
    const double std = std::sqrt(std::max(covariance(i, i), 0.0));
    const double times = std > 0.0 ? 0.5 * std::abs(half_difference[i]) / std : 0.0;
    if (times <= kHalvesApart) continue;
    covariance.row(i) *= times;
    covariance.col(i) *= times;
  }
  return covariance;
}

std::vector<std::string> left_out_of(const Model& model) {
  std::vector<std::string> out;
  if (model.skew_s != 0.0)
    out.push_back(fmt::format("time_skew: the force was late by {:.4g} ms", 1e3 * model.skew_s));
  if (model.path.hz > 0.0)
    out.push_back(
        fmt::format("unmodelled_mode: the force passed a mode of {:.4g} Hz, damping ratio {:.3g}",
                    model.path.hz, model.path.damping));
  const auto drifts = [](const Regressor& c) { return c.time != Regressor::Time::kSteady; };
  if (!model.changes.empty() || std::any_of(model.columns.begin(), model.columns.end(), drifts))
    out.emplace_back("time_drift: a parameter changed over the record");
  return out;
}

/// One-sided density of a force well below a corner, by the median of its means over blocks in
/// squares: where the mass sticks, nobody knows what friction takes.
double density_below(double corner_hz, const Eigen::VectorXd& force_n, double interval_s) {
  const auto block = static_cast<Eigen::Index>(kBlockTurns / (corner_hz * interval_s)) + 1;
  std::vector<double> squares;
  for (Eigen::Index i = 0; i + block <= force_n.size(); i += block)
    squares.push_back(std::pow(force_n.segment(i, block).mean(), 2));
  if (squares.empty()) return 0.0;
  return 2.0 * static_cast<double>(block) * interval_s * median_of(squares) / kMedianOfSquare;
}

/// What the law's motion from its initial state leaves of the record's.
double motion_left(const law::Document& law, const Series& series) {
  const law::Course course =
      law::move(law.law, law::Input{series.force_n, series.interval_s}, law.initial);
  if (!course.whole) return 0.0;
  return std::sqrt((course.deflection_m - series.deflection_m).squaredNorm() /
                   static_cast<double>(series.size()));
}

}  // namespace

bool is_sharp(const Regressor& c, const Scale& scale) {
  switch (c.kind) {
    case Kind::kSign:
      return !is_smooth(c, scale);
    case Kind::kStop:
      return !is_memory_travel(c.a, scale);
    case Kind::kFading:
    case Kind::kFadingSquare:
    case Kind::kFadingSlowly:
    case Kind::kProgressive:
    case Kind::kProgressiveAbsolute:
      return true;
    default:
      return false;
  }
}

std::optional<law::Law> law_of(const Model& model, const Scale& scale) {
  if (model.skew_s != 0.0 || model.path.hz > 0.0 || !model.changes.empty() || model.ridge > 0.0)
    return std::nullopt;
  law::Law out;
  for (std::size_t i = 0; i < model.columns.size(); ++i) {
    const double value = model.fit.theta[static_cast<Eigen::Index>(i)];
    if (is_inertia(model.columns[i].kind))
      out.mass_kg += value;
    else
      out.terms.push_back({model.columns[i], value, is_sharp(model.columns[i], scale)});
  }
  if (!law::FreeRun::can(out)) return std::nullopt;
  return out;
}

law::Document document_of(const Model& model, const Joint& joint, const Scale& scale) {
  law::Document out;
  for (std::size_t i = 0; i < model.columns.size(); ++i) {
    const Regressor& c = model.columns[i];
    const double value = model.fit.theta[static_cast<Eigen::Index>(i)];
    if (is_inertia(c.kind))
      out.law.mass_kg += value;
    else if (c.time == Regressor::Time::kSteady)
      out.law.terms.push_back({c, value, is_sharp(c, scale)});
  }
  const Places places = places_of(model, joint);
  const Eigen::MatrixXd all = joint.ok ? widened(joint.covariance, joint.half_difference)
                                       : widened(model.fit.covariance, model.fit.half_difference);
  out.unknowns = places.unknowns;
  out.covariance = all(places.at, places.at);
  if (const auto& own = model.for_free_run)
    out.free_run = {own->unknowns(places.at), own->covariance(places.at, places.at), own->start};
  const bool filtered = is_filtered(model.columns);
  out.subject = filtered ? law::Subject::kDrivenMass : law::Subject::kDamper;
  out.not_in_it = left_out_of(model);
  return out;
}

void measure_left(const Model& model, const Series& series, law::Document& out) {
  out.record = series.record;
  out.sample_rate_hz = 1.0 / series.interval_s;
  if (is_filtered(model.columns)) out.filter_hz = series.config.corner_hz;
  out.zero_m = series.zero_m;
  out.force_sign = series.force_sign;
  const Rows rows = rows_of(model.columns, seen_by(model, series), 1);
  const Eigen::VectorXd left_n = rows.values.rightCols<1>() - model_force(model, rows);
  if (left_n.size() > 0)
    out.residual_n = std::sqrt(left_n.squaredNorm() / static_cast<double>(left_n.size()));
  if (out.subject != law::Subject::kDrivenMass || !law::FreeRun::can(out.law) || series.has_gap)
    return;
  if (series.size() < 2) return;
  out.initial = law::start_of(out.law, {series.force_n, series.deflection_m, series.velocity_mps,
                                        series.interval_s, series.noise_m});
  out.residual_m = motion_left(out, series);
  if (out.free_run) {
    out.free_run->record_sha256 = describe_record(series.record).sha256;
    out.free_run->residual_m = motion_left(out.for_free_run(), series);
  }
  if (model.free_run.segments > 0 && !model.free_run.followed)
    out.lacking_n2_hz = density_below(out.filter_hz, left_n, series.interval_s);
}

std::vector<Regressor> columns_of(const law::Document& document) {
  std::vector<Regressor> out;
  if (document.law.mass_kg > 0.0)
    out.push_back(
        {document.subject == law::Subject::kDrivenMass ? Kind::kInertia : Kind::kAcceleration});
  for (const law::Term& t : document.law.terms) out.push_back(t.column);
  return out;
}

Eigen::VectorXd theta_of(const law::Law& law) {
  const Eigen::Index mass = law.mass_kg > 0.0 ? 1 : 0;
  Eigen::VectorXd out{mass + static_cast<Eigen::Index>(law.terms.size())};
  if (mass > 0) out[0] = law.mass_kg;
  for (std::size_t i = 0; i < law.terms.size(); ++i)
    out[mass + static_cast<Eigen::Index>(i)] = law.terms[i].coefficient;
  return out;
}

}  // namespace dampline::app::rig
