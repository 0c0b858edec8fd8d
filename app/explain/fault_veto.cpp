// SPDX-License-Identifier: MIT
#include "app/explain/fault_veto.hpp"

#include <algorithm>

namespace dampline::app {
namespace {

constexpr double kMoreGain = 0.02;

bool is_harmless(const FaultFinding& fault) {
  const bool slip = fault.name == "lost_samples" || fault.name == "repeated_samples";
  if (slip) return fault.channel == "all";
  return fault.name == "stuck_channel" || fault.name == "wrong_sample_rate";
}

}  // namespace

bool forbids_naming(const DataFaults& faults) noexcept {
  return !std::all_of(faults.list.begin(), faults.list.end(), is_harmless);
}

bool drift_explains_more(const DataFaults& faults,
                         const effect::Explanation& explanation) noexcept {
  if (!faults.drift) return false;
  return explanation.step_count == 0 || faults.drift->gain > explanation.step[0].gain + kMoreGain;
}

void withhold_effects(effect::Explanation& explanation) noexcept {
  if (explanation.step_count == 0) return;
  drop_steps(explanation);
  explanation.conclusion = effect::Conclusion::kUnexplained;
}

}  // namespace dampline::app
