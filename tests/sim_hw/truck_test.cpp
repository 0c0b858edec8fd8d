// SPDX-License-Identifier: MIT
#include "sim_hw/truck.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace dampline::sim {
namespace {

constexpr double kTruckStepS = 1.0 / 2400.0;

/// Deflection after each step of a free vibration.
std::vector<double> free_vibration(const TruckConfig& config, double deflection_m, int steps) {
  Truck truck{config};
  truck.set_motion(deflection_m, 0.0);
  std::vector<double> y{deflection_m};
  for (int i = 0; i < steps; ++i) {
    truck.step({}, {}, {}, i * kTruckStepS, kTruckStepS);
    y.push_back(truck.state().deflection_m);
  }
  return y;
}

/// Values at the upper turning points after the start.
std::vector<double> peaks(const std::vector<double>& y) {
  std::vector<double> found;
  for (std::size_t i = 1; i + 1 < y.size(); ++i) {
    if (y[i] > y[i - 1] && y[i] >= y[i + 1] && y[i] > 0.0) found.push_back(y[i]);
  }
  return found;
}

TruckConfig without_friction() {
  TruckConfig config;
  config.friction_scale = 0.0;
  return config;
}

TEST(Truck, WithoutFrictionSwingsAtTheNaturalFrequency) {
  const TruckConfig config = without_friction();
  const double omega = std::sqrt(2.0 * config.stiffness_npm / config.moving_mass_kg);
  const std::vector<double> y = free_vibration(config, 0.01, 24000);
  for (const std::size_t i : {600U, 5000U, 24000U}) {
    EXPECT_NEAR(y[i], 0.01 * std::cos(omega * kTruckStepS * static_cast<double>(i)), 1e-9);
  }
}

TEST(Truck, WithViscousDampingFollowsTheClosedForm) {
  TruckConfig config = without_friction();
  const double c = 60e3;
  config.damping.viscous_positive_nspm = config.damping.viscous_negative_nspm = c;
  const double delta = c / config.moving_mass_kg;  // y'' + (2/M)(c y' + k y) = 0
  const double omega0 = std::sqrt(2.0 * config.stiffness_npm / config.moving_mass_kg);
  const double omega = std::sqrt(omega0 * omega0 - delta * delta);
  const std::vector<double> y = free_vibration(config, 0.01, 4800);
  for (const std::size_t i : {300U, 2000U, 4800U}) {
    const double t = kTruckStepS * static_cast<double>(i);
    const double exact =
        0.01 * std::exp(-delta * t) * (std::cos(omega * t) + delta / omega * std::sin(omega * t));
    EXPECT_NEAR(y[i], exact, 1e-8);
  }
}

TEST(Truck, WithDryFrictionLosesTheSameAmplitudeInEveryCycle) {
  const TruckConfig config = laden_truck();
  const std::vector<double> y = free_vibration(config, 0.030, 2700);
  const std::vector<double> top = peaks(y);
  ASSERT_GE(top.size(), 2U);
  // half a cycle down loses 2 F2 / k, half a cycle up 2 F1 / k
  const double loss =
      2.0 * (config.friction_positive_n + config.friction_negative_n) / config.stiffness_npm;
  EXPECT_NEAR(0.030 - top[0], loss, 0.02 * loss);  // the rounding of sign v costs a percent
  EXPECT_NEAR(top[0] - top[1], loss, 0.02 * loss);
}

TEST(Truck, ComesToRestWithinTheFrictionBand) {
  const TruckConfig config = laden_truck();
  const double rest = free_vibration(config, 0.01, 24000).back();
  EXPECT_LT(std::abs(rest), config.friction_negative_n / config.stiffness_npm);
}

TEST(Truck, BalancesItsEnergy) {
  // (M/4) v^2 + k y^2 / 2 changes by -F v - (M/2)(z1'' + z2'') v; M/2 y'' + k y + F = -(M/2) eta
  const TruckConfig config = laden_truck();
  Truck truck{config};
  const auto input = [](double t) {
    const double a = 0.8 * std::sin(14.0 * t) + 0.5 * std::sin(31.0 * t + 1.0);
    return Excitation{.wheelset_mps2 = {a, 0.7 * a}, .force_n = 0.0};
  };
  const double step = 1.0 / 24000.0;
  const auto energy = [&](const TruckState& s) {
    return 0.25 * config.moving_mass_kg * s.velocity_mps * s.velocity_mps +
           0.5 * config.stiffness_npm * s.deflection_m * s.deflection_m;
  };
  const auto power = [&](const TruckState& s, double t) {
    const Excitation e = input(t);
    return -s.velocity_mps * (s.damping_force_n + 0.5 * config.moving_mass_kg *
                                                      (e.wheelset_mps2[0] + e.wheelset_mps2[1]));
  };
  double work = 0.0;
  double dissipated = 0.0;
  TruckState before = truck.state();
  for (int i = 0; i < 240000; ++i) {
    const double t = i * step;
    truck.step(input(t), input(t + 0.5 * step), input(t + step), t, step);
    const TruckState& after = truck.state();
    work += 0.5 * step * (power(before, t) + power(after, t + step));
    dissipated +=
        0.5 * step *
        (before.damping_force_n * before.velocity_mps + after.damping_force_n * after.velocity_mps);
    before = after;
  }
  EXPECT_GT(dissipated, 100.0);
  EXPECT_NEAR(energy(before), work, 1e-3 * dissipated);
}

TEST(Truck, ObeysItsEquationOfMotion) {
  const TruckConfig config = empty_truck();
  Truck truck{config};
  for (int i = 0; i < 5000; ++i) {
    const Excitation e{.wheelset_mps2 = {std::sin(0.01 * i), std::cos(0.013 * i)}, .force_n = 0.0};
    truck.step(e, e, e, i * kTruckStepS, kTruckStepS);
    const TruckState& s = truck.state();
    const double residual = config.moving_mass_kg * s.frame_mps2 +
                            config.stiffness_npm * s.deflection_m + s.damping_force_n;
    ASSERT_NEAR(residual, 0.0, 1e-6);
    const double level =
        s.velocity_mps > 0.0 ? config.friction_positive_n : config.friction_negative_n;
    ASSERT_NEAR(s.damping_force_n, level * std::tanh(s.velocity_mps / 0.5e-3), 1e-6);
  }
}

TEST(Truck, StaysStableWithFourTimesTheFrictionAndWithPitch) {
  for (const double inertia : {0.0, 1500.0}) {
    TruckConfig config = laden_truck();
    config.friction_scale = 4.0;
    config.modes.pitch_inertia_kgm2 = inertia;
    Truck truck{config};
    double largest = 0.0;
    for (int i = 0; i < 24000; ++i) {
      const double t = i * kTruckStepS;
      const Excitation e{
          .wheelset_mps2 = {2.0 * std::sin(25.0 * t), 2.0 * std::sin(25.0 * t + 1.0)},
          .force_n = 0.0};
      truck.step(e, e, e, t, kTruckStepS);
      largest = std::max(largest, std::abs(truck.state().deflection_m));
    }
    EXPECT_LT(largest, 0.05);
    EXPECT_GT(largest, 1e-5);
  }
}

}  // namespace
}  // namespace dampline::sim
