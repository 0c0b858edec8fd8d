// SPDX-License-Identifier: MIT
#include "dampline/effect/judgement.hpp"

#include <algorithm>

#include "dampline/sample/hole_bridge.hpp"

namespace dampline::effect {
namespace {

constexpr double kMoreGain = 0.02;
// Share of samples with values put in: their errors ring as modes do.
constexpr double kRough = 0.05;

bool passes(FaultKind kind) noexcept {
  return kind == FaultKind::kSpikes || kind == FaultKind::kDcJump || kind == FaultKind::kNoiseBurst;
}

bool is_harmless(const Fault& fault) noexcept {
  if (fault.kind == FaultKind::kLostSamples || fault.kind == FaultKind::kRepeatedSamples)
    return fault.channel == FaultChannel::kAll;
  return fault.kind == FaultKind::kStuckChannel || fault.kind == FaultKind::kWrongSampleRate;
}

}  // namespace

Circumstances circumstances_of(const FaultView& faults, const ParameterDrift& drift) noexcept {
  Circumstances out{faults, drift};
  hold_against_faults(out.faults, out.drift);
  return out;
}

void withhold_effects(Explanation& explanation) noexcept {
  if (explanation.step_count == 0) return;
  drop_steps(explanation);
  explanation.conclusion = Conclusion::kUnexplained;
}

void name_nothing_impossible(Explanation& explanation) noexcept {
  if (!is_possible(explanation)) withhold_effects(explanation);
}

bool forbids_naming(const FaultView& faults) noexcept {
  const bool repaired = faults.repairs.replaced + faults.repairs.spoilt > 0;
  const auto list = faults.list();
  return !std::all_of(list.begin(), list.end(), [repaired](const Fault& fault) {
    return is_harmless(fault) || (repaired && passes(fault.kind));
  });
}

void disallow_mimics(const FaultView& faults, ExplainerConfig& config) noexcept {
  const auto list = faults.list();
  const bool passed =
      std::any_of(list.begin(), list.end(), [](const Fault& fault) { return passes(fault.kind); });
  const auto disallow = [&config](Effect effect) {
    config.allowed[static_cast<std::size_t>(effect)] = false;
  };
  const double bridged = faults.repairs.bridged.share;
  if (passed || bridged > HoleBridge::kMany) disallow(Effect::kImpulsiveInput);
  if (bridged > kRough) disallow(Effect::kUnmodelledMode);
}

bool drift_explains_more(const ParameterDrift& drift, const Explanation& explanation) noexcept {
  if (!drift.found) return false;
  return explanation.step_count == 0 || drift.gain > explanation.step[0].gain + kMoreGain;
}

void judge(const Sums& sums, ExplainerConfig config, const Circumstances& circumstances,
           Explainer& explainer, Judgement& out) noexcept {
  disallow_mimics(circumstances.faults, config);
  out.explanation = explainer.explain(sums, config);
  if (out.explanation.conclusion == Conclusion::kNotReady) return;
  out.withheld = forbids_naming(circumstances.faults);
  name_nothing_impossible(out.explanation);
  out.drifts = !out.withheld && drift_explains_more(circumstances.drift, out.explanation);
  if (out.withheld || out.drifts) withhold_effects(out.explanation);
}

}  // namespace dampline::effect
