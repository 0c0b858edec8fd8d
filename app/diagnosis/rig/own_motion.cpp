// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/own_motion.hpp"

#include <optional>
#include <utility>

#include "app/diagnosis/rig/law.hpp"
#include "app/diagnosis/rig/surrogate.hpp"
#include "app/diagnosis/rig/thresholds.hpp"
#include "app/diagnosis/rig/trials.hpp"

namespace dampline::app::rig {
namespace {

double nmse_of(const Model& model, const std::vector<Series>& records) {
  TrialBase base;
  base.columns = model.columns;
  base.ridge = model.ridge;
  return best_fit(records, base).held_out_nmse;
}

/// What the equations say of records that they know, those of a law's own motion, less that law;
/// nothing where it moves otherwise than the records, or where they leave less than `least_nmse`.
std::optional<Eigen::VectorXd> error_of_equations(const std::vector<Series>& records,
                                                  const Scale& scale, const Model& model,
                                                  const Joint& joint, double least_nmse) {
  const std::optional<law::Law> law = law_of(model, scale);
  if (!law) return std::nullopt;
  std::vector<Series> known;
  for (const Series& record : records) {
    auto moved = moved_surrogate(record, *law, 0.0, known.size());
    if (!moved) return std::nullopt;
    known.push_back(std::move(*moved));
  }
  Model again = model;
  const Joint there = fit_jointly(again, known, model.ridge, scale);
  if (!there.ok || there.size() != joint.size()) return std::nullopt;
  if (nmse_of(again, known) < least_nmse) return std::nullopt;
  return unknowns_of(again, there) - unknowns_of(model, joint);
}

}  // namespace

void correct_by_own_motion(const std::vector<Series>& records, const Scale& scale, Model& model,
                           Joint& joint) {
  const Eigen::VectorXd said = unknowns_of(model, joint);
  const Eigen::ArrayXd std = joint.covariance.diagonal().array().max(0.0).sqrt();
  const double least_nmse = kOfTheirOwn * nmse_of(model, records);
  const auto first = error_of_equations(records, scale, model, joint, least_nmse);
  if (!first) return;
  Eigen::VectorXd error = *first;
  bool found = false;
  for (int round = 0; round < kCorrections && !found; ++round) {
    if ((error.array().abs() > kMostError * (said.array().abs() + std)).any()) break;
    const auto next = error_of_equations(records, scale, with_unknowns(model, joint, said - error),
                                         joint, least_nmse);
    if (!next) break;
    const Eigen::ArrayXd allowed = kCorrected * std + kErrorStays * error.array().abs();
    found = ((*next - error).array().abs() < allowed).all();
    error = 0.5 * (error + *next);  // it swings
  }
  if (found) {
    model = with_unknowns(std::move(model), joint, said - error);
    error *= kErrorStays;
  } else {
    error = *first;
  }
  joint.covariance += error * error.transpose();
}

}  // namespace dampline::app::rig
