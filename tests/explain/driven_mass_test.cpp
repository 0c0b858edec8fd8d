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
#include <utility>
#include <vector>

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
/// |z|); and what a dashpot takes of it.
struct Hysteresis {
  double alpha{0.0}, beta{0.0}, gamma{0.0}, delta{0.0};
  double relaxation_ps{0.0};
  [[nodiscard]] double rate(double v, double z) const {
    return alpha * v - beta * (gamma * std::abs(v) * z + delta * v * std::abs(z)) -
           relaxation_ps * z;
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
std::string record(const Law& law, const Hysteresis& hysteresis = {}, double noise_m = 2e-6) {
  constexpr int kFine = 24;
  constexpr double kStepS = 1.0 / (600.0 * kFine);
  const Drive drive;
  std::mt19937_64 random{5};
  std::normal_distribution<double> noise;
  double x = 0.0;
  double v = 0.0;
  double z = 0.0;
  const auto accel = [&](double t, double at, double rate, double held) {
    return (drive(t) - kViscous * rate - kStiffnessNpm * at - law(at, rate) - held) / kMassKg;
  };
  std::string out = "time_s,deflection_m,force_n\n";
  for (int i = -600 * kFine; i < 20 * 600 * kFine; ++i) {
    const double t = i * kStepS;
    if (i >= 0 && i % kFine == 0)
      out += fmt::format("{:.6f},{:.9f},{:.5f}\n", t, x + noise_m * noise(random), drive(t));
    const double h = 0.5 * kStepS;
    const double a1 = accel(t, x, v, z);
    const double z1 = hysteresis.rate(v, z);
    const double a2 = accel(t + h, x + h * v, v + h * a1, z + h * z1);
    const double z2 = hysteresis.rate(v + h * a1, z + h * z1);
    const double a3 = accel(t + h, x + h * (v + h * a1), v + h * a2, z + h * z2);
    const double z3 = hysteresis.rate(v + h * a2, z + h * z2);
    const double v4 = v + kStepS * a3;
    const double a4 = accel(t + kStepS, x + kStepS * (v + h * a2), v4, z + kStepS * z3);
    const double z4 = hysteresis.rate(v4, z + kStepS * z3);
    x += kStepS * v + kStepS * kStepS / 6.0 * (a1 + a2 + a3);
    v += kStepS / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
    z += kStepS / 6.0 * (z1 + 2.0 * z2 + 2.0 * z3 + z4);
  }
  return out;
}

rig::Explanation explained(const Law& law, const std::string& inertia = "identify",
                           const Hysteresis& hysteresis = {},
                           const std::vector<std::string>& candidates = {"all"}) {
  Config config;
  config.model.candidates = candidates;
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

TEST(ADrivenMass, IsRefinedByItsOwnMotionWhereTheMotionIsNoisy) {
  const std::string noisy = record([](double, double) { return 0.0; }, {}, 30e-6);
  Config config;
  config.model.base = {"viscous"};
  config.model.candidates = {"cubic_stiffness"};
  config.model.inertia = config.model.stiffness = "identify";
  const rig::Explanation found = dampline::test::explained(noisy, config);
  EXPECT_EQ(std::string{found.verdict()}, "complete") << summarize(found);
  const FreeRunError& run = found.final.free_run;
  EXPECT_TRUE(run.by_motion && run.followed);
  EXPECT_NEAR(run.residual_m, 30e-6, 1e-6);
  EXPECT_GT(run.nmse_of_equations, 2.0 * run.nmse_of_motion) << "the equations alone are bent";
  for (const auto& [name, truth] :
       {std::pair{"moving_mass", kMassKg}, {"stiffness", kStiffnessNpm}, {"viscous", kViscous}}) {
    EXPECT_NEAR(value_of(found, name), truth, 5e-3 * truth) << name;
    dampline::test::expect_size(found, name, truth, 3.0);
  }
}

TEST(ADrivenMassNightly, HasASpringThatHardens) {
  const rig::Explanation found = explained([](double x, double) { return 4.4e9 * x * x * x; });
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "cubic_stiffness");
  EXPECT_NEAR(value_of(found, "cubic_stiffness"), 4.4e9, 0.02 * 4.4e9);
  expect_the_rest(found);
}

TEST(ADrivenMassNightly, HasAHardSpringInItsBase) {
  Config config;
  config.model.base = {"viscous", "cubic_stiffness"};
  config.model.inertia = config.model.stiffness = "identify";
  const rig::Explanation found =
      dampline::test::explained(record([](double x, double) { return 4.4e9 * x * x * x; }), config);
  EXPECT_TRUE(found.steps.empty()) << summarize(found);
  EXPECT_EQ(std::string{found.verdict()}, "complete");
  EXPECT_EQ(found.base.terms.back(), "cubic_stiffness");
  EXPECT_NEAR(value_of(found, "cubic_stiffness"), 4.4e9, 0.02 * 4.4e9);
  expect_the_rest(found);
}

TEST(ADrivenMass, IsMovedByItsOwnDampingAsVanDerPols) {
  constexpr double kDrivingNspm = 26.0;
  constexpr double kProgressive = 1e8;
  Config config;
  config.model.base = {"viscous"};
  config.model.inertia = config.model.stiffness = "identify";
  const rig::Explanation found = dampline::test::explained(
      record([](double x, double v) { return (kProgressive * x * x - kDrivingNspm) * v; }, {},
             10e-6),
      config);
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "progressive_damping");
  EXPECT_EQ(std::string{found.verdict()}, "explained");
  EXPECT_NEAR(value_of(found, "progressive_damping"), kProgressive, 0.01 * kProgressive);
  EXPECT_NEAR(value_of(found, "viscous"), kViscous - kDrivingNspm, 0.2);
}

TEST(ADrivenMassNightly, IsToldFromADamperWithoutBeingDeclared) {
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
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_shape"), planted.delta / planted.gamma, 0.05)
      << summarize(found);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_stiffness"), planted.alpha,
              0.03 * planted.alpha)
      << summarize(found);
  EXPECT_NEAR(value_of(found, "moving_mass"), kMassKg, 0.01 * kMassKg);
}

TEST(ADrivenMassNightly, HasASpringWithBoucsAndWensHysteresis) {
  expect_hysteresis({6.0e4, 1500.0, 0.9, -1.17});
}

TEST(ADrivenMass, HasAFrictionThatBuildsUpAsDahls) { expect_hysteresis({7.0e4, 2600.0, 1.0, 0.0}); }

/// Nobody says what the base is. The deflection's rms is some 0.3 mm.
rig::Explanation freely_explained(const std::string& text,
                                  const std::vector<std::string>& candidates = {"all"}) {
  Config config;
  config.model.candidates = candidates;
  config.model.inertia = config.model.stiffness = "identify";
  return dampline::test::explained(text, config);
}

TEST(ADrivenMassNightly, HasAFrictionThatBuildsUpBehindMuchNoise) {
  const Hysteresis dahl{7.0e4, 2600.0, 1.0, 0.0};
  const rig::Explanation found =
      freely_explained(record([](double, double) { return 0.0; }, dahl, 30e-6));
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "presliding_hysteresis");
  EXPECT_STREQ(found.verdict(), "explained") << summarize(found);
  EXPECT_EQ(found.base.terms.back(), "viscous") << "and no friction beside it";
  EXPECT_LT(found.final.free_run.density_ratio.value(), 1.2);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_stiffness"), dahl.alpha, 0.05 * dahl.alpha);
}

TEST(ADrivenMass, IsNotCompleteWhereMoreThanNoiseIsLeftOfItsMotion) {
  const rig::Explanation found =
      freely_explained(record([](double x, double) { return 2.0e9 * x * x * x; }, {}, 15e-6),
                       {"quadratic_stiffness"});
  EXPECT_GT(found.final.free_run.density_ratio.value(), 1.5) << summarize(found);
  EXPECT_STREQ(found.verdict(), "unexplained");
}

TEST(ADrivenMass, HasASpringBehindADashpotWhereThatIsLookedFor) {
  for (const auto& [stiffness_npm, time_s] : {std::pair{8.0e4, 3.0e-3}, {4.0e4, 9.0e-3}}) {
    const rig::Explanation found =
        explained([](double, double) { return 0.0; }, "identify",
                  {.alpha = stiffness_npm, .relaxation_ps = 1.0 / time_s}, {"all", "viscoelastic"});
    ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
    EXPECT_EQ(found.steps[0].effect, "viscoelastic") << summarize(found);
    dampline::test::expect_size(found, "viscoelastic_stiffness", stiffness_npm, 2.0);
    dampline::test::expect_size(found, "viscoelastic_time", time_s, 2.0);
    EXPECT_NEAR(value_of(found, "moving_mass"), kMassKg, 0.01 * kMassKg) << summarize(found);
  }
}

/// 10 kg on a spring with dry and viscous friction, 1000 Hz, 40 s, which sticks.
struct Sticking {
  unsigned seed{1};
  double force_noise_n{0.0};
  double deflection_noise_m{0.0};
  double coulomb_n{25.0};
  double falls_by_n{0.0};  ///< as the speed rises: exp(-|v| / 0.05 m/s) of it is left
};

std::string record_of(const Sticking& s) {
  constexpr int kSubsteps = 40;
  constexpr double kStepS = 1e-3 / kSubsteps;
  std::mt19937_64 random{s.seed};
  std::uniform_real_distribution<double> any{0.0, 2.0 * M_PI};
  std::normal_distribution<double> noise;
  std::array<double, 40> phases{};
  for (double& phase : phases) phase = any(random);
  const auto force_n = [&](double t) {
    double sum = 0.0;
    for (std::size_t k = 0; k < phases.size(); ++k)
      sum += std::cos(2.0 * M_PI * (0.3 + 0.3 * static_cast<double>(k)) * t + phases[k]);
    return 55.0 * sum / std::sqrt(0.5 * static_cast<double>(phases.size()));
  };
  const auto friction_n = [&](double speed) {
    return s.coulomb_n + s.falls_by_n * std::exp(-speed / 0.05);
  };
  std::string out = "time_s,deflection_m,force_n\n";
  double x = 0.0;
  double v = 0.0;
  for (int i = 0; i < 40000 * kSubsteps; ++i) {
    const double t = i * kStepS;
    const double push_n = force_n(t);
    if (i % kSubsteps == 0)
      out += fmt::format("{:.6f},{:.12g},{:.9g}\n", t, x + s.deflection_noise_m * noise(random),
                         push_n + s.force_noise_n * noise(random));
    const double free_n = push_n - 18.0 * v - 3600.0 * x;
    const double most_n = friction_n(0.0);
    double next = v + kStepS * 0.1 * (free_n - std::copysign(friction_n(std::abs(v)), v));
    if (v == 0.0 || next * v < 0.0)
      next = std::abs(free_n) <= most_n ? 0.0
                                        : kStepS * 0.1 * (free_n - std::copysign(most_n, free_n));
    x += kStepS * next;  // the velocity stands half a step later: second order
    v = next;
  }
  return out;
}

/// Friction's leaps, seen through a test function, bend the equations by two deviations.
TEST(ADrivenMassNightly, IsCompleteWhereItSticksAndItsForceIsNoisy) {
  for (const unsigned seed : {1U, 2U}) {
    Config config;
    config.model.base = {"coulomb", "viscous"};
    config.model.inertia = "identify";
    config.model.stiffness = "identify";
    const rig::Explanation found =
        dampline::test::explained(record_of({.seed = seed, .force_noise_n = 2.75}), config);
    EXPECT_EQ(found.verdict(), "complete") << summarize(found);
    const std::vector<std::pair<const char*, double>> truths{
        {"coulomb", 25.0}, {"moving_mass", 10.0}, {"stiffness", 3600.0}, {"viscous", 18.0}};
    for (const auto& [name, truth] : truths) {
      dampline::test::expect_size(found, name, truth, 2.5);
      EXPECT_NEAR(value_of(found, name), truth, 0.02 * truth) << name << ", seed " << seed;
    }
  }
}

/// Noise of force and deflection, 1 % each, hide one another: more than the deflection's is left of
/// the motion, and less than half of what the equations leave is the force's.
TEST(ADrivenMass, IsCompleteWhereForceAndMotionAreNoisy) {
  Config config;
  config.model.base = {"coulomb", "viscous"};
  config.model.candidates = {"bump_stop"};
  config.model.inertia = config.model.stiffness = "identify";
  Sticking mass{.seed = 3, .force_noise_n = 0.55, .deflection_noise_m = 1e-4};
  const rig::Explanation found = dampline::test::explained(record_of(mass), config);
  EXPECT_EQ(found.verdict(), "complete") << summarize(found);
  const FreeRunError& run = found.final.free_run;
  EXPECT_TRUE(run.by_motion && run.followed);
  EXPECT_GT(run.density_ratio.value(), 1.5);
  EXPECT_GT(run.density_ratio_of_noise.value(), 1.5);
  const std::vector<std::pair<const char*, double>> truths{
      {"coulomb", 25.0}, {"moving_mass", 10.0}, {"stiffness", 3600.0}, {"viscous", 18.0}};
  for (const auto& [name, truth] : truths) {
    dampline::test::expect_size(found, name, truth, 3.0);
    EXPECT_NEAR(value_of(found, name), truth, 0.005 * truth) << name;
  }
  mass.coulomb_n = 15.0;
  mass.falls_by_n = 12.0;
  const rig::Explanation lacking = dampline::test::explained(record_of(mass), config);
  EXPECT_FALSE(lacking.is_complete()) << summarize(lacking);
}

/// A part of these two records speaks for another of the three ways in which friction falls with
/// speed; of seeds 5 to 16 they are the two by which figures were 8 to 20 deviations off.
TEST(ADrivenMassNightly, HasTheFrictionThatFallsAsItDoesBehindMuchNoise) {
  for (const unsigned seed : {7U, 16U}) {
    Config config;
    config.model.base = {"coulomb", "viscous"};
    config.model.candidates = {"stribeck"};
    config.model.inertia = config.model.stiffness = "identify";
    const rig::Explanation found = dampline::test::explained(
        record_of(
            {.seed = seed, .deflection_noise_m = 4e-4, .coulomb_n = 15.0, .falls_by_n = 12.0}),
        config);
    EXPECT_TRUE(found.final.free_run.by_motion) << summarize(found);
    const std::vector<std::pair<const char*, double>> truths{
        {"coulomb", 15.0}, {"moving_mass", 10.0},    {"stiffness", 3600.0},
        {"viscous", 18.0}, {"stribeck_force", 12.0}, {"stribeck_speed", 0.05}};
    for (const auto& [name, truth] : truths) dampline::test::expect_size(found, name, truth, 3.0);
  }
}

}  // namespace
}  // namespace dampline::app
