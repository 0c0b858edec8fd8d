// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/faults.hpp"
#include "dampline/motion/anti_alias.hpp"
#include "dampline/sample.hpp"

namespace dampline {

/// Which wheelset meets the track first.
enum class Leading : std::uint8_t { kUnknown, kWheelset1, kWheelset2 };

/// What is declared about the data. What is not known switches off the guard that needs it.
struct GuardConfig {
  double sample_rate_hz{300.0};
  std::array<double, kChannels> step_mps2{};   ///< resolution; 0: unknown
  std::array<double, kChannels> noise_mps2{};  ///< white, rms per sample; 0: unknown
  double wheelbase_m{0.0};                     ///< 0: unknown
  double speed_mps{0.0};  ///< from something else than these sensors; 0: unknown
  Leading leading{Leading::kUnknown};
  AntiAliasConfig anti_alias{};
};

}  // namespace dampline
