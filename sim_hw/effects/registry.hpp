// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "sim_hw/simulation.hpp"

namespace dampline::sim {

/// How `strength` changes a nominal value: not, times, divided by, or its distance from 1.
enum class Strength : std::uint8_t { kNone, kTimes, kDivide, kAboutOne };

/// The least value that makes sense.
enum class Domain : std::uint8_t { kAny, kNotNegative, kPositive };

struct EffectParameter {
  std::string_view name;  ///< ends with its unit
  Domain domain;
  Strength strength;
  double (*nominal)(const SimulationConfig& config);
  void (*set)(SimulationConfig& config, double value);
};

/// One effect by the name that the whole project uses.
struct Effect {
  std::string_view name;
  std::string_view meaning;
  std::span<const EffectParameter> parameters;
};

/// Every effect that can be simulated.
[[nodiscard]] std::span<const Effect> effects() noexcept;

using EffectValues = std::vector<std::pair<std::string, double>>;

/// Adds an effect to a run. Parameters that `values` does not name take the nominal value for this
/// car, scaled by the value named "strength" (1 unless given). Returns what is wrong, or nothing;
/// then `config` is unchanged.
[[nodiscard]] std::optional<std::string> add_effect(SimulationConfig& config, std::string_view name,
                                                    const EffectValues& values = {});

/// Reads parameter=value,parameter=value. A value is a number or the name of a channel (frame,
/// wheelset1, wheelset2), which stands for its number. Returns what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> parse_values(std::string_view text, EffectValues& values);

/// add_effect() from text: NAME or NAME:parameter=value,parameter=value.
[[nodiscard]] std::optional<std::string> add_effect_text(SimulationConfig& config,
                                                         std::string_view text);

/// "a, b, c" of what has names.
template <class Items>
[[nodiscard]] std::string names_of(const Items& items) {
  std::string text;
  for (const auto& item : items) {
    if (!text.empty()) text += ", ";
    text += item.name;
  }
  return text;
}

}  // namespace dampline::sim
