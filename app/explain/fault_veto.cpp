// SPDX-License-Identifier: MIT
#include "app/explain/fault_veto.hpp"

#include <algorithm>
#include <string_view>

namespace dampline::app {
namespace {

constexpr double kMoreGain = 0.02;

bool passes(const FaultFinding& fault) {
  return fault.name == "spikes" || fault.name == "dc_jump" || fault.name == "noise_burst";
}

bool is_harmless(std::string_view name, std::string_view channel) {
  if (name == "lost_samples" || name == "repeated_samples") return channel == "all";
  return name == "stuck_channel" || name == "wrong_sample_rate";
}

}  // namespace

bool forbids_naming(const DataFaults& faults) noexcept {
  const bool repaired = faults.values_replaced + faults.samples_spoilt > 0;
  return !std::all_of(faults.list.begin(), faults.list.end(), [repaired](const FaultFinding& f) {
    return is_harmless(f.name, f.channel) || (repaired && passes(f));
  });
}

bool faults_forbid_naming(std::span<const Fault> faults) noexcept {
  return !std::all_of(faults.begin(), faults.end(), [](const Fault& f) {
    return is_harmless(name_of(f.kind), name_of(f.channel));
  });
}

void disallow_mimics(const DataFaults& faults, effect::ExplainerConfig& config) noexcept {
  if (std::any_of(faults.list.begin(), faults.list.end(), passes))
    config.allowed[static_cast<std::size_t>(effect::Effect::kImpulsiveInput)] = false;
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
