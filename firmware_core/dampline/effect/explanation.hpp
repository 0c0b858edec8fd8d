// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/effect/model_fit.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::effect {

enum class Conclusion : std::uint8_t {
  kNotReady,         ///< too little data
  kComplete,         ///< nothing passes, and what is left is not more than the sensors make
  kExplained,        ///< effects were added and what is left is near the floor
  kPartlyExplained,  ///< effects were added, something is left
  kUnexplained,      ///< something real is left that no effect explains
};
[[nodiscard]] const char* name_of(Conclusion conclusion) noexcept;

struct EffectParameter {
  const char* name{""};
  Estimate estimate;
  const char* unit{""};
};

struct RunnerUp {
  Effect effect{Effect::kUnknown};
  double held_out_nmse{0.0};
};

/// One effect that was added.
struct Step {
  static constexpr std::size_t kMostRunnersUp = 4;
  static constexpr std::size_t kMostParameters = 4;
  Candidate chosen;
  double place{0.0};  ///< in the effect's grid, refined between its points
  double place_std{0.0};
  double held_out_nmse_before{0.0};
  double held_out_nmse_after{0.0};
  double gain{0.0};     ///< 1 - after / before
  double block_t{0.0};  ///< mean over deviation of the mean of the entries' improvements
  std::size_t runner_up_count{0};
  std::array<RunnerUp, kMostRunnersUp> runner_up{};
  std::size_t parameter_count{0};
  std::array<EffectParameter, kMostParameters> parameter{};  ///< of the final model
};

struct Explanation {
  static constexpr std::size_t kMostSteps = 4;
  Conclusion conclusion{Conclusion::kNotReady};
  ModelFit base;
  ModelFit final;
  Model base_model;
  Model model;                ///< the final one: base, then steps
  std::size_t base_count{0};  ///< effects of the base
  ScaleWeights weight{};      ///< of the scales in final's errors
  std::size_t step_count{0};
  std::array<Step, kMostSteps> step{};
  Step rejected;  ///< the best candidate that did not pass, when there was one
  double floor_nmse{
      0.0};  ///< what the sensors and the law's width leave of a complete model; 0: unknown
  /// Coefficients in newtons: friction and spring of base and final model.
  Estimate base_coulomb_n, base_stiffness_npm, final_coulomb_n, final_stiffness_npm;
};

}  // namespace dampline::effect
