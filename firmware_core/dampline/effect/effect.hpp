// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>

namespace dampline::effect {

/// What a model may lack.
enum class Effect : std::uint8_t {
  kViscous,
  kAsymmetricViscous,
  kQuadraticDamping,
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

/// The name that configuration, results and simulation use.
[[nodiscard]] const char* name_of(Effect effect) noexcept;

}  // namespace dampline::effect
