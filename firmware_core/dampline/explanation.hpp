// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>

#include "dampline/snapshot.hpp"

/// The words in which the core says what a model of the suspension lacks: effects, conclusions,
/// parameters. Plain data. The whole finding with its models and grids is effect::Explanation in
/// effect/conclusion.hpp; effect::Explainer makes it, from sums and not from samples, in some
/// hundred small fits. Each effect's regressor and grid: effect/columns.hpp.
namespace dampline::effect {

/// What a model may lack.
enum class Effect : std::uint8_t {
  kViscous,
  kAsymmetricViscous,
  kQuadraticDamping,
  kViscoelastic,
  kProgressiveFriction,
  kStribeck,
  kPreslidingHysteresis,
  kBacklash,
  kBumpStop,
  kCubicStiffness,
  kQuadraticStiffness,
  kAsymmetricStiffness,
  kUnmodelledMode,
  kTimeSkew,
  kGainError,
  kImpulsiveInput,
  kUnknown,
};
inline constexpr std::size_t kEffects = static_cast<std::size_t>(Effect::kUnknown) + 1;

/// Friction that depends on where the motion turned.
[[nodiscard]] constexpr bool has_memory(Effect effect) noexcept {
  return effect == Effect::kPreslidingHysteresis || effect == Effect::kBacklash;
}

/// A part of the suspension's force: neither another motion nor a sensor's fault.
[[nodiscard]] constexpr bool is_of_law(Effect effect) noexcept {
  return effect < Effect::kUnmodelledMode;
}

/// The name that configuration, results and simulation use.
[[nodiscard]] const char* name_of(Effect effect) noexcept;

enum class Conclusion : std::uint8_t {
  kNotReady,         ///< too little data
  kComplete,         ///< nothing passes, and what is left is not more than the sensors make
  kExplained,        ///< effects were added and what is left is near the floor
  kPartlyExplained,  ///< effects were added, something is left
  kUnexplained,      ///< something real is left that no effect explains
};
[[nodiscard]] const char* name_of(Conclusion conclusion) noexcept;

/// A physical parameter of an effect that was added, and its unit.
struct EffectParameter {
  const char* name{""};
  Estimate estimate;
  const char* unit{""};
  /// The parameter of the same law that this one is most correlated with: its own name, coulomb,
  /// stiffness or law_width.
  const char* twin{""};
  double correlation{0.0};
};
/// Beyond it two parameters are not separable in this record: only what they do together is known.
inline constexpr double kInseparable = 0.95;

/// An effect that explained less than the one that was added. Errors are shares of the target's sum
/// of squares, of entries that took no part in the fit.
struct RunnerUp {
  Effect effect{Effect::kUnknown};
  double held_out_nmse{0.0};
  double gain{0.0};           ///< 1 - held_out_nmse / that of the model without it
  double block_t{0.0};        ///< mean over deviation of the mean of the entries' improvements
  double coefficient_t{0.0};  ///< its first coefficient over the deviation
};

}  // namespace dampline::effect
