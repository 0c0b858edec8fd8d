// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "dampline/phase/stroboscope.hpp"

namespace dampline::sim {

/// y'' + c y' + H1 |1 + y / y_c| sgn y' + k y + k3 y^3 = p0 + p1 sin(w t + phase), everything per
/// unit of mass. The friction of the phase-mapping literature; with y_c = 0 it is Coulomb's H1.
struct OscillatorLaw {
  double viscous_per_s{0.0};
  double friction_mps2{0.0};
  double reversal_m{0.0};  ///< y_c; 0: the friction does not depend on y
  double stiffness_per_s2{1.0};
  double cubic_per_m2s2{0.0};
  bool may_turn_negative{false};  ///< H1 (1 + y / y_c) as it was published, not its magnitude
  double creep_mps{0.0};          ///< above 0: tanh(v / creep) stands for sgn v, and nothing sticks
};

struct OscillatorDrive {
  double mean_mps2{0.0};
  double swing_mps2{0.0};
  double rate_rad_s{1.0};
  double phase_rad{0.0};
  [[nodiscard]] double at(double time_s) const noexcept;
};

/// Integrates the set-valued system: while it slips by fourth-order Runge-Kutta steps that end
/// where the velocity changes sign or the friction's magnitude has its kink, both located to
/// rounding; while it sticks exactly, until the force exceeds the friction.
class FrictionOscillator {
 public:
  FrictionOscillator(const OscillatorLaw& law, const OscillatorDrive& drive, double step_s,
                     const PhasePoint& start = {});

  /// Advances by one step, however many events it holds.
  void step();

  /// A new drive from now on, in the same state; its time goes on.
  void drive(const OscillatorDrive& next);

  [[nodiscard]] double time_s() const noexcept { return time_s_; }
  [[nodiscard]] PhasePoint point() const noexcept;
  [[nodiscard]] bool sticks() const noexcept { return sign_ == 0 && law_.creep_mps <= 0.0; }
  [[nodiscard]] double input_mps2() const noexcept { return drive_.at(time_s_); }

 private:
  struct State {
    double y{0.0};
    double v{0.0};
  };
  [[nodiscard]] double friction(double y) const noexcept;
  [[nodiscard]] double net_without_friction(double time_s, const State& s) const noexcept;
  [[nodiscard]] double accel(double time_s, const State& s) const noexcept;
  [[nodiscard]] State runge_kutta(double length_s) const noexcept;
  [[nodiscard]] bool leaves_mode(const State& s) const noexcept;
  [[nodiscard]] bool breaks_loose(double time_s) const noexcept;
  double slip(double length_s);
  double stick(double length_s);
  void choose_sign();

  OscillatorLaw law_;
  OscillatorDrive drive_;
  double step_s_;
  double time_s_{0.0};
  State state_;
  int sign_{0};  ///< of the velocity; 0: sticks
  int side_{1};  ///< of 1 + y / y_c
};

/// Stroboscopic sections of one oscillator over several regimes of its drive.
struct SectionSweep {
  std::vector<OscillatorDrive> regimes;
  int phases{8};           ///< flashes per period, from the drive's phase 0
  int periods{12};         ///< of each regime
  int skipped_periods{2};  ///< at the beginning of each regime, the oscillator runs on
  int steps_per_flash{125};
  /// Above 0: each regime begins afresh as often as `starts`, at a deflection and velocity drawn
  /// from
  /// +- this; otherwise it takes over the state of the regime before.
  double start_spread{0.0};
  int starts{1};
  double noise{0.0};  ///< sensors: standard deviation as a share of each channel's rms
  std::uint64_t seed{1};
};

struct StrobedPoint {
  PhasePoint point;  ///< with noise
  int regime{0};     ///< counts the starts of a regime as well
  int phase{0};
  double phase_rad{0.0};   ///< of the drive's sine
  double input_mps2{0.0};  ///< without noise
  bool sticks{false};
};

[[nodiscard]] std::vector<StrobedPoint> strobe(const OscillatorLaw& law, const SectionSweep& sweep);

/// Every combination of three means, three swings and three rates: the regimes in which a friction
/// of magnitude 1 moves.
[[nodiscard]] std::vector<OscillatorDrive> moving_regimes();
/// `count` regimes drawn from the same ranges.
[[nodiscard]] std::vector<OscillatorDrive> random_regimes(int count, std::uint64_t seed);

/// Steady amplitude of the deflection at the drive's rate, after `settle_periods`; 0 where it
/// sticks, infinite where it grows without bound.
[[nodiscard]] double steady_amplitude(const OscillatorLaw& law, const OscillatorDrive& drive,
                                      int settle_periods, int measured_periods,
                                      int steps_per_period);

}  // namespace dampline::sim
