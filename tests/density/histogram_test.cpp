// SPDX-License-Identifier: MIT
#include "dampline/density/histogram.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sim_hw/noise.hpp"

namespace dampline {
namespace {

using Fine = Histogram<64>;

HistogramConfig given(double low, double high, double memory = 0.0) {
  return {.range = {.low = low, .high = high}, .memory_samples = memory};
}

HistogramConfig learned(double resolution, std::uint32_t warm_up) {
  return {.range = {.resolution = resolution, .warm_up_samples = warm_up}};
}

std::vector<double> normal_numbers(std::uint64_t seed, int count) {
  sim::Random random{seed, sim::Stream::kTrack};
  std::vector<double> out;
  for (int i = 0; i < count; ++i) out.push_back(random.normal());
  return out;
}

template <class H>
double integral(const H& h) {
  double sum = h.share_below() + h.share_above();
  for (std::size_t b = 0; b < H::kBins; ++b) sum += h.density(b) * h.axis().width();
  return sum;
}

TEST(GrowingWeight, GrowsByEInItsMemoryHoweverBrief) {
  EXPECT_NEAR(GrowingWeight{0.5}.growth(), std::exp(2.0), 1e-12);
  EXPECT_EQ(GrowingWeight{0.0}.growth(), 1.0);
}

TEST(Histogram, ChecksItsConfiguration) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(Fine::check(given(-1.0, 1.0)).ok());
  EXPECT_TRUE(Fine::check(learned(1e-3, 10)).ok());
  EXPECT_FALSE(Fine::check(given(1.0, -1.0)).ok());
  EXPECT_FALSE(Fine::check(given(1.0, 1.0)).ok());
  EXPECT_FALSE(Fine::check(given(nan, 1.0)).ok());
  EXPECT_FALSE(Fine::check(given(-1.0, 1.0, -2.0)).ok());
  EXPECT_FALSE(Fine::check(given(-1.0, 1.0, nan)).ok());
  EXPECT_FALSE(Fine::check(learned(0.0, 10)).ok());
  EXPECT_FALSE(Fine::check(learned(1e-3, 0)).ok());
}

TEST(Histogram, PutsASampleWhereItBelongs) {
  Histogram<4> h{given(-2.0, 2.0)};
  for (const double x : {-2.0, -1.0001, -1.0, 0.0, 0.999, 1.0, 1.999}) h.update(x);
  for (const double x : {-2.0001, 2.0, 9.0}) h.update(x);
  EXPECT_EQ(h.mass(0), 2.0);
  EXPECT_EQ(h.mass(1), 1.0);
  EXPECT_EQ(h.mass(2), 2.0);
  EXPECT_EQ(h.mass(3), 2.0);
  EXPECT_DOUBLE_EQ(h.share_below(), 0.1);
  EXPECT_DOUBLE_EQ(h.share_above(), 0.2);
  EXPECT_DOUBLE_EQ(h.density(0), 0.2);
}

TEST(Histogram, CountsWhatIsNotFiniteApart) {
  Fine h{given(-1.0, 1.0)};
  h.update(std::numeric_limits<double>::quiet_NaN());
  h.update(std::numeric_limits<double>::infinity());
  h.update(0.0);
  EXPECT_EQ(h.not_finite(), 2U);
  EXPECT_EQ(h.samples(), 1U);
  EXPECT_EQ(h.share(32), 1.0);
}

TEST(Histogram, WithoutSamplesHasNoDensity) {
  const Fine h{given(-1.0, 1.0)};
  EXPECT_EQ(integral(h), 0.0);
}

// The range holds 68 % of the mass, so a third of it lies outside.
TEST(Histogram, IntegratesToOneWithTheMassOutside) {
  Fine plain{given(-1.0, 1.0)};
  Fine forgetting{given(-1.0, 1.0, 777.0)};
  for (const double x : normal_numbers(1, 300'000)) {
    plain.update(x);
    forgetting.update(x);
  }
  EXPECT_NEAR(plain.share_outside(), std::erfc(1.0 / std::numbers::sqrt2), 3e-3);
  EXPECT_NEAR(integral(plain), 1.0, 1e-12);
  EXPECT_NEAR(integral(forgetting), 1.0, 1e-12);
}

TEST(Histogram, ShowsTheDensityOfWhatItWasGiven) {
  Fine h{given(-4.0, 4.0)};
  for (const double x : normal_numbers(2, 400'000)) h.update(x);
  for (std::size_t b = 0; b < 64; ++b) {
    const double left = h.axis().low() + static_cast<double>(b) * h.axis().width();
    const double expected = 0.5 * (std::erf((left + h.axis().width()) / std::numbers::sqrt2) -
                                   std::erf(left / std::numbers::sqrt2));
    EXPECT_NEAR(h.share(b), expected, 5.0 * std::sqrt(expected / 400'000.0) + 1e-6) << b;
  }
}

TEST(Histogram, TwoHalvesMergeToTheWholeExactly) {
  const auto numbers = normal_numbers(3, 20'001);
  Histogram<64, 4> whole{given(-2.0, 2.5)};
  Histogram<64, 4> first{given(-2.0, 2.5)};
  Histogram<64, 4> second{given(-2.0, 2.5)};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    whole.update(numbers[i], i % 4);
    (i < 7'000 ? first : second).update(numbers[i], i % 4);
  }
  ASSERT_TRUE(first.merge(second).ok());
  EXPECT_EQ(first.samples(), whole.samples());
  EXPECT_EQ(first.share_outside(), whole.share_outside());
  for (std::size_t g = 0; g < 4; ++g) {
    for (std::size_t b = 0; b < 64; ++b) EXPECT_EQ(first.mass(b, g), whole.mass(b, g));
  }
}

TEST(Histogram, DoesNotMergeOtherBinsOrMemories) {
  Fine h{given(-1.0, 1.0)};
  h.update(0.5);
  for (const HistogramConfig& other : {given(-1.0, 2.0), given(-1.0, 1.0, 100.0)}) {
    const auto merged = h.merge(Fine{other});
    ASSERT_FALSE(merged.ok());
    EXPECT_EQ(merged.error(), Errc::kMismatch);
  }
  EXPECT_EQ(h.samples(), 1U);
}

// No sample of the warm-up is lost, and what comes later is counted outside.
TEST(Histogram, LearnsItsRangeWithoutForgettingASample) {
  Fine h{learned(1e-6, 1'000)};
  const auto numbers = normal_numbers(4, 5'000);
  double largest = 0.0;
  for (std::size_t i = 0; i < 1'000; ++i) {
    h.update(numbers[i]);
    largest = std::max(largest, std::abs(numbers[i]));
    EXPECT_EQ(h.share_outside(), 0.0);
  }
  EXPECT_FALSE(h.axis().learning());
  const double high = h.axis().high();
  EXPECT_GE(high, 1.5 * largest);
  EXPECT_LT(high, 3.0 * largest + 1e-9);
  EXPECT_DOUBLE_EQ(h.axis().low(), -high);
  h.update(3.0 * high);
  EXPECT_EQ(h.axis().high(), high);
  EXPECT_GT(h.share_above(), 0.0);
  EXPECT_NEAR(integral(h), 1.0, 1e-12);
}

TEST(Histogram, OfALearnedRangeIsThatOfTheSameRangeGiven) {
  const auto numbers = normal_numbers(5, 4'000);
  Fine learner{learned(1e-6, 1'000)};
  for (const double x : numbers) learner.update(x);
  Fine known{given(learner.axis().low(), learner.axis().high())};
  for (const double x : numbers) known.update(x);
  for (std::size_t b = 0; b < 64; ++b) EXPECT_EQ(learner.mass(b), known.mass(b)) << b;
}

// After n samples of a new place, what is left of the old is exp(-n / memory).
TEST(Histogram, ForgetsByItsTimeConstant) {
  Fine h{given(-1.0, 1.0, 500.0)};
  for (int i = 0; i < 20'000; ++i) h.update(-0.5);
  for (int i = 0; i < 1'000; ++i) h.update(0.5);
  EXPECT_NEAR(h.share(16), std::exp(-2.0), 1e-9);
  EXPECT_NEAR(h.share(48), 1.0 - std::exp(-2.0), 1e-9);
}

// The weights are scaled back every 208 memories.
TEST(Histogram, ForgetsAlikeForever) {
  Fine h{given(-1.0, 1.0, 10.0)};
  for (int i = 0; i < 50'000; ++i) h.update(i % 2 == 0 ? -0.5 : 0.5);
  const double older = std::exp(-0.1);
  EXPECT_NEAR(h.share(48) / h.share(16), 1.0 / older, 1e-9);
  EXPECT_NEAR(h.mass(48), 1.0 / (1.0 - older * older), 1e-9);
  EXPECT_NEAR(integral(h), 1.0, 1e-12);
}

// What lies outside is forgotten with the rest.
TEST(Histogram, ForgetsWhatIsOutsideAlikeForever) {
  Fine h{given(-1.0, 1.0, 10.0)};
  for (int i = 0; i < 30'000; ++i) h.update(static_cast<double>(i % 3 - 1) * 2.0);
  const double older = std::exp(-0.1);
  const double all = 1.0 + older + older * older;
  EXPECT_NEAR(h.share_above(), 1.0 / all, 1e-9);
  EXPECT_NEAR(h.share(32), older / all, 1e-9);
  EXPECT_NEAR(h.share_below(), older * older / all, 1e-9);
}

// Both are seen at their own newest sample.
TEST(Histogram, MergesWhatForgetsEitherWay) {
  Fine brief{given(-1.0, 1.0, 100.0)};
  Fine lasting{given(-1.0, 1.0, 100.0)};
  for (const double x : normal_numbers(6, 150)) brief.update(x);
  for (const double x : normal_numbers(7, 2000)) lasting.update(x + 0.5);
  Fine other = lasting;
  ASSERT_TRUE(other.merge(brief).ok());
  ASSERT_TRUE(brief.merge(lasting).ok());
  EXPECT_EQ(brief.samples(), 2150U);
  EXPECT_NEAR(integral(brief), 1.0, 1e-12);
  EXPECT_NEAR(brief.share_below(), other.share_below(), 1e-12);
  EXPECT_NEAR(brief.share_above(), other.share_above(), 1e-12);
  double mass = 0.0;
  for (std::size_t b = 0; b < 64; ++b) {
    EXPECT_NEAR(brief.share(b), other.share(b), 1e-12);
    EXPECT_NEAR(brief.mass(b), other.mass(b), 1e-9);
    mass += brief.mass(b);
  }
  const double effective = (2.0 - std::exp(-1.5) - std::exp(-20.0)) / (1.0 - std::exp(-0.01));
  EXPECT_NEAR(mass, effective * (1.0 - brief.share_outside()), 1e-6 * effective);
}

}  // namespace
}  // namespace dampline
