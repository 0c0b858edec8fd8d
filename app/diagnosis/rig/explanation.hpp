// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/diagnosis/common/explanation.hpp"
#include "app/diagnosis/rig/regression.hpp"
#include "app/law/document.hpp"
#include "app/run/result.hpp"

namespace dampline::app::rig {

/// A change of the friction over the record, as a share of it.
struct Change {
  Regressor::Time time{Regressor::Time::kSlope};
  double at{0.0};  ///< share of the record, of a step
  int side{0};     ///< of the force: 1 or -1; 0: both
};

/// Figures by which a law that misses something moves as its record does, where those of its
/// equations leave less of the force: unknowns of the joint fit.
struct ForFreeRun {
  Eigen::VectorXd unknowns;
  Eigen::MatrixXd covariance;
  law::State start;  ///< at the first sample of the first record
};

/// A model of the force: which columns, their coefficients.
struct Model {
  std::vector<std::string> terms;
  std::vector<Regressor> columns;
  Fit fit;
  std::vector<Parameter> parameters;
  /// Of `parameters`, those that are a coefficient: which one, by its place in the fit.
  std::vector<std::pair<std::size_t, Eigen::Index>> coefficients;
  double ridge{0.0};            ///< of the fit
  int friction{-1};             ///< the column that is the base's sign of v; -1: none
  std::vector<Change> changes;  ///< of the friction; its columns follow the others
  double skew_s{0.0};           ///< the force is late by this
  Mode path;                    ///< that the force passes before it is measured
  FreeRunError free_run;
  std::optional<ForFreeRun> for_free_run;
  law::Document law;              ///< of a final model: law.json
  double floor_nmse{0.0};         ///< what the law leaves of its own surrogate; 0: not known
  double floor_noise_share{0.0};  ///< of it, what the noise of the force makes
  const char* floor_by{""};       ///< what makes it
  /// What is left, over that.
  [[nodiscard]] double left_over_floor() const noexcept {
    return floor_nmse > 0.0 ? fit.held_out_nmse / floor_nmse : 0.0;
  }
};

struct Validated : app::Validated {
  std::vector<PredictedRow> rows;
};

/// What the search found, with what it is made of.
struct Explanation {
  std::vector<std::string> records;
  Model base;
  Model final;
  std::vector<Step> steps;
  std::vector<JudgedCandidate> rejected;  ///< the best of the round that added nothing
  std::vector<Validated> validation;
  double filter_hz{0.0};  ///< corner of the test function; 0: none
  bool whole_records{false};
  Evidence evidence;                 ///< but for its JSON
  Signature signature;               ///< of what the final model leaves
  Convergence convergence;           ///< of the final model's coefficients, over all records
  std::vector<std::string> notes;    ///< how the records were read, a sentence each
  std::vector<FaultFinding> faults;  ///< of all records
  std::string alike;                 ///< effects that explain alike, so that none is named; empty
  std::string impossible;            ///< figures below zero that cannot be; empty
  [[nodiscard]] const char* verdict() const;
  /// No more is left than noise and resolution make.
  [[nodiscard]] bool is_complete() const noexcept;
};

/// Puts the final law and the explanation into what identify says of the first record, and judges
/// both.
app::Explanation conclude(const Explanation& explanation, RunResult& result);
/// Judged, as conclude() does.
[[nodiscard]] app::Explanation told(const Explanation& explanation);
[[nodiscard]] inline std::string to_json(const Explanation& e) { return to_json(told(e)); }
[[nodiscard]] inline std::string summarize(const Explanation& e) { return summarize(told(e)); }

/// The force of a model at the rows that were made for it.
[[nodiscard]] Eigen::VectorXd model_force(const Model& model, const Rows& rows);

/// A record with what the model says of its instants and of the force's path.
[[nodiscard]] Series seen_by(const Model& model, const Series& series);

/// What the report shows of an explanation, and what is left: fills `evidence` but for its JSON,
/// `signature` and `convergence`.
void gather_evidence(const std::vector<Series>& records, Explanation& explanation);

}  // namespace dampline::app::rig
