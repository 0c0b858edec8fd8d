// SPDX-License-Identifier: MIT
#include "dampline/guard/block_survey.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <numbers>
#include <stdexcept>

namespace dampline {
namespace {

constexpr double kSurveyRateHz = 300.0;
constexpr double kBinHz = kSurveyRateHz / 512.0;
constexpr double kTurns = 2.0 * std::numbers::pi;
// One-sided density of a sum of 12 powers under Hann's window.
constexpr double kDensity = 2.0 / (kSurveyRateHz * 0.375 * 512.0 * 12.0);

std::complex<double> turned_by(double late_s, std::size_t k) {
  return std::polar(1.0, -kTurns * kBinHz * static_cast<double>(k) * late_s);
}

/// Wheelsets that share all they have, wheelset 2 later, and a frame that is later than their mean.
struct Ride {
  double late_s{0.0};        ///< wheelset 2
  double frame_late_s{0.0};  ///< behind both
  double gain{1.0};          ///< of wheelset 1
  double frame{0.1};
  int delay{0};  ///< samples by which wheelset 1 was delayed
};

SpectrumSums sums_of(const Ride& ride) {
  SpectrumSums sums;
  sums.segments = 12;
  sums.delay = ride.delay;
  sums.first_tick = 500;
  sums.last_tick = 3827;
  for (std::size_t k = 0; k < kSpectrumBins; ++k) {
    const double whole_s = ride.delay / kSurveyRateHz;
    sums.wheelset1[k] = sums.delayed1[k] = ride.gain * ride.gain;
    sums.wheelset2[k] = 1.0;
    sums.mean[k] = 1.0;
    sums.wheelsets[k] = ride.gain * turned_by(ride.late_s, k);
    sums.aligned[k] = ride.gain * turned_by(ride.late_s - whole_s, k);
    sums.frame[k] = ride.frame * ride.frame;
    for (auto& to : sums.frame_to) to[k] = ride.frame * turned_by(ride.frame_late_s, k);
  }
  return sums;
}

void survey_all(BlockSurvey& survey, const SpectrumSums& sums) {
  survey.start(sums);
  for (int calls = 0; survey.busy(); ++calls) {
    const bool done = survey.advance();
    EXPECT_EQ(done, !survey.busy());
    if (calls > 10'000) throw std::runtime_error{"never done"};
  }
}

BlockFigures survey_of(const SpectrumSums& sums, const AntiAliasConfig& filter = {}) {
  BlockSurvey survey{kSurveyRateHz, filter};
  survey_all(survey, sums);
  return survey.figures();
}

BlockFigures survey_of(const Ride& ride) { return survey_of(sums_of(ride)); }

TEST(BlockSurvey, SaysWhichBlockItWasOf) {
  const BlockFigures figures = survey_of(Ride{.delay = 7});
  EXPECT_EQ(figures.first_tick, 500);
  EXPECT_EQ(figures.last_tick, 3827);
  EXPECT_EQ(figures.delay, 7);
  BlockSurvey idle{kSurveyRateHz, {}};
  EXPECT_FALSE(idle.busy());
  EXPECT_FALSE(idle.advance());
}

TEST(BlockSurvey, MeasuresTheDelayBeyondWholeSamples) {
  for (const double late_s : {0.0, 0.0004, -0.0003}) {
    EXPECT_NEAR(survey_of(Ride{.late_s = late_s}).delay_s, late_s, 1e-12);
    const double whole_s = 24.0 / kSurveyRateHz;
    EXPECT_NEAR(survey_of(Ride{.late_s = whole_s + late_s, .delay = 24}).delay_s, whole_s + late_s,
                1e-12);
  }
}

TEST(BlockSurvey, FindsTheShiftAtWhichTheWheelsetsMatch) {
  for (const int samples : {0, 1, 24, -24, 91, -92, 92}) {
    const BlockFigures figures = survey_of(Ride{.late_s = samples / kSurveyRateHz});
    EXPECT_EQ(figures.match_delay, samples);
    EXPECT_NEAR(figures.match, 1.0, 1e-9);
  }
  SpectrumSums opposite = sums_of({.late_s = 10.0 / kSurveyRateHz});
  for (auto& cross : opposite.wheelsets) cross *= -0.5;
  EXPECT_EQ(survey_of(opposite).match_delay, 10);
  EXPECT_NEAR(survey_of(opposite).match, -0.5, 1e-9);
  EXPECT_LT(survey_of(Ride{.late_s = 97.0 / kSurveyRateHz}).match, 0.3) << "farther than it looks";
}

TEST(BlockSurvey, MeasuresTheGainOfWheelset1) {
  for (const double gain : {1.0, 1.05, 0.5})
    EXPECT_NEAR(survey_of(Ride{.gain = gain}).log_gain, std::log(gain), 1e-12);
}

TEST(BlockSurvey, MeasuresTheWheelsetsAndTheFrame) {
  const BlockFigures figures = survey_of(Ride{.gain = 2.0, .frame = 0.3});
  EXPECT_NEAR(figures.frame_power, 0.09 / 2.5, 1e-12);
  // 147 bins from 4 to 90 Hz, of powers 4 and 1.
  EXPECT_NEAR(figures.wheelset_mps2, std::sqrt(kDensity * kBinHz * 147.0 * 2.5), 1e-12);
}

TEST(BlockSurvey, CountsTheBinsThatAreCoherent) {
  SpectrumSums sums = sums_of({});
  for (std::size_t k = 7; k < 7 + 49; ++k) sums.aligned[k] = std::sqrt(0.39);
  for (std::size_t k = 100; k < 110; ++k) sums.aligned[k] = std::sqrt(0.41);
  EXPECT_NEAR(survey_of(sums).coherent_share, 98.0 / 147.0, 1e-12);
}

TEST(BlockSurvey, WithoutCoherenceThereIsNoDelay) {
  SpectrumSums sums = sums_of({});
  for (auto& cross : sums.aligned) cross = 0.0;
  EXPECT_EQ(survey_of(sums).delay_s, 0.0);
  EXPECT_EQ(survey_of(sums).coherent_share, 0.0);
}

TEST(BlockSurvey, ABinThatIsHardlyCoherentTellsTheDelay) {
  constexpr std::size_t kLowest = 7;  // 4.1 Hz
  SpectrumSums sums = sums_of({});
  for (auto& cross : sums.aligned) cross = 0.0;
  sums.aligned[kLowest] = 0.1 * turned_by(0.002, kLowest);
  EXPECT_NEAR(survey_of(sums).delay_s, 0.002, 1e-12);
}

// What a sensor without a signal, or wheelsets at rest, make is told in numbers.
TEST(BlockSurvey, OfADeadChannelAllFiguresAreNumbers) {
  for (std::size_t dead = 0; dead < 3; ++dead) {
    SpectrumSums sums = sums_of({.late_s = 0.0007});
    auto& power = dead == 0 ? sums.frame : dead == 1 ? sums.wheelset1 : sums.wheelset2;
    power.fill(0.0);
    if (dead == 1) sums.delayed1.fill(0.0);
    if (dead == 0) {
      for (auto& to : sums.frame_to) to.fill({});
    } else {
      sums.wheelsets.fill({});
      sums.aligned.fill({});
      sums.frame_to[dead - 1].fill({});
    }
    const BlockFigures figures = survey_of(sums, {.corner_hz = 100.0});
    for (const double figure :
         {figures.density,       figures.coherent_share,   figures.delay_s,      figures.log_gain,
          figures.frame_power,   figures.wheelset_mps2,    figures.follow[0],    figures.follow[1],
          figures.following,     figures.noise[0],         figures.noise[1],     figures.noise[2],
          figures.frame_in_band, figures.incoherent_share, figures.folded_share, figures.incoherent,
          figures.match,         figures.lag_s[0],         figures.lag_s[1],     figures.lag_s[2]})
      EXPECT_TRUE(std::isfinite(figure)) << dead;
    for (const double noise : figures.noise) EXPECT_GE(noise, 0.0) << dead;
    EXPECT_EQ(figures.coherent_share, dead == 0 ? 1.0 : 0.0);
    EXPECT_NEAR(std::abs(figures.match), dead == 0 ? 0.97 : 0.0, 0.02);
    EXPECT_FALSE(figures.has_lag) << "behind all three";
    EXPECT_EQ(figures.log_gain < -10.0, dead == 1);
    EXPECT_EQ(figures.log_gain > 10.0, dead == 2);
  }
  SpectrumSums still = sums_of({});
  for (auto* power : {&still.wheelset1, &still.wheelset2, &still.delayed1, &still.mean})
    power->fill(0.0);
  EXPECT_GT(survey_of(still).frame_power, 1e6);
}

TEST(BlockSurvey, ABinWeighsFiftyAtMost) {
  SpectrumSums sums = sums_of({});
  sums.aligned[50] = std::sqrt(0.9);
  BlockSurvey survey{kSurveyRateHz, {}};
  survey_all(survey, sums);
  EXPECT_NEAR(survey.weights()[50], 9.0, 1e-9);
  EXPECT_EQ(survey.weights()[51], 50.0);
}

// The frame's real part behind each wheelset, 1.1 to 1.6 Hz: one bin at this rate.
TEST(BlockSurvey, TellsWhichWheelsetTheFrameFollows) {
  SpectrumSums sums = sums_of({});
  sums.frame_to[0][2] = {0.3, 5.0};
  sums.frame_to[1][2] = {-0.1, 5.0};
  sums.mean[2] = 0.5;
  const BlockFigures figures = survey_of(sums);
  EXPECT_EQ(figures.follow[0], 0.3);
  EXPECT_EQ(figures.follow[1], -0.1);
  EXPECT_NEAR(figures.following, 0.2, 1e-12);
}

/// What a figure becomes where one bin has more of everything.
bool counts(std::size_t bin, double BlockFigures::*figure) {
  SpectrumSums sums = sums_of({});
  sums.frame[bin] *= 1e6;
  sums.wheelset1[bin] *= 1e3;
  sums.delayed1[bin] *= 1e3;
  return std::abs(survey_of(sums).*figure - survey_of(Ride{}).*figure) > 1e-12;
}

TEST(BlockSurvey, LooksAtItsBandsToTheBin) {
  for (const auto& [bin, inside] :
       {std::pair{6U, false}, std::pair{7U, true}, std::pair{153U, true}, std::pair{154U, false}})
    EXPECT_EQ(counts(bin, &BlockFigures::wheelset_mps2), inside) << bin << ", 4 to 90 Hz";
  for (const auto& [bin, inside] :
       {std::pair{68U, false}, std::pair{69U, true}, std::pair{170U, true}, std::pair{171U, false}})
    EXPECT_EQ(counts(bin, &BlockFigures::frame_power), inside) << bin << ", 40 to 99.9 Hz";
  for (const auto& [bin, inside] :
       {std::pair{76U, false}, std::pair{77U, true}, std::pair{144U, true}, std::pair{145U, false}})
    EXPECT_EQ(counts(bin, &BlockFigures::incoherent_share), inside) << bin << ", 45 to 84.9 Hz";
}

double squared_shape(double hz, const AntiAliasConfig& filter) {
  if (filter.corner_hz <= 0.0) return 1.0 / (hz * hz);
  return 1.0 / ((1.0 + std::pow(hz / filter.corner_hz, 2.0 * filter.order)) * hz * hz);
}

// What friction leaves falls as 1 / f behind the sensors' filter, and is folded at half the rate.
TEST(BlockSurvey, TheFramesNoiseIsItsWhitePart) {
  for (const AntiAliasConfig filter : {AntiAliasConfig{}, AntiAliasConfig{.corner_hz = 0.0},
                                       AntiAliasConfig{.corner_hz = 80.0, .order = 2}}) {
    SpectrumSums sums = sums_of({});
    for (std::size_t k = 1; k < kSpectrumBins; ++k) {
      const double hz = kBinHz * static_cast<double>(k);
      sums.frame[k] =
          0.01 + 3e3 * (squared_shape(hz, filter) + squared_shape(kSurveyRateHz - hz, filter));
    }
    for (std::size_t k = 1; k < 171; ++k) sums.frame[k] += 7.0;    // below 0.333 of the rate,
    for (std::size_t k = 251; k < 256; ++k) sums.frame[k] += 7.0;  // and above 0.49
    EXPECT_NEAR(survey_of(sums, filter).noise[0] / (kDensity * 0.01), 1.0, 1e-6);
  }
  SpectrumSums steep = sums_of({});
  for (std::size_t k = 1; k < kSpectrumBins; ++k)
    steep.frame[k] = std::pow(256.0 - static_cast<double>(k), 4);
  EXPECT_EQ(survey_of(steep).noise[0], 0.0) << "no less than none";
}

// White noise of a wheelset is no more than what it has at the end of the band.
TEST(BlockSurvey, TheWheelsetsNoiseIsBoundByTheEndOfTheBand) {
  const auto with_edge = [](double edge) {
    SpectrumSums sums = sums_of({});
    for (std::size_t k = 188; k <= 215; ++k) {  // 110 to 126 Hz
      sums.aligned[k] = 0.5;
      sums.delayed1[k] = sums.wheelset1[k] = 1.0;
    }
    for (std::size_t k = 236; k <= 250; ++k) sums.wheelset1[k] = sums.wheelset2[k] = edge;
    return survey_of(sums);
  };
  EXPECT_NEAR(with_edge(9.0).noise[1], kDensity * 0.5, 1e-9 * kDensity);
  EXPECT_NEAR(with_edge(9.0).noise[2], kDensity * 0.5, 1e-9 * kDensity);
  EXPECT_NEAR(with_edge(0.02).noise[1], kDensity * 0.02, 1e-9 * kDensity);
  EXPECT_NEAR(with_edge(0.02).noise[2], kDensity * 0.02, 1e-9 * kDensity);
}

// Each wheelset's own is what it has beyond what both share, which their gains divide.
TEST(BlockSurvey, NoiseIsThatWheelsetsWhichHasIt) {
  constexpr double kNoise = 0.02;
  constexpr std::size_t kFrom = 180;  // above what both share in any case
  for (const double gain : {0.5, 1.0, 2.0})
    for (const std::size_t noisy : {0U, 1U}) {
      SpectrumSums sums = sums_of({.gain = gain});
      for (std::size_t k = kFrom; k < kSpectrumBins; ++k) {
        if (noisy == 1) sums.wheelset2[k] += kNoise;
        if (noisy == 0) sums.delayed1[k] = sums.wheelset1[k] += kNoise;
      }
      const BlockFigures figures = survey_of(sums);
      const double own = figures.noise[1 + noisy];
      const double other = figures.noise[2 - noisy];
      EXPECT_GT(own, 10.0 * other) << gain << ' ' << noisy;
      EXPECT_GT(own, 0.2 * kNoise * kDensity) << gain << ' ' << noisy;
    }
}

TEST(BlockSurvey, WhatWheelsDoNotShareIsADensity) {
  SpectrumSums sums = sums_of({});
  for (auto& cross : sums.aligned) cross = 0.7;
  const BlockFigures figures = survey_of(sums);
  EXPECT_NEAR(figures.incoherent_share, 0.3, 1e-12);
  EXPECT_NEAR(figures.incoherent, 0.3 * kDensity, 1e-9 * kDensity);
}

// Sensors of another sensitivity, all alike: shares and delays stay, powers grow with its square.
TEST(BlockSurvey, SharesDoNotDependOnTheUnit) {
  for (const double unit : {1.0, 0.3, 30.0}) {
    SpectrumSums sums = sums_of({.late_s = 0.0007, .gain = 1.2, .frame = 0.4});
    for (std::size_t k = 0; k < kSpectrumBins; ++k) {
      const double differ = k >= 180 ? 0.5 : 0.8;
      sums.aligned[k] *= differ;
      sums.frame[k] += 30.0 / (1.0 + static_cast<double>(k * k));
      for (auto* real : {&sums.frame, &sums.wheelset1, &sums.wheelset2, &sums.delayed1, &sums.mean})
        (*real)[k] *= unit * unit;
      for (auto* cross : {&sums.wheelsets, &sums.aligned, sums.frame_to.data(), &sums.frame_to[1]})
        (*cross)[k] *= unit * unit;
    }
    const BlockFigures figures = survey_of(sums);
    EXPECT_NEAR(figures.coherent_share, 1.0, 1e-12);
    // The mean of cos(2 pi f 0.7 ms) over 4 to 90 Hz.
    EXPECT_NEAR(figures.match, 0.9728, 0.002);
    EXPECT_NEAR(figures.delay_s, 0.0007, 1e-9);
    EXPECT_NEAR(figures.log_gain, std::log(1.2), 1e-9);
    EXPECT_NEAR(figures.incoherent_share, 0.2, 1e-9);
    EXPECT_NEAR(figures.wheelset_mps2 / unit, std::sqrt(kDensity * kBinHz * 147.0 * 1.22), 1e-9);
    // What is not shared at 110 to 126 Hz, less the 0.2 elsewhere: 2 * 0.3 of the mean power.
    EXPECT_NEAR((figures.noise[1] + figures.noise[2]) / (unit * unit * kDensity), 2.0 * 0.3 * 1.2,
                0.01);
    EXPECT_NEAR(figures.incoherent / (unit * unit * kDensity), 0.2 * 1.2, 1e-6);
  }
}

TEST(BlockSurvey, MeasuresTheFramesLagAgainstTheBlocksBefore) {
  BlockSurvey survey{kSurveyRateHz, {}};
  survey_all(survey, sums_of({.frame_late_s = 0.003}));
  EXPECT_TRUE(survey.figures().has_lag);
  for (const double lag_s : survey.figures().lag_s) EXPECT_EQ(lag_s, 0.0) << "the first block";
  for (const double late_s : {0.0004, -0.0007, 0.004, 0.0085}) {
    survey_all(survey, sums_of({.frame_late_s = 0.003 + late_s}));
    for (const double lag_s : survey.figures().lag_s) EXPECT_NEAR(lag_s, late_s, 1e-9) << late_s;
  }
  survey.forget_lag();
  survey_all(survey, sums_of({.frame_late_s = 0.0}));
  for (const double lag_s : survey.figures().lag_s) EXPECT_EQ(lag_s, 0.0) << "anew";
}

// Behind the mean, wheelset 1 and wheelset 2, each by its own.
TEST(BlockSurvey, TellsTheLagsBehindEitherWheelset) {
  BlockSurvey survey{kSurveyRateHz, {}};
  survey_all(survey, sums_of({}));
  SpectrumSums sums = sums_of({});
  for (std::size_t k = 0; k < kSpectrumBins; ++k) {
    sums.frame_to[0][k] *= turned_by(0.0012, k);
    sums.frame_to[1][k] *= turned_by(-0.0004, k);
  }
  survey_all(survey, sums);
  EXPECT_NEAR(survey.figures().lag_s[0], 0.0004, 2e-5);
  EXPECT_NEAR(survey.figures().lag_s[1], 0.0012, 1e-9);
  EXPECT_NEAR(survey.figures().lag_s[2], -0.0004, 1e-9);
}

TEST(BlockSurvey, TheLagMovesByTwoSamplesABlock) {
  BlockSurvey survey{kSurveyRateHz, {}};
  survey_all(survey, sums_of({}));
  survey_all(survey, sums_of({.frame_late_s = 2.3 / kSurveyRateHz}));
  EXPECT_NEAR(survey.figures().lag_s[0], 2.3 / kSurveyRateHz, 1e-9);
  survey_all(survey, sums_of({.frame_late_s = 8.0 / kSurveyRateHz}));
  EXPECT_LT(survey.figures().lag_s[0], 5.5 / kSurveyRateHz);
}

// Mean coherence of frame and wheelsets from 15 to 95 Hz: a twelfth is needed.
TEST(BlockSurvey, HasALagWhereTheFrameIsCoherent) {
  for (const auto& [coherence, has_lag] : {std::pair{0.085, true}, std::pair{0.075, false}}) {
    SpectrumSums sums = sums_of({});
    for (auto& to : sums.frame_to)
      for (auto& cross : to) cross *= std::sqrt(coherence);
    EXPECT_EQ(survey_of(sums).has_lag, has_lag);
    SpectrumSums one = sums_of({});
    for (auto& cross : one.frame_to[1]) cross *= std::sqrt(coherence);
    EXPECT_EQ(survey_of(one).has_lag, has_lag) << "of all three";
  }
  SpectrumSums outside = sums_of({});
  for (std::size_t k = 26; k <= 162; ++k)
    for (auto& to : outside.frame_to) to[k] = 0.0;
  EXPECT_FALSE(survey_of(outside).has_lag);
  for (const std::size_t edge : {26U, 162U}) {
    SpectrumSums one = outside;
    for (auto& to : one.frame_to) to[edge] = 100.0;
    EXPECT_TRUE(survey_of(one).has_lag) << edge;
  }
}

// A block adds to the reference, which keeps 0.95 of itself.
TEST(BlockSurvey, ABlockThatDiffersCountsATwentieth) {
  BlockSurvey survey{kSurveyRateHz, {}};
  for (int i = 0; i < 200; ++i) survey_all(survey, sums_of({}));
  EXPECT_NEAR(survey.figures().lag_s[0], 0.0, 1e-12);
  SpectrumSums strong = sums_of({.frame_late_s = 0.001});
  for (int i = 0; i < 200; ++i) survey_all(survey, strong);
  EXPECT_NEAR(survey.figures().lag_s[0], 0.001, 1e-9) << "its own lag is taken out";
}

TEST(WhiteAndFolded, TellsAConstantFromAShape) {
  for (const double white : {0.0, 0.3, 2.0}) {
    WhiteAndFolded fit;
    for (int k = 1; k <= 40; ++k) fit.add(1.0 / k, k * k, white + 0.07 * k * k);
    EXPECT_NEAR(fit.white(), white, 1e-9);
  }
  WhiteAndFolded below;
  for (int k = 1; k <= 40; ++k) below.add(1.0, k, k - 0.5);
  EXPECT_EQ(below.white(), 0.0) << "no less than none";
  WhiteAndFolded two;
  two.add(3.0, 1.0, 5.0);
  two.add(1.0, 1.0, 1.0);
  EXPECT_NEAR(two.mean(), 4.0, 1e-12);
  EXPECT_EQ(two.white(), 0.0) << "one shape alone tells nothing apart";
}

// Of a motion that falls as 1 / f^2 in acceleration, 4 % of what stands at the folded frequency is
// not shared; of white noise nothing is taken for that.
TEST(BlockSurvey, TellsWhatIsFoldedFromNoise) {
  const AntiAliasConfig filter{.corner_hz = 100.0};
  for (const double noise : {0.002, 0.02}) {
    for (const auto& [folded, unit] :
         {std::pair{0.0, 1.0}, std::pair{1.0, 1.0}, std::pair{0.0, 1e-4}, std::pair{1.0, 1e4}}) {
      SpectrumSums sums = sums_of({});
      for (std::size_t k = 146; k < kSpectrumBins; ++k) {
        const double from_hz = kSurveyRateHz - kBinHz * static_cast<double>(k);
        const double passed = 1.0 / (1.0 + std::pow(from_hz / 100.0, 8));
        const double apart = noise + folded * passed * std::pow(150.0 / from_hz, 4);
        sums.aligned[k] = 1.0 - apart;
      }
      for (auto* power : {&sums.wheelset1, &sums.wheelset2, &sums.delayed1})
        for (double& bin : *power) bin *= unit;
      for (auto* cross : {&sums.wheelsets, &sums.aligned})
        for (auto& bin : *cross) bin *= unit;
      const BlockFigures figures = survey_of(sums, filter);
      const double both = (figures.noise[1] + figures.noise[2]) / unit;
      EXPECT_NEAR((1.0 - figures.folded_share) * both, 2.0 * noise * kDensity,
                  0.02 * noise * kDensity)
          << noise << ' ' << folded;
      EXPECT_EQ(figures.folded_share > 0.05, folded > 0.0);
      EXPECT_EQ(survey_of(sums, {.corner_hz = 100.0, .thinned = true}).folded_share, 0.0);
      EXPECT_EQ(survey_of(sums, {.corner_hz = 0.0}).folded_share, 0.0);
      EXPECT_EQ(survey_of(sums, {.corner_hz = 140.0}).folded_share, 0.0);
    }
  }
}

}  // namespace
}  // namespace dampline
