// SPDX-License-Identifier: MIT
#include "dampline/effect/conclusion.hpp"

#include <algorithm>
#include <limits>

#include "dampline/effect/rules.hpp"

namespace dampline::effect {
namespace {

constexpr double kUnexplainedAboveWithImpacts = 1.5;
constexpr std::uint64_t kImpacts = 10;
constexpr double kDrivesZ = 2.0;
constexpr double kOfNothingZ = 2.0;

/// Damping that surely gives energy.
bool drives(const Step& step) noexcept {
  const auto end = step.parameter.begin() + static_cast<std::ptrdiff_t>(step.parameter_count);
  return is_damping(step.chosen.effect) &&
         std::any_of(step.parameter.begin(), end, [](const auto& parameter) {
           return parameter.estimate.value < -kDrivesZ * parameter.estimate.std;
         });
}

}  // namespace

const char* name_of(Conclusion conclusion) noexcept {
  switch (conclusion) {
    case Conclusion::kNotReady:
      return "not_ready";
    case Conclusion::kComplete:
      return "complete";
    case Conclusion::kExplained:
      return "explained";
    case Conclusion::kPartlyExplained:
      return "partly_explained";
    case Conclusion::kUnexplained:
      break;
  }
  return "unexplained";
}

double base_error(const Explanation& e) noexcept {
  const bool restated = e.step_count > 0 && e.base_restated_nmse > 0.0;
  return restated ? e.base_restated_nmse : e.base.held_out_nmse;
}

double floor_ratio(const Explanation& e) noexcept {
  if (!(e.floor_nmse > 0.0)) return 0.0;
  return e.final.held_out_nmse / e.floor_nmse;
}

bool is_possible(const Explanation& e) noexcept {
  const auto steps = e.steps();
  const Estimate& level = e.final_coulomb_n;
  const bool of_nothing = level.value < kOfNothingZ * level.std &&
                          std::any_of(steps.begin(), steps.end(), [](const Step& step) {
                            return has_memory(step.chosen.effect);
                          });
  return level.value > 0.0 && e.final_stiffness_npm.value > 0.0 && !of_nothing &&
         std::none_of(steps.begin(), steps.end(), drives);
}

void conclude(std::uint64_t impacts, Explanation& e, double unexplained_above) noexcept {
  const double ratio = is_possible(e) ? floor_ratio(e) : std::numeric_limits<double>::infinity();
  const double limit = impacts >= kImpacts
                           ? std::max(kUnexplainedAboveWithImpacts, unexplained_above)
                           : unexplained_above;
  if (e.step_count == 0) {
    e.conclusion = ratio > limit ? Conclusion::kUnexplained : Conclusion::kComplete;
  } else {
    e.conclusion = ratio > kIncompleteAbove ? Conclusion::kPartlyExplained : Conclusion::kExplained;
  }
}

Model law_part(const Explanation& e) noexcept {
  Model out = e.base_model;
  for (std::size_t i = e.base_count; i < e.model.count; ++i) {
    if (is_of_law(e.model.effect[i].effect)) out = out.with(e.model.effect[i]);
  }
  return out;
}

void drop_steps(Explanation& e) noexcept {
  e.step_count = 0;
  e.model = e.base_model;
  e.final = e.base;
  e.weight = e.base_weight;
  e.target = e.base_target;
  e.floor_nmse = e.base_floor_nmse;
  e.final_coulomb_n = e.base_coulomb_n;
  e.final_stiffness_npm = e.base_stiffness_npm;
}

}  // namespace dampline::effect
