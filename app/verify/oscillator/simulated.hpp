// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "dampline/sample.hpp"

namespace dampline::sim {

/// A mass on a base that moves, per unit mass:
///   z'' = -a_base - c v - k z - k3 z^3 - c3 z^2 v - (F + f |z|) sign v,   v = z',
/// z the deflection of the mass against the base. The mass sticks while the other forces do not
/// exceed friction.
struct OscillatorConfig {
  double viscous_ps{0.0};              ///< c
  double stiffness_ps2{0.0};           ///< k
  double cubic_stiffness_pm2s2{0.0};   ///< k3
  double quadratic_viscous_pm2s{0.0};  ///< c3
  double coulomb_mps2{0.0};            ///< F
  double coulomb_slope_ps2{0.0};       ///< f
};

/// Base acceleration at start, middle and end of a step; a parabola in between.
struct BaseMotion {
  double start_mps2;
  double middle_mps2;
  double end_mps2;
};

/// Fourth-order Runge-Kutta between the events of friction: a step is cut where the velocity
/// reaches zero and where the mass breaks loose.
class Oscillator {
 public:
  explicit Oscillator(const OscillatorConfig& config) noexcept : config_{config} {}

  /// At rest or moving; the friction before the first step is that of `velocity_mps`.
  void set_motion(double deflection_m, double velocity_mps) noexcept;
  void step(const BaseMotion& base, double step_s) noexcept;

  [[nodiscard]] double deflection_m() const noexcept { return state_.z; }
  [[nodiscard]] double velocity_mps() const noexcept { return state_.v; }
  [[nodiscard]] bool sticks() const noexcept { return direction_ == 0; }
  /// Absolute acceleration of the mass while the base accelerates by `base_mps2`.
  [[nodiscard]] double mass_accel_mps2(double base_mps2) const noexcept {
    return sticks() ? base_mps2 : accel(state_, base_mps2) + base_mps2;
  }

 private:
  struct State {
    double z;
    double v;
  };
  [[nodiscard]] double accel(const State& at, double base_mps2) const noexcept;
  [[nodiscard]] State moved(const BaseMotion& base, double from, double to,
                            double step_s) const noexcept;
  [[nodiscard]] double slide(const BaseMotion& base, double from, double step_s) noexcept;
  [[nodiscard]] double stick(const BaseMotion& base, double from) noexcept;
  /// The direction in which a mass at rest starts, 0 when it sticks.
  [[nodiscard]] int start_direction(double base_mps2) const noexcept;
  [[nodiscard]] bool has_friction() const noexcept {
    return config_.coulomb_mps2 != 0.0 || config_.coulomb_slope_ps2 != 0.0;
  }

  OscillatorConfig config_;
  State state_{0.0, 0.0};
  int direction_{1};
};

/// Two accelerometers, one on the mass and one on its base.
struct AccelerometerRunConfig {
  OscillatorConfig oscillator{};
  double duration_s{50.0};
  double sample_rate_hz{300.0};
  /// The base accelerates by white noise between these corners (second-order high pass,
  /// fourth-order low pass), with this rms.
  double base_rms_mps2{2.0};
  double lowest_hz{0.5};
  double highest_hz{30.0};
  double anti_alias_hz{100.0};  ///< fourth-order Butterworth on both channels; 0: none
  int bits{12};                 ///< over -+ full_scale_mps2; 0: not quantised
  double full_scale_mps2{2.0 * kStandardGravityMps2};
  double noise_lsb{0.5};  ///< rms before quantisation
  double mass_bias_mps2{0.21};
  double base_bias_mps2{-0.13};
  std::uint64_t seed{1};
};

struct AccelerometerRun {
  std::vector<double> mass_mps2;  ///< what the sensors give
  std::vector<double> base_mps2;
  std::vector<double> deflection_m;  ///< the truth at the same instants
  std::vector<double> velocity_mps;
  double mass_rms_mps2{0.0};  ///< of the acceleration of the mass, before the sensor
  double stick_share{0.0};    ///< of the time
};

/// Integrates at 32 steps a sample and samples what the sensors see.
[[nodiscard]] AccelerometerRun run_accelerometers(const AccelerometerRunConfig& config);

/// The rms of the base at which the mass accelerates by `mass_rms_mps2`, found on one seed.
[[nodiscard]] double base_rms_for(AccelerometerRunConfig config, double mass_rms_mps2);

}  // namespace dampline::sim
