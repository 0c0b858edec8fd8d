// SPDX-License-Identifier: MIT
#include "dampline/phase/stroboscope.hpp"

namespace dampline {
namespace {

/// Cubic with values a, b and slopes da, db (per step) at its ends, at share s of the step.
double hermite(double a, double b, double da, double db, double s) noexcept {
  const double r = 1.0 - s;
  return r * r * ((1.0 + 2.0 * s) * a + s * da) + s * s * ((3.0 - 2.0 * s) * b - r * db);
}

PhasePoint between(const PhasePoint& a, const PhasePoint& b, double step_s, double s) noexcept {
  return {
      hermite(a.deflection_m, b.deflection_m, step_s * a.velocity_mps, step_s * b.velocity_mps, s),
      hermite(a.velocity_mps, b.velocity_mps, step_s * a.accel_mps2, step_s * b.accel_mps2, s),
      (1.0 - s) * a.accel_mps2 + s * b.accel_mps2};
}

}  // namespace

Result<Stroboscope> Stroboscope::make(const StroboscopeConfig& config, double max_step_s) noexcept {
  if (!(config.period_s > 0.0) || !std::isfinite(config.period_s) ||
      !std::isfinite(config.first_s) || config.phases < 1 || !(max_step_s > 0.0))
    return Errc::kInvalidConfig;
  Stroboscope out;
  out.config_ = config;
  out.max_step_s_ = max_step_s;
  return out;
}

SectionPoint Stroboscope::update(double time_s, const PhasePoint& point) noexcept {
  if (!std::isfinite(time_s) || !is_finite(point)) {
    has_last_ = false;
    return {};
  }
  const PhasePoint before = last_;
  const double before_s = last_time_s_;
  const double step_s = time_s - before_s;
  const bool joined = has_last_ && step_s > 0.0 && step_s <= max_step_s_;
  last_ = point;
  last_time_s_ = time_s;
  has_last_ = true;
  if (!joined) return {};
  const double number = flash_number(time_s);
  if (number == flash_number(before_s)) return {};
  const double flash_s = config_.first_s + number * config_.period_s / config_.phases;
  const double share = std::fmin(std::fmax((flash_s - before_s) / step_s, 0.0), 1.0);
  const double cycle = std::floor(number / config_.phases);
  return {true, static_cast<int>(number - cycle * config_.phases), flash_s,
          between(before, point, step_s, share)};
}

}  // namespace dampline
