// SPDX-License-Identifier: MIT
// A mass that a noisy force moves, integrated here in small steps: what the true law leaves of its
// motion, and what the law leaves of noise that it is told of.
#include "app/law/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace dampline::app::law {
namespace {

constexpr double kSampleS = 0.01;
constexpr int kCount = 6000;
constexpr int kSubsteps = 40;
constexpr double kSegmentS = 1.6;  // four periods
constexpr double kCubic = 2e5;
constexpr Noise kNoise{.force_n = 1.5, .deflection_m = 4e-4};

Law hardening(const Eigen::VectorXd& u) {
  return {u[0], {{{Kind::kVelocity}, u[1]}, {{Kind::kDeflection}, u[2]}, {{Kind::kCube}, u[3]}}};
}

/// Under the measured force and the noise that only the mass feels, straight between samples.
Drive measured(unsigned seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  Eigen::VectorXd force_n{kCount};
  for (int i = 0; i < kCount; ++i) {
    const double t = i * kSampleS;
    force_n[i] =
        9.0 * std::sin(5.1 * t) + 7.0 * std::sin(13.7 * t + 1.0) + 6.0 * std::sin(23.0 * t + 2.0);
  }
  Eigen::VectorXd felt_n = force_n;
  for (double& f : felt_n) f += kNoise.force_n * normal(random);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(kCount);
  Eigen::VectorXd v = Eigen::VectorXd::Zero(kCount);
  double at = 0.0;
  double speed = 0.0;
  for (int i = 0; i + 1 < kCount; ++i) {
    x[i] = at + kNoise.deflection_m * normal(random);
    v[i] = speed;
    for (int k = 0; k < kSubsteps; ++k) {
      const double push_n = felt_n[i] + (k + 0.5) / kSubsteps * (felt_n[i + 1] - felt_n[i]);
      speed +=
          kSampleS / kSubsteps * (push_n - 5.0 * speed - 500.0 * at - kCubic * at * at * at) / 2.0;
      at += kSampleS / kSubsteps * speed;
    }
  }
  x[kCount - 1] = at;
  return {Input{force_n, kSampleS}, x, v, {}};
}

TEST(OwnNoise, IsWhatTheTrueLawLeavesAndNotWhatAnotherDoes) {
  const Eigen::Vector4d truth{2.0, 5.0, 500.0, kCubic};
  const Eigen::Vector4d softer{2.0, 5.0, 500.0, 0.5 * kCubic};
  for (const unsigned seed : {1U, 2U, 3U}) {
    const std::vector<Drive> drives{measured(seed)};
    const Shot right = follow(hardening, truth, drives, kSegmentS);
    const Shot own = follow_own_noise(hardening, right, drives, {kNoise}, 7);
    ASSERT_TRUE(right.ok && own.ok);
    EXPECT_GT(right.density.value().ratio(), 2.0) << "the force's noise is seen";
    EXPECT_NEAR(std::log(right.density->excess() / own.density.value().excess()), 0.0,
                std::log(1.6))
        << seed;
    EXPECT_NEAR(right.residual_m, own.residual_m, 0.15 * own.residual_m);
    const Shot wrong = follow(hardening, softer, drives, kSegmentS);
    ASSERT_TRUE(wrong.ok);
    const Shot of_wrong = follow_own_noise(hardening, wrong, drives, {kNoise}, 7);
    EXPECT_GT(wrong.density.value().excess(), 5.0 * of_wrong.density.value().excess());
  }
}

TEST(OwnNoise, IsWhiteWhereOnlyTheDeflectionIsNoisy) {
  const std::vector<Drive> drives{measured(1)};
  const Shot right = follow(hardening, Eigen::Vector4d{2.0, 5.0, 500.0, kCubic}, drives, kSegmentS);
  const Shot own = follow_own_noise(hardening, right, drives, {{0.0, kNoise.deflection_m}}, 7);
  EXPECT_LT(own.density.value().ratio(), 1.2);
  EXPECT_NEAR(own.residual_m, kNoise.deflection_m, 0.05 * kNoise.deflection_m);
}

}  // namespace
}  // namespace dampline::app::law
