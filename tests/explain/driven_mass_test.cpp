// SPDX-License-Identifier: MIT
// A mass on a spring, pushed by a known force up to a fifth of the rate and integrated here, by
// Runge and Kutta's fourth order.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "tests/explain/explained_rig.hpp"

namespace dampline::app {
namespace {

using dampline::test::value_of;

constexpr double kMassKg = 1.7;
constexpr double kViscous = 6.0;
constexpr double kStiffnessNpm = 2.1e5;

/// What beside m x'' + c x' + k x; of deflection and velocity.
using Law = std::function<double(double, double)>;

/// Bouc and Wen's hysteresis as its authors write it: z' = alpha v - beta (gamma |v| z + delta v
/// |z|).
struct Hysteresis {
  double alpha{0.0}, beta{0.0}, gamma{0.0}, delta{0.0};
  [[nodiscard]] double rate(double v, double z) const {
    return alpha * v - beta * (gamma * std::abs(v) * z + delta * v * std::abs(z));
  }
};

class Drive {
 public:
  Drive() {
    std::mt19937_64 random{11};
    std::uniform_real_distribution<double> any{0.0, 1.0};
    for (std::size_t i = 0; i < kTones; ++i)
      tones_[i] = {2.0 * M_PI * (2.0 + (118.0 * (static_cast<double>(i) + any(random))) / kTones),
                   2.0 * M_PI * any(random)};
  }

  [[nodiscard]] double operator()(double time_s) const {
    double sum = 0.0;
    for (const auto& [w, phase] : tones_) sum += std::cos(w * time_s + phase);
    return 80.0 * sum / std::sqrt(0.5 * kTones);
  }

 private:
  static constexpr std::size_t kTones = 50;
  std::array<std::array<double, 2>, kTones> tones_{};
};

/// 600 Hz, 20 s; deflection with noise of 2 um.
std::string record(const Law& law, const Hysteresis& hysteresis = {}) {
  constexpr int kFine = 24;
  constexpr double kStepS = 1.0 / (600.0 * kFine);
  const Drive drive;
  std::mt19937_64 random{5};
  std::normal_distribution<double> noise;
  double x = 0.0;
  double v = 0.0;
  double z = 0.0;
  const auto accel = [&](double t, double at, double rate) {
    return (drive(t) - kViscous * rate - kStiffnessNpm * at - law(at, rate) - z) / kMassKg;
  };
  std::string out = "time_s,deflection_m,force_n\n";
  for (int i = -600 * kFine; i < 20 * 600 * kFine; ++i) {
    const double t = i * kStepS;
    if (i >= 0 && i % kFine == 0)
      out += fmt::format("{:.6f},{:.9f},{:.5f}\n", t, x + 2e-6 * noise(random), drive(t));
    const double h = 0.5 * kStepS;
    const double a1 = accel(t, x, v);
    const double a2 = accel(t + h, x + h * v, v + h * a1);
    const double a3 = accel(t + h, x + h * (v + h * a1), v + h * a2);
    const double a4 = accel(t + kStepS, x + kStepS * (v + h * a2), v + kStepS * a3);
    x += kStepS * v + kStepS * kStepS / 6.0 * (a1 + a2 + a3);
    const double middle = v + 0.5 * h * (a1 + a2);
    v += kStepS / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    z += kStepS * hysteresis.rate(middle, z + h * hysteresis.rate(middle, z));
  }
  return out;
}

rig::Explanation explained(const Law& law, const std::string& inertia = "identify",
                           const Hysteresis& hysteresis = {}) {
  Config config;
  config.model.base = {"viscous"};
  config.model.inertia = inertia;
  config.model.stiffness = "identify";
  return dampline::test::explained(record(law, hysteresis), config);
}

void expect_the_rest(const rig::Explanation& found) {
  EXPECT_NEAR(value_of(found, "moving_mass"), kMassKg, 0.01 * kMassKg) << summarize(found);
  EXPECT_NEAR(value_of(found, "stiffness"), kStiffnessNpm, 0.01 * kStiffnessNpm);
  EXPECT_NEAR(value_of(found, "viscous"), kViscous, 0.03 * kViscous);
}

TEST(ADrivenMass, IsWholeWhereNothingIsMissing) {
  const rig::Explanation found = explained([](double, double) { return 0.0; });
  EXPECT_TRUE(found.steps.empty()) << summarize(found);
  EXPECT_EQ(std::string{found.verdict()}, "complete");
  expect_the_rest(found);
}

TEST(ADrivenMass, HasASpringThatHardens) {
  const rig::Explanation found = explained([](double x, double) { return 4.4e9 * x * x * x; });
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "cubic_stiffness");
  EXPECT_NEAR(value_of(found, "cubic_stiffness"), 4.4e9, 0.02 * 4.4e9);
  expect_the_rest(found);
}

TEST(ADrivenMass, IsToldFromADamperWithoutBeingDeclared) {
  const Law hard = [](double x, double) { return 4.4e9 * x * x * x; };
  const rig::Explanation found = explained(hard, "auto");
  ASSERT_FALSE(found.notes.empty());
  EXPECT_NE(found.notes[0].find("An inertia"), std::string::npos) << found.notes[0];
  EXPECT_NEAR(value_of(found, "moving_mass"), kMassKg, 0.02 * kMassKg) << summarize(found);
}

TEST(ADrivenMass, IsDampedOtherwiseUpAndDown) {
  const rig::Explanation found =
      explained([](double, double v) { return v > 0.0 ? 7.0 * v : 0.0; });
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "asymmetric_viscous");
  EXPECT_NEAR(value_of(found, "viscous_positive"), 13.0, 0.4);
  EXPECT_NEAR(value_of(found, "viscous_negative"), 6.0, 0.4);
}

void expect_hysteresis(const Hysteresis& planted) {
  const rig::Explanation found = explained([](double, double) { return 0.0; }, "identify", planted);
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "presliding_hysteresis");
  EXPECT_STREQ(found.verdict(), "explained") << summarize(found);
  const double travel_m = 1.0 / (planted.beta * planted.gamma);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_travel"), travel_m, 0.08 * travel_m);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_shape"), planted.delta / planted.gamma, 0.05);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_stiffness"), planted.alpha,
              0.03 * planted.alpha)
      << summarize(found);
  EXPECT_NEAR(value_of(found, "moving_mass"), kMassKg, 0.01 * kMassKg);
}

TEST(ADrivenMass, HasASpringWithBoucsAndWensHysteresis) {
  expect_hysteresis({6.0e4, 1500.0, 0.9, -1.17});
}

TEST(ADrivenMass, HasAFrictionThatBuildsUpAsDahls) { expect_hysteresis({7.0e4, 2600.0, 1.0, 0.0}); }

}  // namespace
}  // namespace dampline::app
