// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "sim_hw/effects/laws.hpp"

namespace dampline::sim {

/// One truck of a freight car in its vertical plane:
///   M z_b'' + k y + F(v) = 0,   y = 2 z_b - (z_1 + z_2),   v = y'
/// (Kisilowski and Urbanski 1987, equation 2). Standard-order values, not a data sheet's.
struct TruckConfig {
  double moving_mass_kg{37200.0};      ///< M: frame and its share of the body
  double stiffness_npm{5.26e6};        ///< k
  double friction_positive_n{7562.0};  ///< F for v > 0
  double friction_negative_n{9150.0};  ///< -F for v < 0
  double friction_scale{1.0};          ///< multiplies both
  double law_width_mps{0.5e-3};        ///< sign v is tanh(v / width)
  double wheelbase_m{1.8};
  DampingEffects damping{};
  StiffnessEffects stiffness{};
  HysteresisEffects hysteresis{};
  ModeEffects modes{};
  DriftEffects drift{};
};

[[nodiscard]] TruckConfig laden_truck() noexcept;
[[nodiscard]] TruckConfig empty_truck() noexcept;

/// What moves the truck at one instant.
struct Excitation {
  std::array<double, 2> wheelset_mps2{};
  std::array<double, 2> wheelset_mps{};
  double force_n{0.0};  ///< on the frame, not measured by any sensor
};

/// Motion and forces at one instant.
struct TruckState {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double frame_mps2{0.0};       ///< z_b''
  double damping_force_n{0.0};  ///< everything that F holds: friction, viscous, offset, history
  double restoring_force_n{0.0};
};

class Truck {
 public:
  explicit Truck(const TruckConfig& config);
  /// Runge-Kutta 4 from time_s to time_s + step_s with the excitation at its start, middle and end;
  /// in as many parts as the steepest slope of the friction law needs.
  void step(const Excitation& start, const Excitation& middle, const Excitation& end, double time_s,
            double step_s) noexcept;
  [[nodiscard]] const TruckState& state() const noexcept { return seen_; }
  /// For free vibrations: sets deflection and velocity, everything else at rest.
  void set_motion(double deflection_m, double velocity_mps) noexcept;

 private:
  // y, v; of the pitch d = a theta - (z_1 - z_2) / 2 and its rate; of the flexible mass its way
  // relative to the frame and its rate; Dahl's zeta and the stretch of the viscoelastic spring per
  // wheelset
  static constexpr std::size_t kStates = 10;
  using State = std::array<double, kStates>;
  struct Force {
    double damping_n, restoring_n;
  };
  struct Memory {
    double zeta, stretch_m;
    const Play& play;
  };
  [[nodiscard]] Force force(double y, double v, const Memory& memory) const noexcept;
  [[nodiscard]] State rate(const State& state, const Excitation& excitation) noexcept;
  void set_parameters(double time_s) noexcept;
  template <std::size_t N>
  void part(const Excitation& start, const Excitation& middle, const Excitation& end,
            double step_s) noexcept;
  [[nodiscard]] int parts_of(double step_s) const noexcept;

  TruckConfig config_;
  bool plain_;  // two states are enough
  bool drifts_;
  double mass_kg_{0.0};
  double stiffness_npm_{0.0};
  double friction_positive_n_{0.0};
  double friction_negative_n_{0.0};
  State state_{};
  std::array<Play, 2> play_{};
  TruckState seen_{};
};

/// tanh; beyond 19 it is 1 in double precision.
[[nodiscard]] inline double smooth_sign(double x) noexcept {
  return std::abs(x) > 19.0 ? std::copysign(1.0, x) : std::tanh(x);
}

/// At the share u of a step: the parabola through its start, middle and end.
[[nodiscard]] inline Excitation between(const Excitation& a, const Excitation& m,
                                        const Excitation& b, double u) noexcept {
  const double wa = (1.0 - u) * (1.0 - 2.0 * u);
  const double wm = 4.0 * u * (1.0 - u);
  const double wb = u * (2.0 * u - 1.0);
  Excitation e;
  for (std::size_t i = 0; i < 2; ++i) {
    e.wheelset_mps2[i] =
        wa * a.wheelset_mps2[i] + wm * m.wheelset_mps2[i] + wb * b.wheelset_mps2[i];
    e.wheelset_mps[i] = wa * a.wheelset_mps[i] + wm * m.wheelset_mps[i] + wb * b.wheelset_mps[i];
  }
  e.force_n = wa * a.force_n + wm * m.force_n + wb * b.force_n;
  return e;
}

}  // namespace dampline::sim
