// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "sim_hw/truck.hpp"

namespace dampline::sim {

enum class TruckPosition : std::uint8_t { kLeading, kTrailing };

/// A four-axle freight car in its vertical plane: a rigid body on two trucks, four degrees of
/// freedom (Kisilowski and Urbanski 1987, equation 1): bounce z and pitch phi of the body, pitch
/// theta of each frame.
///
/// A truck without secondary springs (Y25) carries the body on a centre plate, which leaves it
/// pitch but no way up or down. So the frame i moves with the body, z_bi = z +- l phi:
///   m_frame z_b1'' + P_1 = -S_1,   m_body z'' = P_1 + P_2,
///   (m_body radius^2 + m_body h^2) phi'' = l (P_1 - P_2) - c (2 phi' - theta_1' - theta_2'),
///   I theta_i'' = -T_i - c (theta_i' - phi')
/// with S and T the suspension's force and moment, P the force of the centre plate and c the
/// damping between body and frame pitch; the body's middle, h above the pivots, goes to and fro as
/// it pitches. Hence, without c,
///   M_own z_b1'' + M_other z_b2'' = -S_1,   and the same with 1 and 2 exchanged,
///   M_own = m_frame + m_body (1 + r) / 4,   M_other = m_body (1 - r) / 4,
///   r = (radius^2 + h^2) / l^2,
/// and M_own + M_other = m_frame + m_body / 2, M of TruckConfig, is the mass of bounce alone. The
/// trucks are apart, each with equation 2 and M, only for r = 1 and c = 0.
///
/// Stiffness, friction and their effects are those of TruckConfig, each truck alike; both act at
/// each wheelset, as in ModeEffects, where its pitch inertia is above zero. Without inertia a frame
/// pitches so that its wheelsets' deflections are equal, and S depends on y alone: equation 2.
/// The defaults are an open car 14 m long over buffers, its body uniform over 12.8 m.
struct VehicleConfig {
  double frame_mass_kg{2200.0};
  double gyration_radius_m{3.7};      ///< of the body about its pitch axis
  double half_pivot_distance_m{4.5};  ///< l
  double centre_height_m{0.0};        ///< h, of the body's middle over the pivots
  double pitch_damping_nms{0.0};      ///< c, N m s; of frames that have inertia
  TruckPosition instrumented{TruckPosition::kLeading};
};
inline constexpr double kFramePitchInertiaKgm2 = 1500.0;

/// Masses that a truck feels; see VehicleConfig.
struct VehicleMasses {
  double own_kg, other_kg;
};
[[nodiscard]] VehicleMasses masses_of(const VehicleConfig& vehicle,
                                      const TruckConfig& truck) noexcept;

/// Deflections and rates of one truck: y and, with pitch, d = a theta - (z_1 - z_2) / 2.
struct TruckMotion {
  double deflection_m{0.0}, velocity_mps{0.0};
  double pitch_m{0.0}, pitch_rate_mps{0.0};
};

class Vehicle {
 public:
  using Excitations = std::array<Excitation, 2>;  // by TruckPosition; a force acts at the pivot
  /// What has a memory of its own stays with Truck: pre-sliding, backlash, bending, drift.
  [[nodiscard]] static bool supports(const TruckConfig& truck) noexcept;

  /// Precondition: supports(truck).
  Vehicle(const VehicleConfig& vehicle, const TruckConfig& truck);
  /// As Truck::step.
  void step(const Excitations& start, const Excitations& middle, const Excitations& end,
            double step_s) noexcept;
  [[nodiscard]] const TruckState& state(TruckPosition position) const noexcept {
    return seen_[static_cast<std::size_t>(position)];
  }
  [[nodiscard]] const TruckMotion& motion(TruckPosition position) const noexcept {
    return motion_[static_cast<std::size_t>(position)];
  }
  /// a theta'': what the frame's end over the truck's first wheelset has more than its middle.
  [[nodiscard]] double end_mps2(TruckPosition position) const noexcept {
    return end_mps2_[static_cast<std::size_t>(position)];
  }
  /// For free vibrations.
  void set_motion(const std::array<TruckMotion, 2>& motion) noexcept;

 private:
  using Motion = std::array<TruckMotion, 2>;
  struct Force {
    double damping_n, restoring_n;
    [[nodiscard]] double sum() const noexcept { return damping_n + restoring_n; }
  };
  [[nodiscard]] Force force(double y, double v) const noexcept;
  /// Adds the pitch to `rates`; returns what acts on the frame.
  [[nodiscard]] Force suspension(const TruckMotion& at, const Excitation& excitation,
                                 TruckMotion& rates) const noexcept;
  [[nodiscard]] Motion rate(const Motion& at, const Excitations& excitation) noexcept;
  /// Adds the damping between body and frames to the frames' pitch; returns its push on the leading
  /// pivot, against the trailing one's.
  [[nodiscard]] double damp_pitch(const Motion& at, const Excitations& excitation,
                                  Motion& rates) const noexcept;
  void part(const Excitations& start, const Excitations& middle, const Excitations& end,
            double step_s) noexcept;
  [[nodiscard]] int parts_of(double step_s) const noexcept;

  TruckConfig truck_;
  double bounce_kg_;  // of one truck when both move alike: M
  double pitch_kg_;   // when they move against each other
  double half_pivot_distance_m_;
  double pitch_damping_nms_;
  Motion motion_{};
  std::array<double, 2> end_mps2_{};
  std::array<TruckState, 2> seen_{};
};

}  // namespace dampline::sim
