// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <utility>

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

TEST(RigConfig, HasItsLimits) {
  const auto ok = [](auto change) {
    rig::Config config;
    change(config);
    return check(config).ok();
  };
  // 0.477 times the rate over the corner, less one and three more.
  for (const auto& [corner_hz, half] :
       {std::pair{159.0, 5}, std::pair{20.0, 26}, std::pair{0.9353, 512}}) {
    EXPECT_EQ(rig::half_support_samples(corner_hz, 1000.0), half);
    EXPECT_TRUE(ok([c = corner_hz](rig::Config& config) { config.corner_hz = c; })) << corner_hz;
    EXPECT_TRUE(ok([c = corner_hz](rig::Config& config) { config.prediction_corner_hz = c; }));
  }
  for (const double corner_hz : {200.0, 0.92}) {
    EXPECT_FALSE(ok([=](rig::Config& config) { config.corner_hz = corner_hz; })) << corner_hz;
    EXPECT_FALSE(ok([=](rig::Config& config) { config.prediction_corner_hz = corner_hz; }));
  }
  for (const auto& [half_width, fits] :
       {std::pair{0, false}, std::pair{1, true}, std::pair{32, true}, std::pair{33, false}})
    EXPECT_EQ(ok([h = half_width](rig::Config& c) { c.velocity_half_width = h; }), fits);
  EXPECT_TRUE(ok([](rig::Config& c) { c.still_mps = 0.0; }));
  EXPECT_FALSE(ok([](rig::Config& c) { c.still_mps = -1e-9; }));
  EXPECT_TRUE(ok([](rig::Config& c) { c.block_samples = 1; }));
  EXPECT_FALSE(ok([](rig::Config& c) { c.curve_nodes_mps[0] = 0.0; }));
  EXPECT_FALSE(
      ok([](rig::Config& c) { c.curve_nodes_mps[7] = std::numeric_limits<double>::infinity(); }));
  for (const auto branches : {rig::Branches::kNone, rig::Branches::kCommon})
    EXPECT_TRUE(check(rig::Terms{.coulomb = branches, .offset = true}).ok());
}

/// A sine of 10 mm with white noise, or rounded.
struct SineMotion {
  double hz{1.5};
  double noise_m{0.0};
  double step_m{0.0};
  int samples{20000};
  bool velocity_measured{false};
  double rate_hz{1000.0};
  [[nodiscard]] double speed_mps() const { return 0.01 * 6.283185307179586 * hz; }
};
rig::Survey survey_of(const SineMotion& motion) {
  rig::Survey survey{motion.rate_hz, motion.velocity_measured};
  std::mt19937_64 random{3};
  std::normal_distribution<double> noise;
  for (std::int64_t tick = 0; tick < motion.samples; ++tick) {
    rig::Sample sample;
    sample.tick = tick;
    const double angle = 6.283185307179586 * motion.hz * static_cast<double>(tick) / motion.rate_hz;
    sample.deflection_m = 0.01 * std::sin(angle) + motion.noise_m * noise(random);
    if (motion.step_m > 0.0)
      sample.deflection_m = motion.step_m * std::round(sample.deflection_m / motion.step_m);
    if (motion.velocity_measured)
      sample.velocity_mps = motion.speed_mps() * std::cos(angle) + 1e-3 * noise(random);
    survey.update(sample);
  }
  return survey;
}

// What the header says of each setting.
TEST(RigSurvey, SuggestsNodesStandstillAndBlocksByTheMotion) {
  const SineMotion motion{.noise_m = 1e-7};
  const rig::Config out = survey_of(motion).suggest({}).value();
  EXPECT_EQ(out.sample_rate_hz, 1000.0);
  EXPECT_FALSE(out.velocity_measured);
  const double top = std::sin(0.5 * 3.141592653589793 * 0.99) * motion.speed_mps();
  for (std::size_t i = 0; i < kCurveSegments; ++i)
    EXPECT_NEAR(out.curve_nodes_mps[i] / (top * static_cast<double>(i + 1) / 8.0), 1.0, 0.03);
  const double rms = motion.speed_mps() / std::sqrt(2.0);
  EXPECT_NEAR(out.still_mps / (0.01 * rms), 1.0, 0.1) << "a hundredth of it";
  EXPECT_EQ(out.block_samples, 250) << "eighty of them";
  EXPECT_NEAR(out.corner_hz, 20.0, 1e-9) << "a fiftieth of the rate";
  EXPECT_FALSE(out.velocity_sharp);
  EXPECT_EQ(survey_of({.noise_m = 1e-7, .samples = 2000}).suggest({}).value().block_samples, 106)
      << "two test functions of 53";
}

TEST(RigSurvey, SuggestsACornerAboveTheMotion) {
  EXPECT_NEAR(survey_of({.hz = 12.0}).suggest({}).value().corner_hz, 48.0, 1.5);
  EXPECT_NEAR(survey_of({.hz = 60.0}).suggest({}).value().corner_hz, 1000.0 / 6.5, 1e-6)
      << "two thirteenths of the rate at most";
  EXPECT_EQ(survey_of({.hz = 12.0}).suggest({}, 30.0).value().corner_hz, 30.0);
  EXPECT_EQ(survey_of({}).suggest({}, 400.0).error(), Errc::kInvalidConfig);
}

// Of a driven mass, lower by half octaves until noise makes less than a thousandth of <x, psi''>.
TEST(RigSurvey, SuggestsALowerCornerWhereAMassIsDrivenInNoise) {
  const rig::Terms driven{.inertia = true};
  EXPECT_NEAR(survey_of({.noise_m = 1e-9}).suggest(driven).value().corner_hz, 20.0, 1e-9);
  for (const double noise_m : {2e-5, 1e-4}) {
    const SineMotion motion{.noise_m = noise_m};
    const double corner_hz = survey_of(motion).suggest(driven).value().corner_hz;
    const double octaves = 2.0 * std::log2(20.0 / corner_hz);
    EXPECT_GE(octaves, 0.9);
    const double w = 6.283185307179586 * motion.hz;
    const auto share = [&](double hz) {
      const rig::TestFunction psi{rig::half_support_samples(hz, 1000.0), 1e-3};
      return std::pow(psi.second_noise_gain() * noise_m / (0.01 * w * w / std::sqrt(2.0)), 2);
    };
    if (corner_hz > 6.1) {
      EXPECT_NEAR(octaves, std::round(octaves), 1e-6);
      EXPECT_LT(share(corner_hz), 1.2e-3);
    } else {
      EXPECT_NEAR(corner_hz, 6.0, 0.3) << "four times the motion's frequency at least";
    }
    EXPECT_GT(share(corner_hz * std::sqrt(2.0)), 0.8e-3);
  }
}

// A derivative as short as noise of a hundredth of the velocity permits.
TEST(RigSurvey, SuggestsAWiderDerivativeInNoise) {
  int last = 0;
  for (const double noise_m : {1e-7, 3e-6, 1e-5, 3e-5}) {
    const SineMotion motion{.noise_m = noise_m};
    const rig::Config out = survey_of(motion).suggest({}).value();
    const int widest = rig::half_support_samples(out) / 4;
    const double limit = 0.01 * motion.speed_mps() / std::sqrt(2.0);
    const auto error = [&](int half_width) {
      return rig::DerivativeWindow{half_width, 1e-3}.noise_gain() * noise_m;
    };
    if (out.velocity_half_width < widest) {
      EXPECT_LT(error(out.velocity_half_width), 1.05 * limit);
    }
    if (out.velocity_half_width > 1) {
      EXPECT_GT(error(out.velocity_half_width - 1), 0.95 * limit);
    }
    EXPECT_LE(out.velocity_half_width, widest);
    EXPECT_GE(out.velocity_half_width, last);
    last = out.velocity_half_width;
    const double sign = std::max(1.2533 * error(out.velocity_half_width), 1e-2 * limit);
    EXPECT_NEAR(out.sign_width_mps / sign, 1.0, 0.1);
    EXPECT_NEAR(out.still_mps / std::max(3.0 * error(out.velocity_half_width), limit), 1.0, 0.1);
  }
  EXPECT_EQ(last, 6) << "a quarter of 26";
}

TEST(RigSurvey, TakesTheVelocityThatIsMeasured) {
  const SineMotion motion{.velocity_measured = true};
  const rig::Config out = survey_of(motion).suggest({}).value();
  EXPECT_TRUE(out.velocity_measured);
  EXPECT_FALSE(out.velocity_sharp);
  EXPECT_NEAR(out.sign_width_mps, 1.2533e-3, 0.1e-3);
  EXPECT_NEAR(out.still_mps, 3e-3, 0.3e-3);
}

// Rounding to steps of d makes noise of d / sqrt(12), which differences of slow motion may miss.
TEST(RigSurvey, KnowsTheResolution) {
  EXPECT_NEAR(survey_of({.hz = 0.05, .step_m = 1e-4}).deflection_noise_m(), 1e-4 / std::sqrt(12.0),
              0.2e-4);
}

TEST(RigSurvey, LeavesOutWhatIsNoNumberAndJoinsNoGap) {
  rig::Survey survey{1000.0, false};
  for (std::int64_t i = 0; i < 30'000; ++i) {
    rig::Sample sample;
    sample.tick = i + 500 * (i / 100);
    // After each gap on another level, which is no velocity.
    sample.deflection_m = 0.01 * std::sin(0.00942477796 * static_cast<double>(sample.tick));
    if (i % 1000 == 500) sample.force_n = std::nan("");
    survey.update(sample);
  }
  EXPECT_EQ(survey.samples(), 29'970U);
  EXPECT_NEAR(survey.motion_frequency_hz(), 1.5, 0.05);
  EXPECT_LT(survey.deflection_noise_m(), 1e-7);
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
  const rig::Config out = survey.suggest({}).value();
  EXPECT_TRUE(out.velocity_sharp);
  EXPECT_EQ(out.velocity_half_width, rig::DerivativeWindow::sharp(1e-3).half_width());
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
  for (sample.tick = 2000; sample.tick < 4000; sample.tick += 2) {
    sample.deflection_m = 0.01 * std::sin(0.01 * static_cast<double>(sample.tick));
    survey.update(sample);
  }
  EXPECT_EQ(survey.suggest({}).error(), Errc::kNotReady) << "no two samples follow each other";
}

TEST(RigIdentifier, FitsInHalfAMebibyte) {
  RecordProperty("sizeof_rig_identifier", static_cast<int>(sizeof(rig::Identifier)));
  EXPECT_LE(sizeof(rig::Identifier), 512U * 1024U);
}

}  // namespace
}  // namespace dampline
