// SPDX-License-Identifier: MIT
// Trucks whose force is known: another simulation than the program's own (impulses of set-valued
// friction instead of a smooth sign, laws written anew, tones instead of a shaped track), sizes
// between the grids, and records as another program would write them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/explanation_json.hpp"
#include "tests/drivers/temporary_file.hpp"

namespace dampline::app {
namespace {

constexpr double kRateHz = 300.0;
constexpr std::size_t kFine = 16;  // steps per sample
constexpr double kStepS = 1.0 / (kRateHz * kFine);
constexpr double kLengthS = 120.0;
constexpr double kMassKg = 37200.0;
constexpr double kSpringNpm = 5.0e6;
constexpr double kCoulombN = 8100.0;
constexpr double kSpeedMps = 21.0;
constexpr double kWheelbaseM = 1.8;

/// A wheelset's acceleration at every fine step: tones under the spectrum of an ordinary track,
/// and a band of short waves.
std::vector<double> road(std::size_t steps) {
  std::mt19937_64 random{7};
  std::uniform_real_distribution<double> uniform;
  std::vector<double> out(steps, 0.0);
  const auto add = [&](double hz, double amplitude_mps2) {
    const double w = 2.0 * M_PI * hz * kStepS;
    const double phase = 2.0 * M_PI * uniform(random);
    for (std::size_t i = 0; i < steps; ++i)
      out[i] += amplitude_mps2 * std::cos(w * static_cast<double>(i) + phase);
  };
  for (double hz = 0.4; hz < 40.0; hz *= 1.09) {
    const double from = 2.0 * M_PI * hz / kSpeedMps;
    const double density = 4.032e-7 * 0.8246 * 0.8246 /
                           ((from * from + 0.0206 * 0.0206) * (from * from + 0.8246 * 0.8246));
    const double height_m = std::sqrt(2.0 * density * 0.09 * from);
    add(hz * (1.0 + 0.04 * uniform(random)), height_m * std::pow(2.0 * M_PI * hz, 2));
  }
  for (int i = 0; i < 25; ++i) add(46.0 + 28.0 * uniform(random), 0.55);
  return out;
}

/// Two poles of a low-pass of fourth order at 100 Hz, as sensors have it.
class LowPass {
 public:
  explicit LowPass(double quality) {
    const double k = std::tan(M_PI * 100.0 * kStepS);
    const double norm = 1.0 / (1.0 + k / quality + k * k);
    gain_ = k * k * norm;
    a1_ = 2.0 * (k * k - 1.0) * norm;
    a2_ = (1.0 - k / quality + k * k) * norm;
  }
  double next(double x) {
    const double y = gain_ * x + s1_;
    s1_ = 2.0 * gain_ * x - a1_ * y + s2_;
    s2_ = gain_ * x - a2_ * y;
    return y;
  }

 private:
  double gain_, a1_, a2_;
  double s1_{0.0}, s2_{0.0};
};

struct State {
  double time_s{0.0};
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double frame_mps2{0.0};
};

/// What is planted: the force beside spring and friction, and the level of the friction.
struct Plant {
  std::function<double(const State&)> force = [](const State&) { return 0.0; };
  std::function<double(const State&)> level = [](const State&) { return kCoulombN; };
  std::array<double, 3> gain{1.0, 1.0, 1.0};
  std::size_t frame_late{0};       // fine steps
  double moving_mass_kg{kMassKg};  // with what rides on the frame
};

double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }

std::string record_of(const Plant& plant, std::uint64_t seed) {
  static const std::vector<double> input =
      road(static_cast<std::size_t>(kLengthS * kRateHz) * kFine);
  const auto delay = static_cast<std::size_t>(kWheelbaseM / kSpeedMps / kStepS);
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise{0.0, 0.02};
  std::array<std::array<LowPass, 2>, 3> sensors{{{LowPass{0.5412}, LowPass{1.3066}},
                                                 {LowPass{0.5412}, LowPass{1.3066}},
                                                 {LowPass{0.5412}, LowPass{1.3066}}}};
  std::string text = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  State state;
  std::vector<double> late(plant.frame_late + 1, 0.0);
  for (std::size_t i = 0; i < input.size(); ++i) {
    const double one = input[i];
    const double two = i < delay ? 0.0 : input[i - delay];
    state.time_s = static_cast<double>(i) * kStepS;
    // The friction's impulse stops the motion or takes all that its level allows.
    const double elastic_n = kSpringNpm * state.deflection_m + plant.force(state);
    const double without = state.velocity_mps + kStepS * (-2.0 * elastic_n / kMassKg - one - two);
    const double most = 2.0 * plant.level(state) / kMassKg * kStepS;
    const double velocity = sign(without) * std::max(std::abs(without) - most, 0.0);
    state.frame_mps2 = 0.5 * ((velocity - state.velocity_mps) / kStepS + one + two);
    state.velocity_mps = velocity;
    state.deflection_m += kStepS * velocity;
    late[i % late.size()] = state.frame_mps2;
    const std::array<double, 3> seen{late[(i + 1) % late.size()], one, two};
    std::array<double, 3> out{};
    for (std::size_t c = 0; c < 3; ++c)
      out[c] = sensors[c][1].next(sensors[c][0].next(plant.gain[c] * seen[c]));
    if (i % kFine != 0) continue;
    text += fmt::format("{:.6f}", state.time_s);
    for (const double a : out) text += fmt::format(",{:.3f}", a + 0.1 + noise(random));
    text += '\n';
  }
  return text;
}

Explained explained(const Plant& plant, std::uint64_t seed) {
  const dampline::test::TemporaryFile file{record_of(plant, seed), ".csv"};
  Config config;
  config.car.moving_mass_kg = plant.moving_mass_kg;
  return explain_truck(config, {{file.path(), false}, {}, false});
}

Plant force(std::function<double(const State&)> law) {
  Plant out;
  out.force = std::move(law);
  return out;
}
Plant level(std::function<double(const State&)> law) {
  Plant out;
  out.level = std::move(law);
  return out;
}

/// Friction that builds up over a distance; softer towards its end than Dahl's.
Plant presliding(double length_m) {
  Plant out = level([](const State&) { return 0.0; });
  out.force = [length_m, z = 0.0](const State& s) mutable {
    const double left = 1.0 - z * sign(s.velocity_mps);
    z += s.velocity_mps * kStepS * left * std::sqrt(left) / length_m;
    z = std::clamp(z, -1.0, 1.0);
    return kCoulombN * z;
  };
  return out;
}

/// A friction element behind a pin in a slot.
Plant backlash(double gap_m) {
  Plant out = level([](const State&) { return 0.0; });
  out.force = [gap_m, pin_m = 0.0, stretch_m = 0.0](const State& s) mutable {
    const double moved = pin_m + s.velocity_mps * kStepS;
    pin_m = std::clamp(moved, -0.5 * gap_m, 0.5 * gap_m);
    stretch_m = std::clamp(stretch_m + moved - pin_m, -5e-5, 5e-5);
    if (std::abs(pin_m) < 0.5 * gap_m) stretch_m = 0.0;
    return kCoulombN * stretch_m / 5e-5;
  };
  return out;
}

/// A mass on a spring on the frame; its force on the frame comes through the suspension's balance.
Plant mode(double share, double hz) {
  Plant out = force([share, w = 2.0 * M_PI * hz, x = 0.0, u = 0.0](const State& s) mutable {
    // x: the mass's motion relative to the frame.
    u += kStepS * (-w * w * x - 2.0 * 0.03 * w * u - s.frame_mps2);
    x += kStepS * u;
    return -share * kMassKg * (w * w * x + 2.0 * 0.03 * w * u);
  });
  out.moving_mass_kg += share * kMassKg;
  return out;
}

struct Planted {
  const char* name;
  const char* effect;
  Plant plant;
};

class NamesOnATruck : public ::testing::TestWithParam<Planted> {};

TEST_P(NamesOnATruck, WhatWasPlanted) {
  const Explained found = explained(GetParam().plant, 17);
  const effect::Explanation& e = found.explanation;
  ASSERT_GE(e.step_count, 1U) << summarize(found);
  EXPECT_STREQ(effect::name_of(e.step[0].chosen.effect), GetParam().effect) << summarize(found);
  EXPECT_LT(e.final.held_out_nmse, e.base.held_out_nmse);
  EXPECT_NEAR(e.final_stiffness_npm.value, kSpringNpm, 0.1 * kSpringNpm) << summarize(found);
}

Plant late() {
  Plant out;
  out.frame_late = 7;  // 1.46 ms
  return out;
}
Plant wrong_gain() {
  Plant out;
  out.gain[2] = 0.957;
  return out;
}

INSTANTIATE_TEST_SUITE_P(
    Laws, NamesOnATruck,
    ::testing::Values(
        Planted{"viscous", "viscous", force([](const State& s) { return 97e3 * s.velocity_mps; })},
        Planted{"asymmetric_viscous", "asymmetric_viscous", force([](const State& s) {
                  return (s.velocity_mps > 0.0 ? 190e3 : 30e3) * s.velocity_mps;
                })},
        Planted{"quadratic_damping", "quadratic_damping", force([](const State& s) {
                  return 5.1e6 * s.velocity_mps * std::abs(s.velocity_mps);
                })},
        Planted{"stribeck", "stribeck", level([](const State& s) {
                  const double u = s.velocity_mps / 0.012;
                  return kCoulombN * (1.0 + 0.45 * std::exp(-u * u));
                })},
        Planted{"progressive_friction", "progressive_friction", level([](const State& s) {
                  return kCoulombN * std::max(1.0 + s.deflection_m / 0.0047, 0.0);
                })},
        Planted{"presliding_hysteresis", "presliding_hysteresis", presliding(1.3e-4)},
        Planted{"backlash", "backlash", backlash(3.3e-4)},
        Planted{"bump_stop", "bump_stop", force([](const State& s) {
                  const double over = std::max(std::abs(s.deflection_m) - 0.00137, 0.0);
                  return 14e6 * over * sign(s.deflection_m);
                })},
        Planted{"one_sided_stop", "bump_stop", force([](const State& s) {
                  return 17e6 * std::min(s.deflection_m + 0.00119, 0.0);
                })},
        Planted{"cubic_stiffness", "cubic_stiffness",
                force([](const State& s) { return 4.4e11 * std::pow(s.deflection_m, 3); })},
        Planted{"quadratic_stiffness", "quadratic_stiffness",
                force([](const State& s) { return 6e8 * s.deflection_m * s.deflection_m; })},
        Planted{"asymmetric_stiffness", "asymmetric_stiffness",
                force([](const State& s) { return 0.7e6 * std::abs(s.deflection_m); })},
        Planted{"mode", "unmodelled_mode", mode(0.21, 10.7)},
        Planted{"mode_beyond_the_grid", "unmodelled_mode", mode(0.21, 19.3)},
        Planted{"time_skew", "time_skew", late()},
        Planted{"gain_error", "gain_error", wrong_gain()}),
    [](const ::testing::TestParamInfo<Planted>& tested) { return std::string{tested.param.name}; });

double found_in(const effect::Step& step, const std::string& name) {
  for (std::size_t i = 0; i < step.parameter_count; ++i)
    if (name == step.parameter[i].name) return step.parameter[i].estimate.value;
  return 0.0;
}

TEST(ATruck, ALateChannelIsSetRight) {
  Plant plant;
  plant.frame_late = 11;
  const Explained found = explained(plant, 18);
  const effect::Explanation& e = found.explanation;
  ASSERT_EQ(e.step_count, 1U) << summarize(found);
  // The motion, which takes the new velocity for its step, is half a step ahead of the input.
  const double late_s = (11.0 - 0.5) * kStepS;
  EXPECT_NEAR(found_in(e.step[0], "time_skew_frame"), late_s, 0.03 * late_s) << summarize(found);
  EXPECT_NEAR(e.final_coulomb_n.value, kCoulombN, 0.01 * kCoulombN);
  EXPECT_NEAR(e.final_stiffness_npm.value, kSpringNpm, 0.02 * kSpringNpm) << summarize(found);
}

TEST(ATruck, AModeIsFoundBetweenThePointsOfItsGrid) {
  const Explained found = explained(mode(0.21, 9.65), 19);
  const effect::Explanation& e = found.explanation;
  ASSERT_EQ(e.step_count, 1U) << summarize(found);
  EXPECT_NEAR(found_in(e.step[0], "unmodelled_mode_frequency"), 9.65, 0.05) << summarize(found);
}

TEST(ATruck, LacksNothingWhereNothingIsMissing) {
  for (const std::uint64_t seed : {21U, 22U}) {
    const Explained found = explained({}, seed);
    EXPECT_EQ(found.explanation.conclusion, effect::Conclusion::kComplete) << summarize(found);
    EXPECT_NEAR(found.explanation.base_coulomb_n.value, kCoulombN, 0.02 * kCoulombN);
  }
}

TEST(ATruck, LacksSomethingWithoutAName) {
  // A force that has nothing to do with the motion.
  const Explained found = explained(force([](const State& s) {
                                      return 5e3 * std::sin(31.0 * s.time_s) *
                                             std::sin(0.37 * s.time_s * std::sqrt(s.time_s + 1.0));
                                    }),
                                    31);
  EXPECT_EQ(found.explanation.step_count, 0U) << summarize(found);
  EXPECT_EQ(found.explanation.conclusion, effect::Conclusion::kUnexplained) << summarize(found);
}

}  // namespace
}  // namespace dampline::app
