// SPDX-License-Identifier: MIT
#include "app/explain/fault_veto.hpp"

#include <algorithm>
#include <string_view>

namespace dampline::app {
namespace {

constexpr double kMoreGain = 0.02;

bool is_harmless(std::string_view name, std::string_view channel) {
  if (name == "lost_samples" || name == "repeated_samples") return channel == "all";
  return name == "stuck_channel" || name == "wrong_sample_rate";
}

}  // namespace

bool forbids_naming(const DataFaults& faults) noexcept {
  return !std::all_of(faults.list.begin(), faults.list.end(),
                      [](const FaultFinding& f) { return is_harmless(f.name, f.channel); });
}

bool faults_forbid_naming(std::span<const Fault> faults) noexcept {
  return !std::all_of(faults.begin(), faults.end(), [](const Fault& f) {
    return is_harmless(name_of(f.kind), name_of(f.channel));
  });
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
