// SPDX-License-Identifier: MIT
#include "sim_hw/effects/impulses.hpp"

#include <cmath>
#include <numbers>

namespace dampline::sim {

TrackPoint dip(double position_m, double depth_m, double length_m, double spacing_m) noexcept {
  const double x = position_m - spacing_m * std::floor(position_m / spacing_m);
  if (x >= length_m) return {};
  const double k = std::numbers::pi / length_m;
  const double s = std::sin(k * x);
  const double c = std::cos(k * x);
  return {-4.0 * depth_m * k * s * s * s * c,
          -4.0 * depth_m * k * k * s * s * (3.0 * c * c - s * s)};
}

Shocks::Shocks(const ImpulseEffects& config, std::uint64_t seed)
    : peak_n_(config.shock_force_n),
      rate_hz_(config.shock_rate_hz),
      duration_s_(config.shock_duration_s),
      random_(seed, Stream::kShocks) {
  draw(0.0);
}

void Shocks::draw(double after_s) noexcept {
  start_s_ = after_s - std::log(1.0 - random_.uniform()) / rate_hz_;
  sign_ = random_.uniform() < 0.5 ? -1.0 : 1.0;
}

double Shocks::force_n(double time_s) noexcept {
  if (peak_n_ == 0.0) return 0.0;
  while (time_s >= start_s_ + duration_s_) draw(start_s_ + duration_s_);
  if (time_s < start_s_) return 0.0;
  return sign_ * peak_n_ * std::sin(std::numbers::pi * (time_s - start_s_) / duration_s_);
}

}  // namespace dampline::sim
