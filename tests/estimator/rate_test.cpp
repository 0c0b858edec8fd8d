// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "dampline/motion/butterworth.hpp"
#include "tests/estimator/record.hpp"
#include "tests/steps.hpp"

namespace dampline {
namespace {

constexpr double kMassKg = 12000.0;
constexpr double kStiffnessNpm = 1.5e6;
constexpr double kCoulombN = 3000.0;
constexpr int kOversampling = 10;

/// A prescribed deflection, sums of sines, so that the truth is a formula; z_b'' follows from the
/// equation of motion, the wheelsets from y''. Filtered and sampled at any rate.
std::vector<Sample> prescribed(double rate_hz, double length_s) {
  struct Sine {
    double w, amplitude_mps, phase;
  };
  std::mt19937_64 random{17};
  std::uniform_real_distribution<double> phase{0.0, 2.0 * std::numbers::pi};
  std::vector<Sine> sines;
  const auto octaves = std::log2(0.2 * rate_hz / 1.5);
  for (const double octave : steps(0.0, octaves, 0.111)) {
    const double f_hz = 1.5 * std::exp2(octave);
    // Shifted by an irrational part, so that nothing repeats.
    const double w = 2.0 * std::numbers::pi * (f_hz + 0.1 * std::sin(7.0 * f_hz));
    sines.push_back({w, 3.0e-3, phase(random)});
  }
  ButterworthLowPass<3> filter{rate_hz / 3.0, kOversampling * rate_hz};
  std::vector<Sample> out;
  const auto count = static_cast<std::int64_t>(length_s * rate_hz * kOversampling);
  for (std::int64_t i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (kOversampling * rate_hz);
    double y = 0.0;
    double v = 0.0;
    double a = 0.0;
    for (const Sine& s : sines) {
      const double c = s.amplitude_mps * std::cos(s.w * t + s.phase);
      const double n = s.amplitude_mps * std::sin(s.w * t + s.phase);
      y += n / s.w;
      v += c;
      a -= n * s.w;
    }
    const double force_n = kStiffnessNpm * y + kCoulombN * std::tanh(v / 0.5e-3);
    const double frame_mps2 = -force_n / kMassKg;
    const double wheelset_mps2 = frame_mps2 - 0.5 * a;
    const auto filtered = filter.update({frame_mps2, wheelset_mps2, wheelset_mps2});
    if (i % kOversampling != 0) continue;
    Sample sample;
    sample.tick = i / kOversampling;
    sample.accel_mps2 = filtered;
    out.push_back(sample);
  }
  return out;
}

class IdentifierAtRate : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Rates, IdentifierAtRate, testing::Values(150.0, 200.0, 300.0, 400.0));

TEST_P(IdentifierAtRate, FindsThePrescribedParameters) {
  const EstimatorConfig config{.sample_rate_hz = GetParam(),
                               .moving_mass_kg = kMassKg,
                               .anti_alias = {.corner_hz = GetParam() / 3.0}};
  ASSERT_TRUE(Estimator::check(config).ok());
  const Snapshot s = identify(prescribed(GetParam(), 100.0), config).snapshot;
  ASSERT_TRUE(s.valid);
  // What a truck's velocity has between slow samples is put back; this one has nothing there.
  const double put_back = 0.0055 * std::max(std::pow(300.0 / GetParam(), 2) - 1.0, 0.0);
  EXPECT_NEAR(s.coulomb_n.value / kCoulombN, 1.0 + put_back, 0.005);
  EXPECT_NEAR(s.stiffness_npm.value / kStiffnessNpm, 1.0, 0.03);
  EXPECT_EQ(s.counts.blocks, 50U);
  EXPECT_GE(s.blocks_in_estimate, 46U);
}

TEST_P(IdentifierAtRate, LosesNoRow) {
  const EstimatorConfig config{.sample_rate_hz = GetParam(), .moving_mass_kg = kMassKg};
  const auto identifier = std::make_unique<Estimator>(config);
  for (const Sample& s : prescribed(GetParam(), 70.0)) identifier->update(s);
  identifier->finish();
  const auto statistics = std::make_unique<Statistics>();
  identifier->export_statistics(*statistics);
  double rows = 0.0;
  for (const double n : statistics->total.rows) rows += n;
  EXPECT_EQ(rows, static_cast<double>(statistics->header.counts.rows));
}

}  // namespace
}  // namespace dampline
