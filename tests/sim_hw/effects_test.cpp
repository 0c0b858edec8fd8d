// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::sim {
namespace {

SimulationConfig with(const std::string& effect) {
  SimulationConfig config = reference_run(Load::kLaden, 80.0, 4);
  const auto error = add_effect_text(config, effect);
  EXPECT_FALSE(error.has_value()) << error.value_or("");
  return config;
}

struct Forces {
  double damping;
  double restoring;
};
using Law = std::function<Forces(double y, double v, double t)>;

double sign(double v) { return std::tanh(v / 0.5e-3); }
double coulomb(double v) { return sign(v) * (v > 0.0 ? 7562.0 : 9150.0); }
constexpr double kK = 5.26e6;

/// Compares what the simulation says it did with the law as written here.
void expect_law(const std::string& effect, const Law& law) {
  Simulation simulation{with(effect)};
  for (int i = 0; i < 3000; ++i) {
    const SimulatedSample s = simulation.next();
    const Forces f = law(s.instant.deflection_m, s.instant.velocity_mps, s.time_s);
    ASSERT_NEAR(s.instant.damping_force_n, f.damping, 1e-6 * (1.0 + std::abs(f.damping)))
        << effect << " at " << s.time_s;
    ASSERT_NEAR(s.instant.restoring_force_n, f.restoring, 1e-6 * (1.0 + std::abs(f.restoring)))
        << effect << " at " << s.time_s;
  }
}

TEST(Effects, AddTheirDampingForces) {
  expect_law("viscous:coefficient_nspm=1e5", [](double y, double v, double) {
    return Forces{coulomb(v) + 1e5 * v, kK * y};
  });
  expect_law("asymmetric_viscous:positive_nspm=2e5,negative_nspm=5e4",
             [](double y, double v, double) {
               return Forces{coulomb(v) + (v > 0.0 ? 2e5 : 5e4) * v, kK * y};
             });
  expect_law("quadratic_damping:coefficient_ns2pm2=6e6", [](double y, double v, double) {
    return Forces{coulomb(v) + 6e6 * v * std::abs(v), kK * y};
  });
  expect_law("offset_force:force_n=-900", [](double y, double v, double) {
    return Forces{coulomb(v) - 900.0, kK * y};
  });
}

TEST(Effects, ChangeTheFriction) {
  expect_law("coulomb:level_n=5000", [](double y, double v, double) {
    return Forces{5000.0 * sign(v), kK * y};
  });
  expect_law("asymmetric_coulomb:positive_n=4000,negative_n=9000", [](double y, double v, double) {
    return Forces{(v > 0.0 ? 4000.0 : 9000.0) * sign(v), kK * y};
  });
  expect_law("progressive_friction:length_m=0.001", [](double y, double v, double) {
    return Forces{coulomb(v) * std::max(0.0, 1.0 + y / 0.001), kK * y};
  });
  expect_law("progressive_friction:length_m=0.004,absolute=1", [](double y, double v, double) {
    return Forces{coulomb(v) * (1.0 + std::abs(y) / 0.004), kK * y};
  });
  expect_law("stribeck:share=0.4,speed_mps=0.01", [](double y, double v, double) {
    return Forces{coulomb(v) * (1.0 + 0.4 * std::exp(-std::abs(v) / 0.01)), kK * y};
  });
}

TEST(Effects, ChangeTheSpring) {
  expect_law("cubic_stiffness:coefficient_npm3=3e11", [](double y, double v, double) {
    return Forces{coulomb(v), kK * y + 3e11 * y * y * y};
  });
  expect_law("quadratic_stiffness:coefficient_npm2=4e8", [](double y, double v, double) {
    return Forces{coulomb(v), kK * y + 4e8 * y * y};
  });
  expect_law("asymmetric_stiffness:added_npm=1.5e6", [](double y, double v, double) {
    return Forces{coulomb(v), kK * y + (y > 0.0 ? 1.5e6 * y : 0.0)};
  });
  expect_law("bump_stop:gap_m=0.5e-3,stiffness_npm=1.5e7", [](double y, double v, double) {
    const double beyond = y > 0.5e-3 ? y - 0.5e-3 : (y < -0.5e-3 ? y + 0.5e-3 : 0.0);
    return Forces{coulomb(v), kK * y + 1.5e7 * beyond};
  });
  expect_law("bump_stop:gap_m=0.5e-3,stiffness_npm=1.5e7,one_sided=1",
             [](double y, double v, double) {
               return Forces{coulomb(v), kK * y + 1.5e7 * (y > 0.5e-3 ? y - 0.5e-3 : 0.0)};
             });
}

TEST(Effects, ChangeParametersOverTime) {
  expect_law("time_drift:friction_factor=0.7,stiffness_factor=1.2,start_s=5,end_s=5",
             [](double y, double v, double t) {
               const bool after = t > 5.0;
               return Forces{coulomb(v) * (after ? 0.7 : 1.0), kK * y * (after ? 1.2 : 1.0)};
             });
  Simulation ramp{with("time_drift:friction_factor=0.5,start_s=2,end_s=8")};
  for (int i = 0; i < 3000; ++i) {
    const SimulatedSample s = ramp.next();
    const double progress = std::clamp((s.time_s - 2.0) / 6.0, 0.0, 1.0);
    const double expected = coulomb(s.instant.velocity_mps) * (1.0 - 0.5 * progress);
    ASSERT_NEAR(s.instant.damping_force_n, expected, 2.0);  // parameters are held over a step
  }
}

TEST(Effects, ChangeTheMassOverTime) {
  Simulation simulation{with("time_drift:friction_factor=1,mass_factor=1.1,start_s=5,end_s=5")};
  for (int i = 0; i < 3000; ++i) {
    const SimulatedSample s = simulation.next();
    if (std::abs(s.instant.frame_mps2) < 0.1) continue;
    const double mass =
        -(s.instant.damping_force_n + s.instant.restoring_force_n) / s.instant.frame_mps2;
    ASSERT_NEAR(mass, s.time_s > 5.0 ? 40920.0 : 37200.0, 1.0);
  }
}

/// Moves the deflection of a truck through a slow sine and calls back with each state.
template <class Visit>
void drive_slowly(TruckConfig config, double amplitude_m, double seconds, Visit visit) {
  constexpr double kStep = 1.0 / 2400.0;
  constexpr double kOmega = 6.0;
  config.moving_mass_kg = 1e12;  // the frame stands, y = -(z1 + z2)
  Truck truck{config};
  truck.set_motion(0.0, amplitude_m * kOmega);
  const auto input = [&](double t) {
    const double a = 0.5 * amplitude_m * kOmega * kOmega * std::sin(kOmega * t);
    return Excitation{.wheelset_mps2 = {a, a}, .force_n = 0.0};
  };
  for (int i = 0; i * kStep < seconds; ++i) {
    const double t = i * kStep;
    truck.step(input(t), input(t + 0.5 * kStep), input(t + kStep), t, kStep);
    visit(truck.state());
  }
}

TEST(Effects, BuildFrictionUpOverADistanceAfterEachReversal) {
  SimulationConfig config = with("presliding_hysteresis:distance_m=2e-4");
  config.truck.friction_positive_n = config.truck.friction_negative_n = 1000.0;
  double last_v = 1.0;
  double turn_y = 0.0;
  double turn_zeta = 0.0;
  int checked = 0;
  drive_slowly(config.truck, 2e-3, 4.0, [&](const TruckState& s) {
    const double zeta = s.damping_force_n / 1000.0;
    if (s.velocity_mps * last_v < 0.0) {
      turn_y = s.deflection_m;
      turn_zeta = zeta;
    } else if (turn_zeta != 0.0) {
      const double direction = std::copysign(1.0, s.velocity_mps);
      const double travel = std::abs(s.deflection_m - turn_y);
      const double exact = direction + (turn_zeta - direction) * std::exp(-travel / 2e-4);
      EXPECT_NEAR(zeta, exact, 1e-3);
      ++checked;
    }
    last_v = s.velocity_mps;
  });
  EXPECT_GT(checked, 5000);
}

TEST(Effects, GiveWayBehindADashpot) {
  SimulationConfig config = with("viscoelastic:stiffness_npm=2e6,time_s=0.1");
  config.truck.friction_positive_n = config.truck.friction_negative_n = 0.0;
  // Of y = A sin(w t): x = A w tau (cos(w t) + w tau sin(w t)) / (1 + (w tau)^2).
  constexpr double kTurn = 6.0 * 0.1;  // drive_slowly()'s w times tau
  double largest_n = 0.0;
  int n = 0;
  drive_slowly(config.truck, 2e-3, 4.0, [&](const TruckState& s) {
    const double steady_m =
        kTurn * (s.velocity_mps / 6.0 + kTurn * s.deflection_m) / (1.0 + kTurn * kTurn);
    if (++n < 1200) return;  // until it is steady
    EXPECT_NEAR(s.damping_force_n, 2e6 * steady_m, 20.0);
    largest_n = std::max(largest_n, std::abs(s.damping_force_n));
  });
  EXPECT_NEAR(largest_n, 2e6 * 2e-3 * kTurn / std::hypot(1.0, kTurn), 40.0);
}

TEST(Effects, LetTheFrictionGoUntilTheGapIsTakenUp) {
  const SimulationConfig config = with("backlash:gap_m=5e-4");
  double last_v = 1.0;
  double turn_y = 0.0;
  bool turned = false;
  int free = 0;
  int engaged = 0;
  drive_slowly(config.truck, 2e-3, 4.0, [&](const TruckState& s) {
    if (s.velocity_mps * last_v < 0.0) {
      turn_y = s.deflection_m;
      turned = true;
    }
    last_v = s.velocity_mps;
    if (!turned) return;
    const double travel = std::abs(s.deflection_m - turn_y);
    if (travel < 0.97 * 5e-4) {
      EXPECT_EQ(s.damping_force_n, 0.0);
      ++free;
    } else if (travel > 1.02 * 5e-4) {
      EXPECT_NEAR(s.damping_force_n, coulomb(s.velocity_mps), 1.0);
      ++engaged;
    }
  });
  EXPECT_GT(free, 500);
  EXPECT_GT(engaged, 500);
}

TEST(Effects, ScaleWithTheirStrength) {
  SimulationConfig half = reference_run(Load::kLaden, 80.0, 1);
  SimulationConfig full = half;
  ASSERT_FALSE(add_effect(half, "viscous", {{"strength", 0.5}}));
  ASSERT_FALSE(add_effect(full, "viscous"));
  EXPECT_DOUBLE_EQ(half.truck.damping.viscous_positive_nspm,
                   0.5 * full.truck.damping.viscous_positive_nspm);
  EXPECT_NEAR(full.truck.damping.viscous_negative_nspm * 0.018, 0.25 * 8356.0, 1e-6);
  ASSERT_FALSE(add_effect(half, "time_drift", {{"strength", 0.5}}));
  EXPECT_DOUBLE_EQ(half.truck.drift.friction_factor, 0.85);
  ASSERT_FALSE(add_effect(half, "progressive_friction", {{"strength", 0.5}}));
  EXPECT_DOUBLE_EQ(half.truck.damping.progressive_length_m, 0.008);
}

TEST(Effects, AllRunAndLeaveFiniteNumbers) {
  for (const Effect& effect : effects()) {
    Simulation simulation{with(std::string{effect.name})};
    double largest = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const SimulatedSample s = simulation.next();
      ASSERT_TRUE(std::isfinite(s.truth.damping_force_n)) << effect.name;
      largest = std::max(largest, std::abs(s.truth.deflection_m));
    }
    EXPECT_GT(largest, 1e-4) << effect.name;
    EXPECT_LT(largest, 2e-2) << effect.name;
  }
}

TEST(Effects, AreRefusedWithAReason) {
  SimulationConfig config;
  EXPECT_THAT(add_effect_text(config, "magic").value_or(""),
              ::testing::AllOf(::testing::HasSubstr("magic"), ::testing::HasSubstr("bump_stop")));
  EXPECT_THAT(add_effect_text(config, "viscous:gap_m=1").value_or(""),
              ::testing::HasSubstr("expected one of coefficient_nspm, strength"));
  EXPECT_THAT(add_effect_text(config, "viscous:coefficient_nspm=fast").value_or(""),
              ::testing::HasSubstr("coefficient_nspm=fast"));
  EXPECT_THAT(add_effect_text(config, "bump_stop:stiffness_npm=-1").value_or(""),
              ::testing::HasSubstr("positive"));
  EXPECT_THAT(add_effect_text(config, "viscous:coefficient_nspm=nan").value_or(""),
              ::testing::HasSubstr("nan"));
  EXPECT_EQ(config.truck.damping.viscous_positive_nspm, 0.0);
}

}  // namespace
}  // namespace dampline::sim
