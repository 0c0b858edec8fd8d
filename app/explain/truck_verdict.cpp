// SPDX-License-Identifier: MIT
#include "app/explain/truck_verdict.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "app/explain/fault_veto.hpp"

namespace dampline::app {
namespace {

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

effect::ExplainerConfig explainer_config(const Config& config) {
  effect::ExplainerConfig out;
  out.moving_mass_kg = config.car.moving_mass_kg;
  out.base_viscous = has(config.model.base, "viscous");
  const auto& wanted = config.model.candidates;
  for (std::size_t i = 0; i < effect::kEffects; ++i) {
    const char* name = effect::name_of(static_cast<effect::Effect>(i));
    out.allowed[i] = (has(wanted, "all") || has(wanted, name)) && !has(config.model.base, name);
  }
  return out;
}

bool judge_sums(const Config& config, const effect::Diagnosis& diagnosis,
                effect::Explainer& explainer, Explained& out) {
  effect::ExplainerConfig wanted = explainer_config(config);
  disallow_mimics(out.identified.faults, wanted);
  out.explanation = explainer.explain(diagnosis, wanted);
  if (out.explanation.conclusion == effect::Conclusion::kNotReady) return false;
  out.withheld = forbids_naming(out.identified.faults);
  out.drifts = !out.withheld && drift_explains_more(out.identified.faults, out.explanation);
  if (out.withheld || out.drifts) withhold_effects(out.explanation);
  return true;
}

}  // namespace dampline::app
