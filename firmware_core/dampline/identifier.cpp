// SPDX-License-Identifier: MIT
#include "dampline/identifier.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {

AssemblerConfig assembler_config(const IdentifierConfig& config) noexcept {
  return {config.signals, config.extra_signals, config.estimator.sample_rate_hz};
}

GuardConfig guard_config(const IdentifierConfig& config) noexcept {
  GuardConfig out = config.guard;
  out.sample_rate_hz = config.estimator.sample_rate_hz;
  out.step_mps2 = config.estimator.screen.step_mps2;
  out.anti_alias = config.estimator.anti_alias;
  return out;
}

std::size_t delay_samples(const IdentifierConfig& config) noexcept {
  return static_cast<std::size_t>(
      std::llround(config.judgement_delay_s * config.estimator.sample_rate_hz));
}

FokkerPlanckConfig density_config(const EstimatorConfig& config) noexcept {
  FokkerPlanckConfig out;
  out.sample_rate_hz = config.sample_rate_hz;
  out.curve_nodes_mps = config.curve_nodes_mps;
  out.anti_alias_corner_hz = ReferenceLowPass::seen_behind(config.anti_alias).corner_hz;
  if (config.memory == Memory::kForgetting) out.memory_s = config.memory_s;
  if (config.memory == Memory::kWindow) out.memory_s = std::max(0.5 * config.memory_s, 2.0);
  return out;
}

}  // namespace dampline
