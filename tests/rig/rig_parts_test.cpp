// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "dampline/numeric/log_histogram.hpp"
#include "dampline/rig/columns.hpp"
#include "dampline/rig/config.hpp"
#include "dampline/rig/fit.hpp"
#include "dampline/rig/identifier.hpp"
#include "dampline/rig/survey.hpp"

namespace dampline {
namespace {

class RigTestFunction : public testing::TestWithParam<int> {
 protected:
  static constexpr double kInterval = 1e-3;
  template <class Signal>
  rig::TestFunction::Values against(Signal signal) const {
    const rig::TestFunction psi{GetParam(), kInterval};
    rig::TestFunction::Values sum{0.0, 0.0, 0.0};
    for (int j = -psi.half(); j <= psi.half(); ++j) {
      const auto at = psi.at(j);
      const double x = signal(j * kInterval);
      sum.psi += at.psi * x;
      sum.first -= at.first * x;
      sum.second += at.second * x;
    }
    return sum;
  }
};

TEST_P(RigTestFunction, DifferentiatesPolynomialsExactly) {
  const double span = (GetParam() + 1) * kInterval;
  const auto constant = against([](double) { return 0.3; });
  EXPECT_NEAR(constant.psi, 0.3, 1e-14);
  EXPECT_NEAR(constant.first * span, 0.0, 1e-12);
  EXPECT_NEAR(constant.second * span * span, 0.0, 1e-10);
  const auto square = against([](double t) { return 7.0 * t + 5.0 * t * t; });
  EXPECT_NEAR(square.first, 7.0, 1e-11);
  EXPECT_NEAR(square.second, 10.0, 1e-9);
}

TEST_P(RigTestFunction, AgreesWithTheDerivativeOfASineSeenThroughIt) {
  const double w = 0.5 / (GetParam() * kInterval);
  const auto sine = against([w](double t) { return std::cos(w * t + 0.2); });
  EXPECT_NEAR(sine.second, -w * w * sine.psi, 2e-6 * w * w);
}

TEST_P(RigTestFunction, LetsHalfThePowerPassAtTheStatedCorner) {
  const double corner_hz = 0.477 / ((GetParam() - 2) * kInterval);
  const double w = 6.283185307179586 * corner_hz;
  EXPECT_NEAR(against([w](double t) { return std::cos(w * t); }).psi, std::sqrt(0.5), 0.01);
}

INSTANTIATE_TEST_SUITE_P(HalfSupports, RigTestFunction, testing::Values(7, 8, 12, 24, 100, 512));

TEST(RigMeanSign, AveragesTheSignOverTheSample) {
  const rig::MeanSign sharp{1e-9};
  EXPECT_EQ(sharp.mean(0.1, 0.2, 0.3), 1.0);
  EXPECT_EQ(sharp.mean(-0.1, -0.2, -0.3), -1.0);
  EXPECT_NEAR(sharp.mean(-1.0, 0.0, 1.0), 0.0, 1e-8);
  // From -0.25 to 0.75: three quarters of the stretch are positive.
  EXPECT_NEAR(sharp.mean(-0.75, 0.25, 1.25), 0.5, 1e-6);
}

TEST(RigMeanSign, HasSlopeOneOverTheWidthAndAgreesWithANumericalMean) {
  const rig::MeanSign smooth{0.01};
  EXPECT_NEAR(smooth.mean(1e-6, 1e-6, 1e-6), 1e-4, 1e-9);
  double sum = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i)
    sum += std::erf(0.8862269 * (-0.01 + 0.03 * (i + 0.5) / kSteps) / 0.01);
  EXPECT_NEAR(smooth.mean(-0.025, 0.005, 0.035), sum / kSteps, 1e-6);
}

TEST(RigRamps, SumToTheSpeed) {
  const rig::Config config;
  for (const double speed : {0.0, 0.001, 0.0125, 0.03, 0.099, 0.1, 0.5}) {
    double sum = 0.0;
    for (const double part : rig::ramps(speed, config.curve_nodes_mps)) sum += part;
    EXPECT_NEAR(sum, speed, 1e-15);
  }
}

TEST(LogHistogram, FindsQuantilesWithinItsBins) {
  LogHistogram histogram;
  for (int i = 1; i <= 1000; ++i) histogram.add(1e-6 * i);
  histogram.add(0.0);
  histogram.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(histogram.count(), 1000U);
  EXPECT_NEAR(histogram.quantile(0.5), 500e-6, 0.03 * 500e-6);
  EXPECT_NEAR(histogram.quantile(0.99), 990e-6, 0.03 * 990e-6);
}

TEST(RigFolds, HoldEachFifthOfFiveNeighboursOnce) {
  for (std::size_t group = 0; group < 25; ++group) {
    std::set<std::size_t> folds;
    for (std::size_t i = 0; i < 5; ++i) folds.insert(rig::fold_of(5 * group + i));
    EXPECT_EQ(folds.size(), 5U);
  }
  bool order_changes = false;
  for (std::size_t group = 1; group < 25; ++group)
    order_changes |= rig::fold_of(5 * group) != rig::fold_of(0);
  EXPECT_TRUE(order_changes);
}

TEST(RigConfig, RefusesWhatCannotWork) {
  EXPECT_TRUE(check(rig::Config{}).ok());
  const auto refused = [](auto change) {
    rig::Config config;
    change(config);
    return !check(config).ok();
  };
  EXPECT_TRUE(refused([](rig::Config& c) { c.sample_rate_hz = 0.0; }));
  EXPECT_TRUE(refused([](rig::Config& c) { c.corner_hz = 400.0; }));
  EXPECT_TRUE(refused([](rig::Config& c) { c.corner_hz = 0.1; }));
  EXPECT_TRUE(refused([](rig::Config& c) { c.corner_hz = std::nan(""); }));
  EXPECT_TRUE(refused([](rig::Config& c) { c.sign_width_mps = 0.0; }));
  EXPECT_TRUE(refused([](rig::Config& c) { c.block_samples = 0; }));
  EXPECT_TRUE(refused([](rig::Config& c) { c.curve_nodes_mps[3] = c.curve_nodes_mps[2]; }));
  EXPECT_FALSE(
      check(rig::Terms{false, false, rig::Branches::kNone, rig::Branches::kSeparate, true}).ok());
}

TEST(RigSurvey, MeasuresNoiseAndFrequencyOfAHarmonicMotion) {
  rig::Survey survey{1000.0, false};
  std::mt19937_64 random{3};
  std::normal_distribution<double> noise{0.0, 5e-6};
  for (std::int64_t tick = 0; tick < 20000; ++tick) {
    rig::Sample sample;
    sample.tick = tick;
    sample.deflection_m =
        0.01 * std::sin(0.00942477796 * static_cast<double>(tick)) + noise(random);
    survey.update(sample);
  }
  EXPECT_NEAR(survey.motion_frequency_hz(), 1.5, 0.02);
  EXPECT_NEAR(survey.deflection_noise_m(), 5e-6, 0.3e-6);
}

TEST(RigSurvey, MeasuresAMotionOfAFewSamples) {
  rig::Survey survey{1000.0, false};
  std::mt19937_64 random{3};
  std::normal_distribution<double> noise{0.0, 1e-6};
  for (std::int64_t tick = 0; tick < 20000; ++tick) {
    rig::Sample sample;
    sample.tick = tick;
    sample.deflection_m = 1e-3 * std::sin(0.6 * static_cast<double>(tick)) + noise(random);
    survey.update(sample);
  }
  EXPECT_NEAR(survey.motion_frequency_hz(), 95.49, 0.06 * 95.49);  // by the longest span
  EXPECT_NEAR(survey.deflection_noise_m(), 1e-6, 0.3e-6);
  EXPECT_TRUE(survey.suggest({}).value().velocity_sharp);
}

TEST(RigDerivativeWindow, IsExactForSixthPowersWhereItIsSharp) {
  const rig::DerivativeWindow window = rig::DerivativeWindow::sharp(0.1);
  const auto power = [](double t) { return std::pow(t, 6) - 2.0 * std::pow(t, 5) + t; };
  double rate = 0.0;
  for (int j = 1; j <= window.half_width(); ++j)
    rate += window.weight(j) * (power(1.0 + 0.1 * j) - power(1.0 - 0.1 * j));
  EXPECT_NEAR(rate, 6.0 - 10.0 + 1.0, 1e-12);
}

TEST(RigSurvey, IsNotReadyWithoutMotion) {
  rig::Survey survey{1000.0, false};
  EXPECT_EQ(survey.suggest({}).error(), Errc::kNotReady);
  rig::Sample sample;
  for (sample.tick = 0; sample.tick < 1000; ++sample.tick) survey.update(sample);
  EXPECT_EQ(survey.suggest({}).error(), Errc::kNotReady);
}

TEST(RigIdentifier, FitsInHalfAMebibyte) {
  RecordProperty("sizeof_rig_identifier", static_cast<int>(sizeof(rig::Identifier)));
  EXPECT_LE(sizeof(rig::Identifier), 512U * 1024U);
}

}  // namespace
}  // namespace dampline
