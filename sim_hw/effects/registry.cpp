// SPDX-License-Identifier: MIT
#include "sim_hw/effects/registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace dampline::sim {
namespace {

double scaled(double nominal, Strength how, double strength) {
  switch (how) {
    case Strength::kTimes:
      return nominal * strength;
    case Strength::kDivide:
      return nominal / strength;
    case Strength::kAboutOne:
      return 1.0 + (nominal - 1.0) * strength;
    case Strength::kNone:
      break;
  }
  return nominal;
}

std::optional<std::string> outside(std::string_view effect, std::string_view name, Domain domain,
                                   double value) {
  const bool good =
      std::isfinite(value) &&
      (domain == Domain::kAny || (domain == Domain::kPositive ? value > 0.0 : value >= 0.0));
  if (good) return std::nullopt;
  return fmt::format("effect {}: {} is {}, expected a {}number", effect, name, value,
                     domain == Domain::kAny        ? "finite "
                     : domain == Domain::kPositive ? "positive "
                                                   : "non-negative ");
}

std::optional<std::string> check(const Effect& effect, const EffectValues& values) {
  for (const auto& [name, value] : values) {
    if (name == "strength") {
      if (auto error = outside(effect.name, name, Domain::kPositive, value)) return error;
      continue;
    }
    const auto found = std::ranges::find(effect.parameters, name, &EffectParameter::name);
    if (found == effect.parameters.end()) {
      return fmt::format("effect {}: unknown parameter '{}', expected one of {}, strength",
                         effect.name, name, names_of(effect.parameters));
    }
    if (auto error = outside(effect.name, name, found->domain, value)) return error;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> parse_values(std::string_view text, EffectValues& values) {
  constexpr std::array<std::string_view, kChannels> kNames{"frame", "wheelset1", "wheelset2"};
  while (!text.empty()) {
    const std::string_view item = text.substr(0, text.find(','));
    text.remove_prefix(std::min(text.size(), item.size() + 1));
    const std::size_t equals = std::min(item.find('='), item.size());
    const std::string_view number = item.substr(std::min(equals + 1, item.size()));
    double value = 0.0;
    const char* const end = number.data() + number.size();
    const auto [stop, error] = std::from_chars(number.data(), end, value);
    if (const auto named = std::ranges::find(kNames, number); named != kNames.end()) {
      value = static_cast<double>(named - kNames.begin());
    } else if (error != std::errc{} || stop != end) {
      return fmt::format("'{}' is not of the form parameter=number", item);
    }
    values.emplace_back(item.substr(0, equals), value);
  }
  return std::nullopt;
}

std::optional<std::string> add_effect(SimulationConfig& config, std::string_view name,
                                      const EffectValues& values) {
  const auto effect = std::ranges::find(effects(), name, &Effect::name);
  if (effect == effects().end()) {
    return fmt::format("unknown effect '{}', expected one of {}", name, names_of(effects()));
  }
  if (auto error = check(*effect, values)) return error;
  const auto given = [&](std::string_view wanted) {
    return std::ranges::find(values, wanted, &EffectValues::value_type::first);
  };
  const auto factor = given("strength");
  const double strength = factor == values.end() ? 1.0 : factor->second;
  const SimulationConfig before = config;  // nominal values are those of the unchanged car
  for (const EffectParameter& parameter : effect->parameters) {
    const auto own = given(parameter.name);
    parameter.set(config, own != values.end()
                              ? own->second
                              : scaled(parameter.nominal(before), parameter.strength, strength));
  }
  return std::nullopt;
}

std::optional<std::string> add_effect_text(SimulationConfig& config, std::string_view text) {
  const std::size_t colon = text.find(':');
  EffectValues values;
  if (colon != std::string_view::npos) {
    if (auto error = parse_values(text.substr(colon + 1), values)) {
      return fmt::format("effect {}: {}", text.substr(0, colon), *error);
    }
  }
  return add_effect(config, text.substr(0, colon), values);
}

}  // namespace dampline::sim
