// SPDX-License-Identifier: MIT
#include "dampline/guard/place_watch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <tuple>

namespace dampline {
namespace {

using Complex = std::complex<double>;
constexpr double kPlaceRateHz = 300.0;
constexpr double kPlaceBinHz = kPlaceRateHz / 512.0;

constexpr double kBehindS = 0.081;
constexpr double kShared = 0.9;  // of their amplitude

/// Blocks whose wheelsets are white, wheelset 2 behind; the frame is made of them.
class SeenBlocks {
 public:
  using Frame = std::function<Complex(double hz, Complex mean, Complex half_difference)>;
  Frame frame = [](double, Complex mean, Complex) { return 1.2 * mean; };
  std::function<double(double hz)> gain1 = [](double) { return 1.0; };
  std::function<double(double hz)> gain2 = gain1;
  double foreign = 0.0;      ///< rms in the frame, of the mean's
  double noise_share = 0.0;  ///< of that, declared as noise

  void add(int blocks) {
    for (int i = 0; i < blocks; ++i) add();
  }
  [[nodiscard]] Misplacement figures() const { return watch_.misplacement(); }
  [[nodiscard]] const FaultLog& log() const { return log_; }

 private:
  void add() {
    const auto sums = std::make_unique<SpectrumSums>();
    const auto draw = [this] { return Complex{normal_(random_), normal_(random_)}; };
    for (sums->segments = 0; sums->segments < 12; ++sums->segments) {
      for (std::size_t k = 1; k < kSpectrumBins; ++k) {
        const double hz = static_cast<double>(k) * kPlaceBinHz;
        const Complex one = draw();
        const Complex behind = one * std::polar(1.0, -2.0 * std::numbers::pi * hz * kBehindS);
        const Complex alike = kShared * behind + std::sqrt(1.0 - kShared * kShared) * draw();
        const Complex two = gain2(hz) * alike;
        const Complex first = gain1(hz) * one;
        const Complex mean = 0.5 * (first + two);
        const Complex seen = frame(hz, mean, 0.5 * (first - two)) + foreign * draw();
        sums->frame[k] += std::norm(seen);
        sums->wheelset1[k] += std::norm(first);
        sums->wheelset2[k] += std::norm(two);
        sums->delayed1[k] += std::norm(first);
        sums->mean[k] += std::norm(mean);
        sums->wheelsets[k] += std::conj(first) * two;
        sums->frame_to[0][k] += std::conj(first) * seen;
        sums->frame_to[1][k] += std::conj(two) * seen;
      }
    }
    BlockFigures block;
    block.density = 1e-3;
    block.noise[0] = noise_share * foreign * foreign * 2.0 * 12.0 * block.density;
    watch_.start(*sums, block);
    while (!watch_.advance(log_)) {
    }
  }

  std::mt19937_64 random_{17};
  std::normal_distribution<double> normal_;
  FaultLog log_{kPlaceRateHz};
  PlaceWatch watch_{kPlaceRateHz};
};

TEST(PlaceWatch, KnowsNothingBeforeSixBlocks) {
  SeenBlocks blocks;
  blocks.foreign = 0.5;
  blocks.add(5);
  EXPECT_EQ(blocks.figures().foreign_share, 0.0);
  blocks.add(1);
  EXPECT_GT(blocks.figures().foreign_share, 0.0);
}

TEST(PlaceWatch, WorksABlockOffInSixteenCalls) {
  const auto sums = std::make_unique<SpectrumSums>();
  FaultLog log{kPlaceRateHz};
  PlaceWatch watch{kPlaceRateHz};
  watch.start(*sums, {});
  for (int call = 1; call < 16; ++call) EXPECT_FALSE(watch.advance(log)) << call;
  EXPECT_TRUE(watch.advance(log));
}

TEST(PlaceWatch, SeesNothingWhereTheFrameFollowsTheMean) {
  SeenBlocks blocks;
  blocks.add(10);
  EXPECT_NEAR(blocks.figures().foreign_share, 0.0, 1e-9);
  EXPECT_NEAR(blocks.figures().difference, 0.0, 1e-9);
  EXPECT_TRUE(blocks.log().faults().empty());
}

/// Power of the frame: 1.44 of the mean's and the foreign one's.
TEST(PlaceWatch, MeasuresTheForeignShare) {
  SeenBlocks blocks;
  blocks.foreign = 0.3;
  blocks.add(40);
  const double turn = 2.0 * std::numbers::pi * 2.0 * kPlaceBinHz * kBehindS;
  const double mean = 0.5 * (1.0 + kShared * std::cos(turn));
  const double share = 0.09 / (0.09 + 1.44 * mean);
  EXPECT_NEAR(blocks.figures().foreign_share, share, 0.1 * share);
}

TEST(PlaceWatch, TakesOneAndAHalfTimesTheNoiseOff) {
  SeenBlocks blocks;
  blocks.foreign = 0.3;
  blocks.noise_share = 0.75;
  blocks.add(40);
  EXPECT_LT(blocks.figures().foreign_share, 0.03);
}

TEST(PlaceWatch, MeasuresHowMuchOfTheDifferenceTheFrameShows) {
  SeenBlocks blocks;
  blocks.foreign = 0.1;
  blocks.frame = [](double, Complex mean, Complex half_difference) {
    return 0.8 * mean + Complex{0.15, -0.08} * half_difference;
  };
  blocks.add(20);
  EXPECT_NEAR(blocks.figures().difference, 0.17, 0.01);
  EXPECT_GT(blocks.figures().difference_share, 0.3);
  EXPECT_LT(blocks.figures().difference_share, 1.0);
}

TEST(PlaceWatch, MeasuresTheGainOfWheelsetOne) {
  SeenBlocks blocks;
  blocks.gain1 = [](double) { return 1.07; };
  blocks.add(40);
  EXPECT_NEAR(blocks.figures().gain, 0.07, 0.01);
}

// At low rates the band of pitch has more bins than are kept: the lower sixteen, 3.5 to 6.4 Hz at
// 100 samples a second.
TEST(PlaceWatch, LooksAtTheLowestSixteenBinsOfABand) {
  for (const auto& [bin, inside] :
       {std::pair{17U, false}, std::pair{18U, true}, std::pair{33U, true}, std::pair{34U, false}}) {
    const auto sums = std::make_unique<SpectrumSums>();
    for (std::size_t k = 1; k < kSpectrumBins; ++k)
      sums->wheelset1[k] = sums->wheelset2[k] = sums->mean[k] = 1.0;
    sums->wheelset1[bin] = 49.0;
    FaultLog log{100.0};
    PlaceWatch watch{100.0};
    for (int block = 0; block < 6; ++block) {
      watch.start(*sums, {.density = 1.0});
      while (!watch.advance(log)) {
      }
    }
    EXPECT_NEAR(watch.misplacement().gain, inside ? 1.0 : 0.0, 1e-12) << bin;
  }
}

double ringing_gain(double hz, double resonance_hz) {
  const double r = hz / resonance_hz;
  return 1.0 / std::hypot(1.0 - r * r, 2.0 * 0.03 * r);
}

TEST(PlaceWatch, NamesAMountThatRingsAfterThreeBlocks) {
  for (const double at_hz : {35.0, 70.0, 90.0}) {
    SeenBlocks blocks;
    blocks.frame = [at_hz](double hz, Complex mean, Complex) {
      return ringing_gain(hz, at_hz) * mean;
    };
    blocks.gain1 = [](double) { return 1.02; };
    blocks.add(2);
    EXPECT_TRUE(blocks.log().faults().empty());
    blocks.add(2);
    const Fault* const fault = blocks.log().find(FaultKind::kRingingMount, FaultChannel::kFrame);
    ASSERT_NE(fault, nullptr) << at_hz;
    EXPECT_NEAR(fault->size, at_hz, 3.0);
    EXPECT_EQ(blocks.log().faults().size(), 1U);
  }
}

TEST(PlaceWatch, TellsWhichWheelsetsMountRings) {
  for (const bool first : {true, false}) {
    SeenBlocks blocks;
    (first ? blocks.gain1 : blocks.gain2) = [](double hz) { return ringing_gain(hz, 60.0); };
    blocks.frame = [](double, Complex, Complex) { return Complex{}; };
    blocks.add(3);
    const FaultChannel channel = first ? FaultChannel::kWheelset1 : FaultChannel::kWheelset2;
    const Fault* const fault = blocks.log().find(FaultKind::kRingingMount, channel);
    ASSERT_NE(fault, nullptr) << first;
    EXPECT_NEAR(fault->size, 60.0, 3.0);
  }
}

TEST(PlaceWatch, TakesAGapInTheWheelsetsSpectrumForNoMount) {
  SeenBlocks blocks;
  blocks.gain1 = blocks.gain2 = [](double hz) { return 1.0 / ringing_gain(hz, 60.0); };
  blocks.frame = [](double hz, Complex mean, Complex) { return ringing_gain(hz, 60.0) * mean; };
  blocks.add(6);
  EXPECT_TRUE(blocks.log().faults().empty());
}

/// Friction that turns at every half period of a motion makes lines at its odd multiples.
TEST(PlaceWatch, TakesLinesForNoMount) {
  SeenBlocks blocks;
  blocks.frame = [](double hz, Complex mean, Complex) {
    const double off = std::fmod(hz + 3.6, 7.2) - 3.6;
    return (0.2 + 3.0 * std::exp(-off * off)) * mean;
  };
  blocks.add(10);
  EXPECT_TRUE(blocks.log().faults().empty());
}

/// Three segments whose half sum m and half difference d are 1 and c, 0 and 1, and nothing; the
/// frame makes H_m m + H_d d of them and e in the third.
struct Segments {
  Complex shared{0.4, -0.3};  ///< c
  Complex mean_gain{1.2, 0.1};
  Complex difference_gain{0.15, -0.08};
  Complex foreign{0.06, 0.02};
  double unit{1.0};  ///< of all sensors

  [[nodiscard]] std::unique_ptr<SpectrumSums> sums() const {
    auto out = std::make_unique<SpectrumSums>();
    for (const auto& [m, d, e] : {std::tuple{Complex{1.0}, shared, Complex{}},
                                  std::tuple{Complex{}, Complex{1.0}, Complex{}},
                                  std::tuple{Complex{}, Complex{}, foreign}}) {
      const Complex first = unit * (m + d);
      const Complex second = unit * (m - d);
      const Complex frame = unit * (mean_gain * m + difference_gain * d + e);
      for (std::size_t k = 1; k < kSpectrumBins; ++k) {
        out->frame[k] += std::norm(frame);
        out->wheelset1[k] += std::norm(first);
        out->wheelset2[k] += std::norm(second);
        out->delayed1[k] += std::norm(first);
        out->mean[k] += std::norm(unit * m);
        out->wheelsets[k] += std::conj(first) * second;
        out->frame_to[0][k] += std::conj(first) * frame;
        out->frame_to[1][k] += std::conj(second) * frame;
      }
    }
    return out;
  }
};

// By least squares in every bin: what m explains, what d explains beyond it, and what neither does.
TEST(PlaceWatch, TellsTheShareOfMeanDifferenceAndWhatIsForeign) {
  for (const double unit : {1.0, 1e-3, 50.0}) {
    for (const double noise : {0.0, 0.004}) {
      const Segments segments{.unit = unit};
      const auto sums = segments.sums();
      BlockFigures block;
      block.density = 2e-3;
      const double power = block.density * unit * unit;
      // Three parts of white noise; the frame shows 1.4 times a quarter of each wheelset's.
      block.noise = {power * noise, power * noise, power * noise};
      FaultLog log{kPlaceRateHz};
      PlaceWatch watch{kPlaceRateHz};
      for (int i = 0; i < 8; ++i) {
        watch.start(*sums, block);
        while (!watch.advance(log)) {
        }
      }
      const Misplacement found = watch.misplacement();
      const double by_difference = std::norm(segments.difference_gain);
      const double left = by_difference + std::norm(segments.foreign);
      const double frame =
          std::norm(segments.mean_gain + segments.difference_gain * segments.shared) + left;
      EXPECT_NEAR(found.foreign_share, (left - 1.5 * (1.0 + 0.7) * noise) / frame, 1e-12);
      EXPECT_NEAR(found.difference, 0.17, 1e-12);
      EXPECT_NEAR(found.difference_share, by_difference / left, 1e-12);
      EXPECT_NEAR(found.gain,
                  std::sqrt((std::norm(1.0 + segments.shared) + 1.0) /
                            (std::norm(1.0 - segments.shared) + 1.0)) -
                      1.0,
                  1e-12);
    }
  }
}

/// Wheelsets that are white, and a frame that is so but for one band of five bins.
class OneBand {
 public:
  /// A block whose frame has so much more power in the band.
  void show(std::size_t band, double power) {
    for (std::size_t k = 1; k < kSpectrumBins; ++k) {
      const std::size_t from_hz15 = k - 26;
      sums_->wheelset1[k] = sums_->wheelset2[k] = sums_->delayed1[k] = sums_->mean[k] = 1.0;
      sums_->frame[k] = k >= 26 && from_hz15 / 5 == band ? power : 1.0;
    }
    watch_.start(*sums_, {.density = 1.0});
    while (!watch_.advance(log_)) {
    }
  }
  [[nodiscard]] const Fault* fault() const {
    return log_.find(FaultKind::kRingingMount, FaultChannel::kFrame);
  }

 private:
  std::unique_ptr<SpectrumSums> sums_ = std::make_unique<SpectrumSums>();
  FaultLog log_{kPlaceRateHz};
  PlaceWatch watch_{kPlaceRateHz};
};

// A band stands over those three to five beside it: of 38 bands from 15 Hz on, the sixth to the
// sixth from the end.
TEST(PlaceWatch, SeesAPeakWithFiveBandsOnEitherSide) {
  for (const auto& [band, seen] :
       {std::pair{4U, false}, std::pair{5U, true}, std::pair{32U, true}, std::pair{33U, false}}) {
    OneBand ringing;
    for (int block = 0; block < 3; ++block) ringing.show(band, 10.0);
    ASSERT_EQ(ringing.fault() != nullptr, seen) << band;
    if (!seen) continue;
    EXPECT_NEAR(ringing.fault()->size, (26.0 + 5.0 * band + 2.0) * kPlaceBinHz, 1e-9);
  }
}

TEST(PlaceWatch, APeakIsFourTimesWhatIsBesideIt) {
  for (const auto& [power, seen] : {std::pair{3.9, false}, std::pair{4.1, true}}) {
    OneBand ringing;
    for (int block = 0; block < 3; ++block) ringing.show(15, power);
    EXPECT_EQ(ringing.fault() != nullptr, seen) << power;
  }
}

TEST(PlaceWatch, APeakStandsForThreeBlocksInARowAndMovesByABandAtMost) {
  const auto seen = [](std::initializer_list<std::pair<std::size_t, double>> blocks) {
    OneBand ringing;
    for (const auto& [band, power] : blocks) ringing.show(band, power);
    return ringing.fault() != nullptr;
  };
  EXPECT_TRUE(seen({{15, 9.0}, {15, 9.0}, {15, 9.0}}));
  EXPECT_TRUE(seen({{15, 9.0}, {16, 9.0}, {15, 9.0}}));
  EXPECT_TRUE(seen({{15, 9.0}, {14, 9.0}, {14, 9.0}}));
  EXPECT_FALSE(seen({{15, 9.0}, {17, 9.0}, {17, 9.0}}));
  EXPECT_FALSE(seen({{15, 9.0}, {13, 9.0}, {13, 9.0}}));
  EXPECT_FALSE(seen({{15, 9.0}, {15, 9.0}, {15, 3.0}, {15, 9.0}, {15, 9.0}}));
  EXPECT_TRUE(seen({{15, 3.0}, {15, 9.0}, {15, 9.0}, {15, 9.0}}));
}

}  // namespace
}  // namespace dampline
