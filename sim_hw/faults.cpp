// SPDX-License-Identifier: MIT
#include "sim_hw/faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "sim_hw/effects/registry.hpp"

namespace dampline::sim {
namespace {

struct Range {
  std::string_view name;
  double fallback;
  double minimum;
  double maximum;
};

constexpr double kAnyTime = 1e9;
constexpr std::array<Range, 1> kLoss{{{"fraction", 0.05, 0.0, 1.0}}};
constexpr std::array<Range, 2> kSwap{
    {{"fraction", 0.0, 0.0, 1.0}, {"time_s", -1.0, -1.0, kAnyTime}}};
constexpr std::array<Range, 2> kClipping{
    {{"channel", 1.0, 0.0, 2.0}, {"range_mps2", 3.0, 1e-3, 1e4}}};
constexpr std::array<Range, 2> kSoftClipping{
    {{"channel", 1.0, 0.0, 2.0}, {"limit_mps2", 3.0, 1e-3, 1e4}}};
constexpr std::array<Range, 3> kStuck{{{"channel", 1.0, 0.0, 2.0},
                                       {"start_s", 100.0, 0.0, kAnyTime},
                                       {"end_s", 130.0, 0.0, kAnyTime}}};

using Values = std::span<const double>;
std::size_t channel_of(Values v) { return static_cast<std::size_t>(v[0]); }

struct Fault {
  std::string_view name;
  std::span<const Range> parameters;
  void (*set)(SimulationConfig& config, TransportConfig& transport, Values values);
};

constexpr std::array<Fault, 5> kFaults{{
    {"loss", kLoss,
     [](SimulationConfig&, TransportConfig& transport, Values v) {
       transport.loss_fraction = v[0];
     }},
    {"swap", kSwap,
     [](SimulationConfig&, TransportConfig& transport, Values v) {
       transport.swap_fraction = v[0];
       transport.swap_time_s = v[1];
     }},
    {"clipping", kClipping,
     [](SimulationConfig& config, TransportConfig&, Values v) {
       config.sensors.range_mps2[channel_of(v)] = v[1];
     }},
    {"soft_clipping", kSoftClipping,
     [](SimulationConfig& config, TransportConfig&, Values v) {
       config.sensors.limit_mps2[channel_of(v)] = v[1];
     }},
    {"stuck", kStuck,
     [](SimulationConfig& config, TransportConfig&, Values v) {
       config.sensors.stuck_start_s[channel_of(v)] = v[1];
       config.sensors.stuck_end_s[channel_of(v)] = v[2];
     }},
}};

template <class Items>
std::string names_of(const Items& items) {
  std::string text;
  for (const auto& item : items) {
    if (!text.empty()) text += ", ";
    text += item.name;
  }
  return text;
}

std::optional<std::string> fill(const Fault& fault, const EffectValues& given,
                                std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = fault.parameters[i].fallback;
  for (const auto& [name, value] : given) {
    const auto found = std::ranges::find(fault.parameters, name, &Range::name);
    if (found == fault.parameters.end()) {
      return fmt::format("fault {}: unknown parameter '{}', expected one of {}", fault.name, name,
                         names_of(fault.parameters));
    }
    if (!(value >= found->minimum && value <= found->maximum)) {
      return fmt::format("fault {}: {} is {}, expected {} to {}", fault.name, name, value,
                         found->minimum, found->maximum);
    }
    values[static_cast<std::size_t>(found - fault.parameters.begin())] = value;
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> add_fault_text(SimulationConfig& config, TransportConfig& transport,
                                          std::string_view text) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const std::string_view name = text.substr(0, colon);
  const auto fault = std::ranges::find(kFaults, name, &Fault::name);
  if (fault == kFaults.end()) {
    return fmt::format("unknown fault '{}', expected one of {}", name, names_of(kFaults));
  }
  EffectValues given;
  if (auto error = parse_values(text.substr(std::min(colon + 1, text.size())), given)) {
    return fmt::format("fault {}: {}", name, *error);
  }
  std::array<double, 3> values{};
  const auto used = std::span{values}.first(fault->parameters.size());
  if (auto error = fill(*fault, given, used)) return error;
  fault->set(config, transport, used);
  return std::nullopt;
}

}  // namespace dampline::sim
