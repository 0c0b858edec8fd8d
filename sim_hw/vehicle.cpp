// SPDX-License-Identifier: MIT
#include "sim_hw/vehicle.hpp"

#include <algorithm>
#include <cmath>

#include "sim_hw/truck.hpp"

namespace dampline::sim {
namespace {

TruckMotion moved(const TruckMotion& at, const TruckMotion& slope, double length) noexcept {
  return {at.deflection_m + length * slope.deflection_m,
          at.velocity_mps + length * slope.velocity_mps, at.pitch_m + length * slope.pitch_m,
          at.pitch_rate_mps + length * slope.pitch_rate_mps};
}

Vehicle::Excitations between(const Vehicle::Excitations& a, const Vehicle::Excitations& m,
                             const Vehicle::Excitations& b, double u) noexcept {
  return {between(a[0], m[0], b[0], u), between(a[1], m[1], b[1], u)};
}

}  // namespace

VehicleMasses masses_of(const VehicleConfig& vehicle, const TruckConfig& truck) noexcept {
  const double radius = vehicle.gyration_radius_m / vehicle.half_pivot_distance_m;
  const double height = vehicle.centre_height_m / vehicle.half_pivot_distance_m;
  const double ratio = radius * radius + height * height;
  const double half_body_kg = truck.moving_mass_kg - vehicle.frame_mass_kg;
  return {.own_kg = vehicle.frame_mass_kg + 0.5 * half_body_kg * (1.0 + ratio),
          .other_kg = 0.5 * half_body_kg * (1.0 - ratio)};
}

bool Vehicle::supports(const TruckConfig& truck) noexcept {
  return truck.modes.flexible_share <= 0.0 && truck.hysteresis.presliding_distance_m <= 0.0 &&
         truck.hysteresis.backlash_gap_m <= 0.0 && truck.hysteresis.viscoelastic_npm <= 0.0 &&
         !truck.drift.active();
}

Vehicle::Vehicle(const VehicleConfig& vehicle, const TruckConfig& truck)
    : truck_(truck),
      bounce_kg_(truck.moving_mass_kg),
      pitch_kg_(masses_of(vehicle, truck).own_kg - masses_of(vehicle, truck).other_kg),
      half_pivot_distance_m_(vehicle.half_pivot_distance_m),
      pitch_damping_nms_(truck.modes.pitch_inertia_kgm2 > 0.0 ? vehicle.pitch_damping_nms : 0.0) {}

void Vehicle::set_motion(const std::array<TruckMotion, 2>& motion) noexcept {
  motion_ = motion;
  static_cast<void>(rate(motion_, {}));
}

Vehicle::Force Vehicle::force(double y, double v) const noexcept {
  const double sign = smooth_sign(v / truck_.law_width_mps);
  const double level = truck_.friction_scale *
                       (sign > 0.0 ? truck_.friction_positive_n : truck_.friction_negative_n);
  const double friction = sign * level * friction_factor(truck_.damping, y, v);
  return {friction + added_damping_n(truck_.damping, v),
          truck_.stiffness_npm * y + added_stiffness_n(truck_.stiffness, y)};
}

Vehicle::Force Vehicle::suspension(const TruckMotion& at, const Excitation& excitation,
                                   TruckMotion& rates) const noexcept {
  const ModeEffects& modes = truck_.modes;
  if (modes.pitch_inertia_kgm2 <= 0.0) return force(at.deflection_m, at.velocity_mps);
  const Force first =
      force(at.deflection_m + 2.0 * at.pitch_m, at.velocity_mps + 2.0 * at.pitch_rate_mps);
  const Force second =
      force(at.deflection_m - 2.0 * at.pitch_m, at.velocity_mps - 2.0 * at.pitch_rate_mps);
  const double arm = modes.pitch_half_wheelbase_m;
  rates.pitch_m = at.pitch_rate_mps;
  rates.pitch_rate_mps =
      -arm * arm / modes.pitch_inertia_kgm2 * 0.5 * (first.sum() - second.sum()) -
      0.5 * (excitation.wheelset_mps2[0] - excitation.wheelset_mps2[1]);
  return {0.5 * (first.damping_n + second.damping_n),
          0.5 * (first.restoring_n + second.restoring_n)};
}

double Vehicle::damp_pitch(const Motion& at, const Excitations& excitation,
                           Motion& rates) const noexcept {
  const double arm = truck_.modes.pitch_half_wheelbase_m;
  std::array<double, 2> height_mps{};  // of the pivots
  std::array<double, 2> pitch_ps{};    // of the frames
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& wheelset = excitation[i].wheelset_mps;
    height_mps[i] = 0.5 * (at[i].velocity_mps + wheelset[0] + wheelset[1]);
    pitch_ps[i] = (at[i].pitch_rate_mps + 0.5 * (wheelset[0] - wheelset[1])) / arm;
  }
  const double body_ps = 0.5 * (height_mps[0] - height_mps[1]) / half_pivot_distance_m_;
  const double per_frame = pitch_damping_nms_ * arm / truck_.modes.pitch_inertia_kgm2;
  for (std::size_t i = 0; i < 2; ++i)
    rates[i].pitch_rate_mps -= per_frame * (pitch_ps[i] - body_ps);
  return -0.5 * pitch_damping_nms_ / half_pivot_distance_m_ *
         (2.0 * body_ps - pitch_ps[0] - pitch_ps[1]);
}

Vehicle::Motion Vehicle::rate(const Motion& at, const Excitations& excitation) noexcept {
  Motion rates{};
  std::array<Force, 2> total{};
  std::array<double, 2> push{};
  for (std::size_t i = 0; i < 2; ++i) {
    total[i] = suspension(at[i], excitation[i], rates[i]);
    push[i] = excitation[i].force_n - total[i].sum();
  }
  if (pitch_damping_nms_ > 0.0) {
    const double damped = damp_pitch(at, excitation, rates);
    push[0] += damped;
    push[1] -= damped;
  }
  const double together = 0.5 * (push[0] + push[1]) / bounce_kg_;
  const double against = 0.5 * (push[0] - push[1]) / pitch_kg_;
  const std::array<double, 2> frame{together + against, together - against};
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& wheelset = excitation[i].wheelset_mps2;
    rates[i].deflection_m = at[i].velocity_mps;
    rates[i].velocity_mps = 2.0 * frame[i] - wheelset[0] - wheelset[1];
    end_mps2_[i] = rates[i].pitch_rate_mps + 0.5 * (wheelset[0] - wheelset[1]);
    seen_[i] = {at[i].deflection_m, at[i].velocity_mps, frame[i], total[i].damping_n,
                total[i].restoring_n};
  }
  return rates;
}

void Vehicle::part(const Excitations& start, const Excitations& middle, const Excitations& end,
                   double step_s) noexcept {
  const auto at = [&](const Motion& slope, double length) {
    return Motion{moved(motion_[0], slope[0], length), moved(motion_[1], slope[1], length)};
  };
  const Motion k1 = rate(motion_, start);
  const Motion k2 = rate(at(k1, 0.5 * step_s), middle);
  const Motion k3 = rate(at(k2, 0.5 * step_s), middle);
  const Motion k4 = rate(at(k3, step_s), end);
  for (std::size_t i = 0; i < 2; ++i) {
    const TruckMotion inner = moved(k2[i], k3[i], 1.0);
    const TruckMotion outer = moved(k1[i], k4[i], 1.0);
    motion_[i] = moved(motion_[i], moved(outer, inner, 2.0), step_s / 6.0);
  }
}

// As Truck::parts_of: the slope of tanh at rest makes the fastest rate.
int Vehicle::parts_of(double step_s) const noexcept {
  const double level = truck_.friction_scale *
                       std::max(truck_.friction_positive_n, truck_.friction_negative_n) *
                       (1.0 + std::abs(truck_.damping.stribeck_share));
  const double slope =
      level / truck_.law_width_mps +
      std::max(truck_.damping.viscous_positive_nspm, truck_.damping.viscous_negative_nspm);
  double fastest = 2.0 * slope / std::min(bounce_kg_, pitch_kg_);
  if (truck_.modes.pitch_inertia_kgm2 > 0.0) {
    const double arm = truck_.modes.pitch_half_wheelbase_m;
    fastest += 2.0 * slope * arm * arm / truck_.modes.pitch_inertia_kgm2;
    fastest += pitch_damping_nms_ / truck_.modes.pitch_inertia_kgm2;
  }
  return std::clamp(static_cast<int>(std::ceil(fastest * step_s)), 1, 64);
}

void Vehicle::step(const Excitations& start, const Excitations& middle, const Excitations& end,
                   double step_s) noexcept {
  const int parts = parts_of(step_s);
  const double width = 1.0 / parts;
  for (int i = 0; i < parts; ++i) {
    const double u = static_cast<double>(i) / parts;
    const Excitations a = i == 0 ? start : between(start, middle, end, u);
    const Excitations m = parts == 1 ? middle : between(start, middle, end, u + 0.5 * width);
    const Excitations b = i == parts - 1 ? end : between(start, middle, end, u + width);
    part(a, m, b, step_s / parts);
  }
  static_cast<void>(rate(motion_, end));
}

}  // namespace dampline::sim
