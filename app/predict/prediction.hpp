// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/law/document.hpp"

namespace dampline::app {

/// One column of a prediction's table; NaN: nothing is known there.
struct PredictionColumn {
  std::string name;  ///< with its unit: "force_n", "force_n_std", "force_n_measured"
  Eigen::VectorXd values;
};

/// How a predicted quantity and a measured one compare.
struct PredictionError {
  std::string quantity;  ///< "deflection_m"
  std::string unit;
  std::uint64_t samples{0};
  double rms{0.0};
  double nmse{0.0};          ///< sum of squares over that of the measured about its mean
  double within_share{0.0};  ///< of the samples, within two stated deviations
};

/// What a law makes of an input.
struct Prediction {
  std::string what;  ///< "force from motion", "motion from force", "frame motion from wheelsets"
  std::string record;
  double sample_rate_hz{0.0};
  std::vector<PredictionColumn> columns;  ///< time_s first
  std::vector<PredictionError> errors;    ///< none where the output was not measured
  std::vector<std::string> notes;
};

/// What a law's numbers make of an input; empty where it runs away.
using LawOutcome = std::function<Eigen::VectorXd(const law::Law&)>;

/// Deviation of each value of an outcome that the uncertainty of the law's numbers makes: halves of
/// the differences a deviation to either side along the principal axes of their correlation, summed
/// in squares. Infinite where a law so near runs away.
[[nodiscard]] Eigen::VectorXd deviation_of(const law::Document& document, const LawOutcome& outcome,
                                           Eigen::Index size);

/// Appends NAME, NAME_std and, where `measured` is not empty, NAME_measured, and the error of the
/// samples from `from` on. `left`: rms of what the law left of its own record, part of the
/// deviation.
void add_quantity(const std::string& name, const std::string& unit, const Eigen::VectorXd& values,
                  const Eigen::VectorXd& std, double left, const Eigen::VectorXd& measured,
                  Eigen::Index from, Prediction& out);

/// The table: a header and a row for each sample.
void write_prediction(const Prediction& prediction, const std::string& file, bool replace);
/// For a terminal, and as JSON.
[[nodiscard]] std::string prediction_text(const Prediction& prediction);
[[nodiscard]] std::string prediction_json(const Prediction& prediction);

}  // namespace dampline::app
