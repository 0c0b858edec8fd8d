// SPDX-License-Identifier: MIT
#pragma once
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

}  // namespace dampline::sim
