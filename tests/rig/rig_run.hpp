// SPDX-License-Identifier: MIT
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "dampline/rig/rig_identifier.hpp"
#include "dampline/rig/rig_predictor.hpp"
#include "dampline/rig/rig_survey.hpp"

namespace dampline::test {

/// A record through survey, identification and prediction.
struct RigRun {
  RigConfig config;
  RigSnapshot snapshot;
  RigErrors errors;

  [[nodiscard]] Estimate of(RigParameter parameter) const {
    for (std::size_t i = 0; i < snapshot.size; ++i)
      if (snapshot.estimates[i].parameter == parameter) return snapshot.estimates[i].estimate;
    ADD_FAILURE() << "parameter " << static_cast<int>(parameter) << " was not identified";
    return {};
  }
};

inline std::unique_ptr<RigIdentifier> identify(std::span<const RigSample> record,
                                               const RigConfig& config) {
  auto identifier = std::make_unique<RigIdentifier>(config);
  for (const RigSample& sample : record) identifier->update(sample);
  return identifier;
}

inline RigRun run_rig(std::span<const RigSample> record, double rate_hz, const RigTerms& terms) {
  RigSurvey survey{rate_hz, !record.empty() && std::isfinite(record.front().velocity_mps)};
  for (const RigSample& sample : record) survey.update(sample);
  RigRun out;
  out.config = survey.suggest(terms).value();
  const auto identifier = identify(record, out.config);
  out.snapshot = identifier->snapshot(terms);
  const auto predictor = std::make_unique<RigPredictor>(out.config, identifier->solution(terms),
                                                        identifier->block_samples());
  RigPrediction prediction;
  for (const RigSample& sample : record) predictor->update(sample, prediction);
  out.errors = predictor->errors();
  return out;
}

/// Relative error in percent.
inline double percent(double value, double truth) { return 100.0 * std::abs(value / truth - 1.0); }

}  // namespace dampline::test
