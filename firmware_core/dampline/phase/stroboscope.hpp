// SPDX-License-Identifier: MIT
#pragma once
#include <cmath>
#include <cstdint>

#include "dampline/result.hpp"

namespace dampline {

/// One point of the extended phase space.
struct PhasePoint {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double accel_mps2{0.0};
};

/// Stuck points obey an inequality, not the equation of motion, and a single one that noise makes
/// look moving spoils a fit. A velocity above this many standard deviations of its noise moves: one
/// stuck point in 26 million passes.
inline constexpr double kMovingSigmas = 5.5;

[[nodiscard]] inline bool is_finite(const PhasePoint& p) noexcept {
  return std::isfinite(p.deflection_m) && std::isfinite(p.velocity_mps) &&
         std::isfinite(p.accel_mps2);
}

struct StroboscopeConfig {
  double period_s{0.0};
  double first_s{0.0};  ///< time of some flash of phase 0
  int phases{1};        ///< flashes per period, equally spaced
};

/// A point of a stroboscopic (Poincare) section.
struct SectionPoint {
  bool taken{false};
  int phase{0};
  double time_s{0.0};
  PhasePoint point;
};

/// Looks at a motion at fixed phases of a period. Between samples the deflection follows the cubic
/// that has the samples' deflections and velocities, the velocity the one that has the samples'
/// velocities and accelerations; the acceleration is linear.
///
/// Flashes closer together than two samples, and those in a gap (more than `max_step_s` between
/// samples), are passed over: at most one point per sample.
class Stroboscope {
 public:
  /// kInvalidConfig unless the period is finite and above 0 and there is at least one phase.
  [[nodiscard]] static Result<Stroboscope> make(const StroboscopeConfig& config,
                                                double max_step_s) noexcept;

  /// The time does not run backwards; a sample that is not later than the last starts afresh.
  [[nodiscard]] SectionPoint update(double time_s, const PhasePoint& point) noexcept;

  /// Forgets the last sample: what follows is not its neighbour.
  void restart() noexcept { has_last_ = false; }

  [[nodiscard]] const StroboscopeConfig& config() const noexcept { return config_; }

 private:
  [[nodiscard]] double flash_number(double time_s) const noexcept {
    return std::floor((time_s - config_.first_s) * config_.phases / config_.period_s);
  }

  StroboscopeConfig config_;
  double max_step_s_{0.0};
  bool has_last_{false};
  double last_time_s_{0.0};
  PhasePoint last_;
};

}  // namespace dampline
