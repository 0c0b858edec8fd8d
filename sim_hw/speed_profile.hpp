// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

namespace dampline::sim {

/// None where end_s <= start_s. Brakes before it and starts after it.
struct Standstill {
  double start_s{0.0};
  double end_s{0.0};
};
inline constexpr std::size_t kMostStandstills = 4;

/// The speed over the record. Changes are smooth (a quintic step) with this mean acceleration.
struct SpeedConfig {
  double speed_mps{80.0 / 3.6};
  double ramp_mps2{0.8};  ///< mean, of braking, starting and changes
  std::array<Standstill, kMostStandstills>
      standstills{};           ///< apart by braking and starting at least
  double change_time_s{-1.0};  ///< begins to change its speed here; negative: never
  double changed_speed_mps{60.0 / 3.6};
};

struct Speed {
  double speed_mps{0.0};
  double accel_mps2{0.0};
};

[[nodiscard]] Speed speed_at(const SpeedConfig& config, double time_s) noexcept;

}  // namespace dampline::sim
