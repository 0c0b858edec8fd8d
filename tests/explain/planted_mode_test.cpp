// SPDX-License-Identifier: MIT
// Rigs that ring: a fixture between damper and force cell, and masses on what moves, integrated
// here (Runge-Kutta, 10 kHz), at frequencies between the grids'.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "app/diagnosis/rig/series.hpp"
#include "tests/explain/explained_rig.hpp"

namespace dampline::app {
namespace {

using dampline::test::parameter;

constexpr double kFixtureRateHz = 400.0;
constexpr double kFixtureLengthS = 40.0;
constexpr int kFixtureSteps = 25;

struct FixtureMotion {
  double x{0.0};
  double v{0.0};
  double a{0.0};
};

FixtureMotion fixture_motion(double t) {
  FixtureMotion out;
  const double tones[][3] = {
      {0.005, 0.53, 0.0}, {0.003, 1.31, 1.0}, {0.0015, 3.3, 2.0}, {0.0006, 4.7, 0.5}};
  for (const auto& [amplitude, hz, phase] : tones) {
    const double w = 2.0 * M_PI * hz;
    out.x += amplitude * std::sin(w * t + phase);
    out.v += amplitude * w * std::cos(w * t + phase);
    out.a -= amplitude * w * w * std::sin(w * t + phase);
  }
  return out;
}

double simple(const FixtureMotion& m) { return 300.0 * (m.v < 0.0 ? -1.0 : 1.0) + 900.0 * m.v; }

/// y'' = w^2 (u(t) - y) - 2 D w y'.
struct Oscillator {
  double w;
  double damping;
  double y{0.0};
  double rate{0.0};

  void step(const std::function<double(double)>& u, double t, double h) {
    const auto accel = [&](double place, double speed, double at) {
      return w * w * (u(at) - place) - 2.0 * damping * w * speed;
    };
    const double k1 = accel(y, rate, t);
    const double k2 = accel(y + 0.5 * h * rate, rate + 0.5 * h * k1, t + 0.5 * h);
    const double k3 = accel(y + 0.5 * h * (rate + 0.5 * h * k1), rate + 0.5 * h * k2, t + 0.5 * h);
    const double k4 = accel(y + h * (rate + 0.5 * h * k2), rate + h * k3, t + h);
    y += h * rate + h * h / 6.0 * (k1 + k2 + k3);
    rate += h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
  }
};

/// The force of a row from its time; called once every fine step.
using Force = std::function<double(double t, double h)>;

std::string record_of(const Force& force, std::uint64_t seed, double late_s = 0.0) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise;
  std::string text = "time_s,deflection_m,force_n\n";
  const double h = 1.0 / (kFixtureRateHz * kFixtureSteps);
  for (int i = -800; i < static_cast<int>(kFixtureRateHz * kFixtureLengthS); ++i) {
    double now_n = 0.0;
    for (int k = 0; k < kFixtureSteps; ++k) now_n = force((i * kFixtureSteps + k) * h, h);
    const double t = (i + 1) / kFixtureRateHz;
    if (i < 0) continue;
    text += fmt::format("{:.6f},{:.9f},{:.4f}\n", t,
                        fixture_motion(t + late_s).x + 1e-7 * noise(random),
                        now_n + 4.0 * noise(random));
  }
  return text;
}

/// What the cell under a fixture measures, the damper's force acting on it.
Force behind_fixture(double hz, double damping) {
  return [o = Oscillator{2.0 * M_PI * hz, damping}](double t, double h) mutable {
    o.step([](double at) { return simple(fixture_motion(at)); }, t, h);
    return o.y;
  };
}

/// A mass on a spring that stands on the moving end.
Force with_passenger(double kg, double hz, double damping) {
  return [kg, o = Oscillator{2.0 * M_PI * hz, damping}](double t, double h) mutable {
    // z: of the mass against its foot; z'' + 2 D w z' + w^2 z = -x''.
    o.step([&](double at) { return -fixture_motion(at).a / (o.w * o.w); }, t, h);
    const double accel = -(o.w * o.w * o.y + 2.0 * o.damping * o.w * o.rate);
    return simple(fixture_motion(t + h)) + kg * accel;
  };
}

Force with_mass(double kg) {
  return [kg](double t, double h) {
    const FixtureMotion m = fixture_motion(t + h);
    return simple(m) + kg * m.a;
  };
}

rig::Explanation explained(const Force& force, std::uint64_t seed, double late_s = 0.0) {
  const dampline::test::TemporaryFile fitted{record_of(force, seed, late_s), ".csv"};
  const dampline::test::TemporaryFile other{record_of(force, seed + 1, late_s), ".csv"};
  return rig::explain(dampline::test::two_terms(), {{fitted.path()}, {other.path()}, "", false});
}

TEST(RigMode, PassesAStepAsAMassOnASpringDoes) {
  const rig::Mode mode{11.3, 0.07};
  constexpr double kIntervalS = 0.004;
  Eigen::VectorXd ramp{500};
  for (Eigen::Index i = 0; i < ramp.size(); ++i)
    ramp[i] = 0.4 * static_cast<double>(i) * kIntervalS;
  const Eigen::VectorXd out = rig::through_mode(ramp, mode, kIntervalS);
  const double w = 2.0 * M_PI * mode.hz;
  const double wd = w * std::sqrt(1.0 - mode.damping * mode.damping);
  for (Eigen::Index i = 0; i < ramp.size(); ++i) {
    // The ramp's closed answer, from rest.
    const double t = static_cast<double>(i) * kIntervalS;
    const double lag = 2.0 * mode.damping / w;
    const double ring = std::exp(-mode.damping * w * t) *
                        (lag * std::cos(wd * t) +
                         (2.0 * mode.damping * mode.damping - 1.0) / wd * std::sin(wd * t));
    EXPECT_NEAR(out[i], 0.4 * (t - lag + ring), 1e-12);
  }
}

TEST(RigModeNightly, OfAFixtureIsFoundAndPredicted) {
  const std::array cases{rig::Mode{37.3, 0.06}, rig::Mode{11.9, 0.035}, rig::Mode{71.0, 0.11}};
  for (const rig::Mode& mode : cases) {
    const rig::Explanation found = explained(behind_fixture(mode.hz, mode.damping), 61);
    ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
    EXPECT_EQ(found.steps[0].effect, "unmodelled_mode") << summarize(found);
    EXPECT_NEAR(parameter(found, "unmodelled_mode_frequency").value, mode.hz, 0.02 * mode.hz);
    EXPECT_NEAR(parameter(found, "unmodelled_mode_damping").value, mode.damping,
                0.25 * mode.damping);
    ASSERT_EQ(found.validation.size(), 1U);
    EXPECT_LT(found.validation[0].rrse_after,
              1.3 * std::sqrt(found.final.fit.held_out_nmse) + 0.005);
    EXPECT_LT(found.validation[0].rrse_after, 0.5 * found.validation[0].rrse_before);
  }
}

TEST(RigMode, OfAPassengerIsFoundWithItsMass) {
  const std::array cases{rig::Mode{6.7, 0.05}, rig::Mode{2.1, 0.08}};
  for (const rig::Mode& mode : cases) {
    const rig::Explanation found = explained(with_passenger(180.0, mode.hz, mode.damping), 63);
    ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
    EXPECT_EQ(found.steps[0].effect, "unmodelled_mode") << summarize(found);
    const Parameter hz = parameter(found, "unmodelled_mode_frequency");
    EXPECT_NEAR(hz.value, mode.hz, 4.0 * hz.std + 0.005 * mode.hz);
    EXPECT_LT(hz.std, 0.1 * mode.hz);
    EXPECT_NEAR(parameter(found, "unmodelled_mode_mass").value, 180.0, 18.0);
  }
}

TEST(RigMode, FarAboveTheMotionIsAMovingMass) {
  const rig::Explanation found = explained(with_mass(150.0), 65);
  EXPECT_TRUE(found.steps.empty()) << summarize(found);
  EXPECT_STREQ(found.verdict(), "complete") << summarize(found);
  EXPECT_NEAR(parameter(found, "moving_mass").value, 150.0, 4.0);
  EXPECT_NE(to_json(found).find("An inertia"), std::string::npos);
}

TEST(RigNoise, NeedNotBeWhite) {
  std::mt19937_64 random{71};
  std::normal_distribution<double> normal;
  double colored_n = 0.0;
  const rig::Explanation found = explained(
      [&](double t, double h) {
        // First order, 25 Hz, 40 N.
        const double kept = std::exp(-2.0 * M_PI * 25.0 * h);
        colored_n = kept * colored_n + 40.0 * std::sqrt(1.0 - kept * kept) * normal(random);
        return simple(fixture_motion(t + h)) + colored_n;
      },
      71);
  EXPECT_TRUE(found.steps.empty()) << summarize(found);
  EXPECT_STREQ(found.verdict(), "complete") << summarize(found);
}

TEST(RigNoise, IsNotWhatRingsWhereNoModeIsLookedFor) {
  Config config = dampline::test::two_terms();
  config.model.candidates = {"offset_force"};
  const rig::Explanation found =
      dampline::test::explained(record_of(behind_fixture(23.0, 0.1), 73), config);
  EXPECT_STREQ(found.verdict(), "unexplained") << summarize(found);
}

TEST(RigSkew, IsAppliedToWhatIsPredicted) {
  constexpr double kLateS = 0.0041;
  const rig::Explanation found =
      explained([](double t, double h) { return simple(fixture_motion(t + h)); }, 67, kLateS);
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "time_skew") << summarize(found);
  EXPECT_NEAR(parameter(found, "time_skew").value, 1e3 * kLateS, 0.2);
  ASSERT_EQ(found.validation.size(), 1U);
  EXPECT_LT(found.validation[0].rrse_after, 1.3 * std::sqrt(found.final.fit.held_out_nmse) + 0.005);
}

}  // namespace
}  // namespace dampline::app
