// SPDX-License-Identifier: MIT
// Laws from the motion that a known force makes of them, integrated here in steps of a fortieth.
#include "app/law/shooting.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

namespace dampline::app::law {
namespace {

constexpr double kIntervalS = 0.01;
constexpr int kSamples = 1500;
constexpr int kFine = 40;
constexpr double kMassKg = 2.0;
constexpr double kViscous = 5.0;
constexpr double kStiffnessNpm = 500.0;

double force_at(double t) {
  return 9.0 * std::sin(5.1 * t) + 7.0 * std::sin(13.7 * t + 1.0) + 6.0 * std::sin(23.0 * t + 2.0);
}

/// `cubic` beside the spring; Runge and Kutta's fourth order.
Eigen::VectorXd motion(double cubic) {
  const double h = kIntervalS / kFine;
  double x = 0.0;
  double v = 0.0;
  Eigen::VectorXd out{kSamples};
  const auto accel = [&](double t, double at, double rate) {
    return (force_at(t) - kViscous * rate - kStiffnessNpm * at - cubic * at * at * at) / kMassKg;
  };
  for (int i = 0; i < kSamples * kFine; ++i) {
    if (i % kFine == 0) out[i / kFine] = x;
    const double t = i * h;
    const double a = accel(t, x, v);
    const double b = accel(t + 0.5 * h, x + 0.5 * h * v, v + 0.5 * h * a);
    const double c = accel(t + 0.5 * h, x + 0.5 * h * (v + 0.5 * h * a), v + 0.5 * h * b);
    const double d = accel(t + h, x + h * (v + 0.5 * h * b), v + h * c);
    x += h * v + h * h / 6.0 * (a + b + c);
    v += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  return out;
}

Drive drive_of(const Eigen::VectorXd& seen) {
  Eigen::VectorXd force{kSamples};
  for (int i = 0; i < kSamples; ++i) force[i] = force_at(i * kIntervalS);
  Eigen::VectorXd velocity = Eigen::VectorXd::Zero(kSamples);
  for (int i = 1; i + 1 < kSamples; ++i)
    velocity[i] = (seen[i + 1] - seen[i - 1]) / (2.0 * kIntervalS);
  return {Input{force, kIntervalS}, seen, velocity, {}};
}

Law law_of(const Eigen::VectorXd& u) {
  Law out{u[0], {{{Kind::kVelocity}, u[1]}, {{Kind::kDeflection}, u[2]}}};
  if (u.size() > 3) out.terms.push_back({{Kind::kCube}, u[3]});
  return out;
}

Shot shot_of(const Eigen::VectorXd& start, const Eigen::VectorXd& seen) {
  std::vector<bool> positive(static_cast<std::size_t>(start.size()), false);
  positive[0] = true;
  return shoot(law_of, start, start.cwiseAbs(), positive, {drive_of(seen)});
}

TEST(Shooting, FindsTheLawFromFarAndFollowsItToTheEnd) {
  const Eigen::Vector4d truth{kMassKg, kViscous, kStiffnessNpm, 2e5};
  const Eigen::Vector4d start{1.7, 7.0, 430.0, 1e5};
  const Shot shot = shot_of(start, motion(2e5));
  ASSERT_TRUE(shot.ok);
  EXPECT_EQ(shot.segments, 1U) << "the whole record";
  for (Eigen::Index i = 0; i < 4; ++i)
    EXPECT_NEAR(shot.unknowns[i], truth[i], 2e-4 * truth[i]) << i;
  EXPECT_LT(shot.nmse, 1e-9);
}

TEST(Shooting, StatesDeviationsThatHold) {
  constexpr int kSeeds = 40;
  const Eigen::Vector3d truth{kMassKg, kViscous, kStiffnessNpm};
  const Eigen::VectorXd clean = motion(0.0);
  const double noise_m = 0.05 * std::sqrt(clean.squaredNorm() / kSamples);
  int within = 0;
  double squares = 0.0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    std::mt19937_64 random{static_cast<unsigned>(seed)};
    std::normal_distribution<double> noise{0.0, noise_m};
    Eigen::VectorXd seen = clean;
    for (double& x : seen) x += noise(random);
    const Shot shot = shot_of(Eigen::Vector3d{1.8, 6.0, 450.0}, seen);
    ASSERT_TRUE(shot.ok);
    EXPECT_NEAR(shot.residual_m, noise_m, 0.1 * noise_m);
    EXPECT_GT(shot.held_out_nmse, 0.98 * shot.nmse);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double z = (shot.unknowns[i] - truth[i]) / std::sqrt(shot.covariance(i, i));
      within += std::abs(z) <= 2.0 ? 1 : 0;
      squares += z * z;
    }
  }
  EXPECT_GE(within, 0.90 * 3 * kSeeds);
  EXPECT_LE(within, 0.99 * 3 * kSeeds);
  EXPECT_NEAR(std::sqrt(squares / (3 * kSeeds)), 1.0, 0.25);
}

TEST(Shooting, SaysWhatAnotherLawMisses) {
  const Eigen::VectorXd seen = motion(2e5);
  const Eigen::Vector3d linear{kMassKg, kViscous, kStiffnessNpm};
  const Shot right = follow(law_of, Eigen::Vector4d{kMassKg, kViscous, kStiffnessNpm, 2e5},
                            {drive_of(seen)}, kSamples * kIntervalS);
  const Shot wrong = follow(law_of, linear, {drive_of(seen)}, kSamples * kIntervalS);
  ASSERT_TRUE(right.ok && wrong.ok);
  EXPECT_LT(right.nmse, 1e-9);
  EXPECT_GT(wrong.nmse, 1e-3);
  EXPECT_LT(shot_of(linear, seen).nmse, wrong.nmse) << "refitted, it misses less";
}

}  // namespace
}  // namespace dampline::app::law
