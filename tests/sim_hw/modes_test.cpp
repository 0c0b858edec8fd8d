// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "sim_hw/truck.hpp"

namespace dampline::sim {
namespace {

constexpr double kModeStepS = 1.0 / 2400.0;
constexpr double kPi = std::numbers::pi;

/// z_b'' for wheelset accelerations of unit amplitude at one frequency: both alike, or opposite.
std::complex<double> response(const TruckConfig& config, double hz, bool opposite,
                              TruckState* last = nullptr) {
  Truck truck{config};
  const auto input = [&](double t) {
    const double a = std::cos(2.0 * kPi * hz * t);
    return Excitation{.wheelset_mps2 = {a, opposite ? -a : a}, .force_n = 0.0};
  };
  std::complex<double> sum;
  constexpr int kSettle = 96000;
  constexpr int kSteps = 48000;
  for (int i = 0; i < kSettle + kSteps; ++i) {
    const double t = i * kModeStepS;
    truck.step(input(t), input(t + 0.5 * kModeStepS), input(t + kModeStepS), t, kModeStepS);
    if (i >= kSettle) {
      sum +=
          truck.state().frame_mps2 * std::polar(2.0 / kSteps, -2.0 * kPi * hz * (t + kModeStepS));
    }
  }
  if (last != nullptr) *last = truck.state();
  return sum;
}

TruckConfig viscous_truck() {
  TruckConfig config;
  config.friction_scale = 0.0;
  config.damping.viscous_positive_nspm = config.damping.viscous_negative_nspm = 1e5;
  return config;
}

TEST(FlexibleBody, AddsItsShareOfTheMassThroughItsResonance) {
  TruckConfig config = viscous_truck();
  config.modes.flexible_share = 0.3;
  const double omega_f = 2.0 * kPi * config.modes.flexible_frequency_hz;
  for (const double hz : {1.0, 4.0, 9.0, 20.0}) {
    // M (1 - m + m G) z_b'' = -(k + c s) y, y'' = 2 z_b'' - 2, G = (2 d w s + w^2)/(s^2+2 d w
    // s+w^2)
    const std::complex<double> s{0.0, 2.0 * kPi * hz};
    const std::complex<double> pole = 2.0 * 0.03 * omega_f * s + omega_f * omega_f;
    const std::complex<double> mass = config.moving_mass_kg * (0.7 + 0.3 * pole / (s * s + pole));
    const std::complex<double> spring = config.stiffness_npm + 1e5 * s;
    const std::complex<double> exact = 2.0 * spring / (mass * s * s + 2.0 * spring);
    const std::complex<double> found = response(config, hz, false);
    EXPECT_LT(std::abs(found - exact) / std::abs(exact), 1e-3) << hz;
  }
}

TEST(FramePitch, IsNotSeenByALinearSuspension) {
  TruckConfig config = viscous_truck();
  config.modes.pitch_inertia_kgm2 = 1500.0;
  EXPECT_LT(std::abs(response(config, 9.0, true)), 1e-9);
  TruckConfig plain = viscous_truck();
  EXPECT_LT(std::abs(response(config, 5.0, false) - response(plain, 5.0, false)), 1e-9);
}

TEST(FramePitch, MakesTheFrictionOfTheWheelsetsSlipOneByOne) {
  // Opposite wheelsets with an offset in phase move y little but each wheelset's friction much:
  // friction then linearises, and the level that y sees falls.
  TruckConfig config = laden_truck();
  config.modes.pitch_inertia_kgm2 = 1500.0;
  Truck with{config};
  Truck without{laden_truck()};
  double seen_with = 0.0;
  double seen_without = 0.0;
  for (int i = 0; i < 48000; ++i) {
    const double t = i * kModeStepS;
    const auto input = [](double time) {
      const double bounce = 0.7 * std::sin(2.0 * kPi * 3.0 * time);
      const double pitch = 6.0 * std::sin(2.0 * kPi * 11.0 * time);
      return Excitation{.wheelset_mps2 = {bounce + pitch, bounce - pitch}, .force_n = 0.0};
    };
    with.step(input(t), input(t + 0.5 * kModeStepS), input(t + kModeStepS), t, kModeStepS);
    without.step(input(t), input(t + 0.5 * kModeStepS), input(t + kModeStepS), t, kModeStepS);
    seen_with += std::abs(with.state().damping_force_n);
    seen_without += std::abs(without.state().damping_force_n);
  }
  EXPECT_LT(seen_with, 0.9 * seen_without);
}

}  // namespace
}  // namespace dampline::sim
