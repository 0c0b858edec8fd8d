// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "dampline/effect/grids.hpp"
#include "dampline/effect/model_fit.hpp"
#include "dampline/explanation.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::effect {

/// One effect that was added.
struct Step {
  static constexpr std::size_t kMostRunnersUp = 4;
  static constexpr std::size_t kMostParameters = 4;
  Candidate chosen;
  double place{0.0};        ///< in the effect's grid, refined between its points
  double line_offset{0.0};  ///< of a mode between its line of the grid and the next
  double held_out_nmse_before{0.0};
  double held_out_nmse_after{0.0};
  double gain{0.0};             ///< 1 - after / before, in the weights of the model before
  double restated_before{0.0};  ///< held-out errors in the weights of the final model
  double restated_after{0.0};
  double block_t{0.0};        ///< mean over deviation of the mean of the entries' improvements
  double coefficient_t{0.0};  ///< its first coefficient over the deviation
  std::size_t runner_up_count{0};
  std::array<RunnerUp, kMostRunnersUp> runner_up{};
  std::array<Candidate, kMostRunnersUp> other{};  ///< what the runners-up are
  std::size_t parameter_count{0};
  std::array<EffectParameter, kMostParameters> parameter{};  ///< of the final model
};

struct Explanation {
  static constexpr std::size_t kMostSteps = 4;
  Conclusion conclusion{Conclusion::kNotReady};
  ModelFit base;
  ModelFit final;
  Model base_model;
  Model model;                     ///< the final one: base, then steps
  Grids grids;                     ///< of the effects' variants
  std::size_t base_count{0};       ///< effects of the base
  ScaleWeights base_weight{};      ///< of the scales in base's errors
  ScaleWeights weight{};           ///< of the scales in final's errors
  double base_restated_nmse{0.0};  ///< held-out error of base in final's weights; 0: no steps
  double base_target{0.0};         ///< sum of squares that base's errors are shares of
  double target{0.0};              ///< the same of final's
  std::size_t step_count{0};
  std::array<Step, kMostSteps> step{};
  Step rejected;                ///< the best candidate that did not pass, when there was one
  double base_floor_nmse{0.0};  ///< the floor in base's weights; 0: unknown
  /// What the sensors and the law's width leave of a complete model, to compare with
  /// final.held_out_nmse; 0: unknown.
  double floor_nmse{0.0};
  /// Coefficients in newtons: friction and spring of base and final model.
  Estimate base_coulomb_n, base_stiffness_npm, final_coulomb_n, final_stiffness_npm;

  [[nodiscard]] std::span<Step> steps() noexcept { return {step.data(), step_count}; }
  [[nodiscard]] std::span<const Step> steps() const noexcept { return {step.data(), step_count}; }
};

/// Held-out error of the base in the weights of the final model, which the steps and the final
/// error are in.
[[nodiscard]] double base_error(const Explanation& explanation) noexcept;
/// What is left over what a complete model leaves; 0 where that is unknown.
[[nodiscard]] double floor_ratio(const Explanation& explanation) noexcept;
/// Friction and spring of the final model are more than nothing, surely so of a friction that is
/// said to build up, and what damps takes energy. Otherwise no floor can be computed, and no law of
/// such a model is one of a suspension.
[[nodiscard]] bool is_possible(const Explanation& explanation) noexcept;
/// Above it, an effect is like what is missing, but its law is not complete.
inline constexpr double kIncompleteAbove = 1.5;

/// Of the floor: more that is left without a single step is unexplained.
inline constexpr double kUnexplainedAbove = 1.25;

/// Decides the conclusion from the steps and the floor; an impossible model explains nothing.
/// `impacts`: blows in the input, which every model leaves a little of.
void conclude(std::uint64_t impacts, Explanation& explanation,
              double unexplained_above = kUnexplainedAbove) noexcept;

/// The base and what was added to its law.
[[nodiscard]] Model law_part(const Explanation& explanation) noexcept;

/// Takes back all steps: what is left is the base's.
void drop_steps(Explanation& explanation) noexcept;

}  // namespace dampline::effect
