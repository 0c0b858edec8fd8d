// SPDX-License-Identifier: MIT
#include "sim_hw/speed_profile.hpp"

#include <cmath>

namespace dampline::sim {
namespace {

struct Step {
  double value;
  double rate_ps;
};

/// 0 before `start_s`, 1 after start_s + length_s, 6 u^5 - 15 u^4 + 10 u^3 between.
Step smooth_step(double time_s, double start_s, double length_s) noexcept {
  const double u = length_s > 0.0 ? (time_s - start_s) / length_s : (time_s < start_s ? 0.0 : 1.0);
  if (u <= 0.0) return {0.0, 0.0};
  if (u >= 1.0) return {1.0, 0.0};
  return {u * u * u * (10.0 + u * (6.0 * u - 15.0)),
          30.0 * u * u * (1.0 - u) * (1.0 - u) / length_s};
}

/// Share of the speed that the standstills leave.
Step running_share(const SpeedConfig& config, double speed_mps, double time_s) noexcept {
  const double length = speed_mps / config.ramp_mps2;
  Step share{1.0, 0.0};
  for (const Standstill& standstill : config.standstills) {
    if (!(standstill.end_s > standstill.start_s)) continue;
    const Step brake = smooth_step(time_s, standstill.start_s - length, length);
    const Step start = smooth_step(time_s, standstill.end_s, length);
    share.value = share.value - brake.value + start.value;
    share.rate_ps = share.rate_ps + start.rate_ps - brake.rate_ps;
  }
  return share;
}

}  // namespace

Speed speed_at(const SpeedConfig& config, double time_s) noexcept {
  Speed cruise{config.speed_mps, 0.0};
  if (config.change_time_s >= 0.0) {
    const double change = config.changed_speed_mps - config.speed_mps;
    const Step step =
        smooth_step(time_s, config.change_time_s, std::abs(change) / config.ramp_mps2);
    cruise.speed_mps += change * step.value;
    cruise.accel_mps2 = change * step.rate_ps;
  }
  const Step share = running_share(config, config.speed_mps, time_s);
  return {cruise.speed_mps * share.value,
          cruise.accel_mps2 * share.value + cruise.speed_mps * share.rate_ps};
}

}  // namespace dampline::sim
