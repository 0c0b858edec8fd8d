// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/config/config.hpp"
#include "app/predict/prediction.hpp"

namespace dampline::app {

struct PredictOptions {
  std::string input;
  bool skip_bad_lines{false};
};

/// The force that a rig's law gives for the motion that a record holds, seen as the law's fit saw
/// it: of a driven mass behind its test function. Throws RunError, UsageError.
[[nodiscard]] Prediction predict_force(const law::Document& document, const Config& config,
                                       const PredictOptions& options);

/// The motion of a driven mass under the force that a record holds, and nothing else. It starts as
/// the record does where that holds the deflection, otherwise at rest. Throws RunError, UsageError
/// for a law that cannot be moved.
[[nodiscard]] Prediction predict_motion(const law::Document& document, const Config& config,
                                        const PredictOptions& options);

}  // namespace dampline::app
