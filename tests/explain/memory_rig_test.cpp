// SPDX-License-Identifier: MIT
// Friction that builds up, in a harmonic motion of one tone: its loop is nearly that of a friction
// that is late, of a hardening spring beside one, and of a rig that rings.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "tests/explain/explained_rig.hpp"

namespace dampline::app {
namespace {

using dampline::test::explained;
using dampline::test::value_of;

constexpr double kForceN = 1800.0;

/// The friction's next value, of -1 ... 1, after a step of the deflection.
using Friction = std::function<double(double step_m)>;

std::string record_of(const Friction& friction) {
  std::mt19937_64 random{17};
  std::normal_distribution<double> noise;
  constexpr int kFine = 40;
  const double w = 2.0 * M_PI * 0.77;
  const auto deflection_m = [&](double t) { return 0.011 * std::sin(w * t + 0.4); };
  std::string text = "time_s,deflection_m,force_n\n";
  double last_m = deflection_m(-3.0);
  for (int i = -3 * 250 * kFine; i < 40 * 250 * kFine; ++i) {
    const double t = i / (250.0 * kFine);
    const double x = deflection_m(t);
    const double level = friction(x - last_m);
    last_m = x;
    if (i < 0 || i % kFine != 0) continue;
    const double v = 0.011 * w * std::cos(w * t + 0.4);
    text += fmt::format("{:.6f},{:.9f},{:.4f}\n", t, x + 2e-7 * noise(random),
                        kForceN * level + 24e3 * v + 18.0 * noise(random));
  }
  return text;
}

void expect_presliding(const rig::Explanation& found) {
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "presliding_hysteresis");
  EXPECT_LT(found.final.fit.held_out_nmse, 0.01 * found.base.fit.held_out_nmse);
}

TEST(MemoryOfOneTone, OfDahlIsFoundWithItsTravel) {
  double z = 0.0;
  const rig::Explanation found = explained(record_of([&](double step_m) {
    z += step_m / 0.0017 * (1.0 - z * (step_m < 0.0 ? -1.0 : 1.0));
    return z;
  }));
  expect_presliding(found);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_travel"), 0.0017, 0.02 * 0.0017);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_force"), kForceN, 0.02 * kForceN);
  EXPECT_NEAR(value_of(found, "viscous"), 24e3, 1.2e3);
}

TEST(MemoryOfOneTone, OfManyElementsIsNoSpringAndNoMode) {
  std::array<double, 9> slip{};
  expect_presliding(explained(record_of([&](double step_m) {
    double sum = 0.0;
    for (std::size_t j = 0; j < slip.size(); ++j) {
      const double travel_m = 0.0009 * (static_cast<double>(j) + 0.6);
      slip[j] = std::clamp(slip[j] + step_m / travel_m, -1.0, 1.0);
      sum += slip[j];
    }
    return sum / static_cast<double>(slip.size());
  })));
}

}  // namespace
}  // namespace dampline::app
