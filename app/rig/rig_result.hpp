// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>

#include "app/run/result.hpp"
#include "dampline/rig/rig_identifier.hpp"
#include "dampline/rig/rig_predictor.hpp"

namespace dampline::app {

/// What is known of a rig's record when it is over.
struct RigFindings {
  RigTerms terms;
  RigConfig config;
  RigSnapshot snapshot;
  RigErrors errors;
  /// Where no spring was in the model: what one would change.
  std::optional<RigSnapshot> with_spring;
  std::int64_t ticks{0};
  std::uint64_t still_samples{0};
  int latency_samples{0};
};

/// Parameters, curve, counts, fit, verdicts and notes.
[[nodiscard]] RunResult describe_rig(const RigFindings& findings);

}  // namespace dampline::app
