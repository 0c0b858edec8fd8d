// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/diagnosis/common/json.hpp"
#include "app/diagnosis/common/residual.hpp"
#include "app/diagnosis/rig/regression.hpp"
#include "app/run/result.hpp"

namespace dampline::app::rig {

/// One effect that was added to a rig's force.
struct Step {
  std::string effect;
  std::string of{"force_n"};       ///< whose error is meant
  std::vector<std::string> terms;  ///< of the model with it
  double held_out_before{0.0};     ///< nmse
  double held_out_after{0.0};
  double gain{0.0};     ///< beside a constant and a spring, which every comparison carries
  double block_t{0.0};  ///< mean over deviation of the mean of the blocks' improvements
  std::vector<Parameter> parameters;
  std::vector<JudgedCandidate> runners_up;
};

/// A model of the force: which columns, their coefficients.
struct Model {
  std::vector<std::string> terms;
  std::vector<Regressor> columns;
  Fit fit;
  std::vector<Parameter> parameters;
  double skew_s{0.0};             ///< the force is late by this
  Mode path;                      ///< that the force passes before it is measured
  double floor_nmse{0.0};         ///< what the law leaves of its own surrogate; 0: not known
  double floor_noise_share{0.0};  ///< of it, what the noise of the force makes
  /// What is left, over that.
  [[nodiscard]] double left_over_floor() const noexcept {
    return floor_nmse > 0.0 ? fit.held_out_nmse / floor_nmse : 0.0;
  }
};

/// Errors on a record that was never fitted. The force sets nothing but the slip at the start,
/// from the first second.
struct Validated {
  std::string record;
  double rrse_before{0.0};
  double rrse_after{0.0};
  double start_m{0.0};
  bool has_reference{false};
  double reference_rrse{0.0};  ///< over the samples that the reference has
  double same_rows_rrse{0.0};  ///< of the final model over the same samples
  std::vector<PredictedRow> rows;
};

struct Explanation {
  std::vector<std::string> records;
  Model base;
  Model final;
  std::vector<Step> steps;
  std::vector<JudgedCandidate> rejected;  ///< the best of the round that added nothing
  std::vector<Validated> validation;
  double filter_hz{0.0};  ///< corner of the test function; 0: none
  bool whole_records{false};
  Evidence evidence;               ///< but for its JSON
  Signature signature;             ///< of what the final model leaves
  std::vector<std::string> notes;  ///< how the records were read, a sentence each
  std::string alike;               ///< effects that explain alike, so that none is named; empty
  [[nodiscard]] const char* verdict() const;
  /// No more is left than noise and resolution make.
  [[nodiscard]] bool is_complete() const noexcept;
  static constexpr double kIncompleteAbove = 1.5;  ///< times the floor that noise makes
  static constexpr double kMotionAbove = 3.0;      ///< times what errors of the motion make
  static constexpr double kNegligible = 1e-5;      ///< nmse that no rig is held to
};

/// As explanation.json holds it.
[[nodiscard]] std::string to_json(const Explanation& explanation);
/// For a terminal.
[[nodiscard]] std::string summarize(const Explanation& explanation);

/// The force of a model at the rows that were made for it.
[[nodiscard]] Eigen::VectorXd model_force(const Model& model, const Rows& rows);

/// A record with what the model says of its instants and of the force's path.
[[nodiscard]] Series seen_by(const Model& model, const Series& series);

/// What the report shows of an explanation, and what is left: fills `evidence` but for its JSON,
/// and `signature`.
void gather_evidence(const std::vector<Series>& records, Explanation& explanation);

}  // namespace dampline::app::rig
