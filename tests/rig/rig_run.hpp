// SPDX-License-Identifier: MIT
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "dampline/rig/identifier.hpp"
#include "dampline/rig/predictor.hpp"
#include "dampline/rig/survey.hpp"

namespace dampline::test {

/// A record through survey, identification and prediction.
struct RigRun {
  rig::Config config;
  rig::Snapshot snapshot;
  rig::Errors errors;

  [[nodiscard]] Estimate of(rig::Parameter parameter) const {
    for (std::size_t i = 0; i < snapshot.size; ++i)
      if (snapshot.estimates[i].parameter == parameter) return snapshot.estimates[i].estimate;
    ADD_FAILURE() << "parameter " << static_cast<int>(parameter) << " was not identified";
    return {};
  }
};

inline std::unique_ptr<rig::Identifier> identify(std::span<const rig::Sample> record,
                                                 const rig::Config& config) {
  auto identifier = std::make_unique<rig::Identifier>(config);
  for (const rig::Sample& sample : record) identifier->update(sample);
  return identifier;
}

inline RigRun run_rig(std::span<const rig::Sample> record, double rate_hz,
                      const rig::Terms& terms) {
  rig::Survey survey{rate_hz, !record.empty() && std::isfinite(record.front().velocity_mps)};
  for (const rig::Sample& sample : record) survey.update(sample);
  RigRun out;
  out.config = survey.suggest(terms).value();
  const auto identifier = identify(record, out.config);
  out.snapshot = identifier->snapshot(terms);
  const auto predictor = std::make_unique<rig::Predictor>(out.config, identifier->solution(terms),
                                                          identifier->block_samples());
  rig::Prediction prediction;
  for (const rig::Sample& sample : record) predictor->update(sample, prediction);
  out.errors = predictor->errors();
  return out;
}

/// Relative error in percent.
inline double percent(double value, double truth) { return 100.0 * std::abs(value / truth - 1.0); }

}  // namespace dampline::test
