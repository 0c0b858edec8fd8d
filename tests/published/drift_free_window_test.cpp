// SPDX-License-Identifier: MIT
#include "published/oscillator/drift_free_window.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

namespace dampline {
namespace {

constexpr int kBlock = 1200;
constexpr int kGuard = 300;
constexpr double kWindowStepS = 1.0 / 300.0;
using Window = DriftFreeWindow<kBlock, kGuard>;

std::unique_ptr<Window> integrate(const std::function<double(double)>& accel) {
  auto window = std::make_unique<Window>();
  const auto at = [&](long i) { return accel(static_cast<double>(i) * kWindowStepS); };
  for (int i = 0; i < Window::kVelocitySteps; ++i) window->integrate_velocity(i, kWindowStepS, at);
  for (int i = 0; i < Window::kDeflectionSteps; ++i) window->integrate_deflection(i, kWindowStepS);
  for (int i = 0; i < kBlock; ++i) window->remove_drift(i);
  return window;
}

/// Three sines, each with its exact integrals.
struct Motion {
  [[nodiscard]] static double sum(double t, int integrals) {
    double out = 0.0;
    for (const double f : {2.0, 3.1, 11.0}) {
      const double w = 2.0 * std::numbers::pi * f;
      out +=
          std::sin(w * t + 0.3 * f - 0.5 * std::numbers::pi * integrals) / std::pow(w, integrals);
    }
    return out;
  }
};

/// A signal at the block's samples less its polynomial over the window.
template <class Signal>
std::array<double, kBlock> without_polynomial(const Signal& signal) {
  const Window::Slow slow;
  Window::Slow::Values trend{};
  for (int i = 0; i < Window::kLength; ++i) {
    const auto p = slow.at(i);
    for (std::size_t j = 0; j < p.size(); ++j) trend[j] += p[j] * signal(i * kWindowStepS);
  }
  std::array<double, kBlock> out{};
  for (int i = 0; i < kBlock; ++i) {
    const auto p = slow.at(i + kGuard);
    out[static_cast<std::size_t>(i)] =
        signal((i + kGuard) * kWindowStepS) - Window::Slow::sum(trend, p);
  }
  return out;
}

TEST(DriftFreeWindow, IsTheExactIntegralLessItsPolynomial) {
  const auto window = integrate([](double t) { return Motion::sum(t, 0); });
  const auto v = without_polynomial([](double t) { return Motion::sum(t, 1); });
  const auto x = without_polynomial([](double t) { return Motion::sum(t, 2); });
  double square = 0.0;
  for (int i = 0; i < kBlock; ++i) {
    const auto at = static_cast<std::size_t>(i);
    ASSERT_NEAR(window->velocity_mps(i), v[at], 2e-9);   // of 0.15 m/s
    ASSERT_NEAR(window->deflection_m(i), x[at], 2e-11);  // of 9 mm
    square += v[at] * v[at];
  }
  EXPECT_NEAR(window->velocity_rms_mps(), std::sqrt(square / kBlock), 1e-9);
}

TEST(DriftFreeWindow, GivesNothingForABiasAndALinearDrift) {
  const auto window = integrate([](double t) { return 0.35 - 0.02 * t; });
  for (int i = 0; i < kBlock; ++i) {
    ASSERT_NEAR(window->velocity_mps(i), 0.0, 1e-11);
    ASSERT_NEAR(window->deflection_m(i), 0.0, 1e-11);
  }
}

TEST(DriftFreeWindow, KeepsWhatIsWellAboveTheDegreeOfThePolynomial) {
  const auto window = integrate([](double t) { return std::sin(8.0 * std::numbers::pi * t); });
  double largest = 0.0;
  for (int i = 0; i < kBlock; ++i) largest = std::max(largest, std::abs(window->velocity_mps(i)));
  EXPECT_NEAR(largest, 1.0 / (8.0 * std::numbers::pi), 1e-3);
}

}  // namespace
}  // namespace dampline
