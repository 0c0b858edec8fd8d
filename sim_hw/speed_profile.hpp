// SPDX-License-Identifier: MIT
#pragma once

namespace dampline::sim {

/// The speed over the record. Changes are smooth (a quintic step) with this mean acceleration.
struct SpeedConfig {
  double speed_mps{80.0 / 3.6};
  double ramp_mps2{0.8};           ///< mean acceleration of braking, starting and changes
  double standstill_start_s{0.0};  ///< stands still from here; brakes before
  double standstill_end_s{0.0};    ///< to here; no standstill where end <= start
  double change_time_s{-1.0};      ///< begins to change its speed here; negative: never
  double changed_speed_mps{60.0 / 3.6};
};

struct Speed {
  double speed_mps{0.0};
  double accel_mps2{0.0};
};

[[nodiscard]] Speed speed_at(const SpeedConfig& config, double time_s) noexcept;

}  // namespace dampline::sim
