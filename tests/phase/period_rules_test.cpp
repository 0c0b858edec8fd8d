// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "dampline/phase/period.hpp"

namespace dampline {
namespace {

constexpr int kRuleLags = 400;
constexpr double kLagS = 0.02;
constexpr std::uint64_t kManyPairs = 1'000'000;

using Correlation400 = std::vector<double>;
Correlation400 correlation_of(const std::function<double(double)>& r) {
  Correlation400 out;
  for (int l = 0; l < kRuleLags; ++l) out.push_back(l == 0 ? 1.0 : r(l));
  return out;
}

double turn(double lags, double period) { return std::cos(2.0 * std::numbers::pi * lags / period); }

Period found_in(const Correlation400& r, std::uint64_t pairs = kManyPairs) {
  return find_period(r.data(), kRuleLags, pairs, kLagS);
}

double variance_of(const Correlation400& r, std::uint64_t pairs) {
  double sum = 1.0;
  for (std::size_t l = 1; l < r.size(); ++l) sum += 2.0 * r[l] * r[l];
  return sum / static_cast<double>(pairs);
}

TEST(FindPeriod, IsThePlaceOfThePeaksWithTheirHeight) {
  for (const double period : {8.0, 25.0, 37.4, 90.0}) {
    const auto r = correlation_of([&](double l) { return 0.7 * turn(l, period); });
    const Period out = found_in(r);
    ASSERT_EQ(out.state, PeriodState::kFound) << period;
    EXPECT_NEAR(out.period_s, period * kLagS, 1e-4 * period * kLagS);
    EXPECT_NEAR(out.height, 0.7, 0.02);
    EXPECT_NEAR(out.persistence, 1.0, 0.01);
    EXPECT_NEAR(out.confidence, out.persistence, 1e-9);
    EXPECT_LT(out.period_std_s, 1e-3 * out.period_s);
  }
}

// Parabolas around 30.3, 60.6, ...: the refined places are exact, also midway between two lags.
TEST(FindPeriod, RefinesPeaksByAParabola) {
  for (const double period : {30.3, 30.5}) {
    const auto r = correlation_of([period](double l) {
      const double off = std::remainder(l, period);
      return 0.6 - 0.02 * off * off;
    });
    const Period out = found_in(r);
    ASSERT_EQ(out.state, PeriodState::kFound);
    EXPECT_NEAR(out.period_s, period * kLagS, 1e-9);
    EXPECT_NEAR(out.height, 0.6, 1e-9);
    EXPECT_NEAR(out.period_std_s, 0.0, 1e-7);
  }
}

// Peaks off their places by +-d in turns: the slope's deviation, of which half are independent.
TEST(FindPeriod, StatesTheDeviationThatThePeaksPlacesScatterBy) {
  const auto place = [](int m) { return 30.0 * m + (m % 2 == 0 ? 1.0 : -1.0); };
  const auto r = correlation_of([&](double l) {
    const int m = static_cast<int>(std::lround(l / 30.0));
    const double off = l - place(m);
    return m == 0 ? -0.1 : 0.6 - 0.004 * off * off;
  });
  double sum_mm = 0.0, sum_mp = 0.0, sum_pp = 0.0;
  constexpr int kMultiples = 13;
  for (int m = 1; m <= kMultiples; ++m) {
    sum_mm += m * m;
    sum_mp += m * place(m);
    sum_pp += place(m) * place(m);
  }
  const double period = sum_mp / sum_mm;
  const double left = (sum_pp - sum_mp * period) / (kMultiples - 1);
  const Period out = found_in(r);
  ASSERT_EQ(out.state, PeriodState::kFound);
  EXPECT_NEAR(out.period_s, period * kLagS, 1e-9);
  EXPECT_NEAR(out.period_std_s, kLagS * std::sqrt(left / sum_mm * 0.5 * kMultiples), 1e-9);
}

TEST(FindPeriod, NeedsATenthOfTheVariance) {
  for (const auto& [height, state] :
       {std::pair{0.11, PeriodState::kFound}, std::pair{0.095, PeriodState::kNone}})
    EXPECT_EQ(found_in(correlation_of([h = height](double l) { return h * turn(l, 25.0); })).state,
              state);
}

TEST(FindPeriod, NeedsThreeDeviationsOfASignalWithoutMemory) {
  const auto r = correlation_of([](double l) { return 0.3 * turn(l, 25.0); });
  for (const auto& [z, state] :
       {std::pair{3.05, PeriodState::kFound}, std::pair{2.95, PeriodState::kNone}}) {
    const auto pairs = static_cast<std::uint64_t>(z * z * variance_of(r, 1) / 0.09);
    const Period out = found_in(r, pairs);
    EXPECT_EQ(out.state, state) << z;
    EXPECT_NEAR(out.confidence, 1.0 - std::exp(-0.5 * z * z), 1e-3);
    EXPECT_EQ(out.period_s > 0.0, state == PeriodState::kFound);
  }
}

// What noise keeps alive falls with the lag: the far half has 0.8 of the near one at least.
TEST(FindPeriod, APeriodPersists) {
  for (const auto& [memory, state] :
       {std::pair{1100.0, PeriodState::kFound}, std::pair{700.0, PeriodState::kNone}}) {
    const auto r =
        correlation_of([m = memory](double l) { return 0.8 * std::exp(-l / m) * turn(l, 25.0); });
    const Period out = found_in(r);
    EXPECT_EQ(out.state, state) << memory;
    double near = 0.0, far = 0.0;
    for (int k = 1; k <= 15; ++k) (k <= 7 ? near : far) += std::exp(-25.0 * k / memory);
    EXPECT_NEAR(out.persistence, (far / 8.0) / (near / 7.0), 2e-3);
  }
}

TEST(FindPeriod, TakesTheFirstPeakThatIsAlmostAsHighAsTheHighest) {
  for (const auto& [between, period] : {std::pair{0.88, 20.0}, std::pair{0.82, 40.0}}) {
    const auto r = correlation_of([b = between](double l) {
      const double fundamental = 0.5 * (1.0 - b);
      return fundamental * turn(l, 40.0) + (1.0 - fundamental) * turn(l, 20.0);
    });
    EXPECT_NEAR(found_in(r).period_s, period * kLagS, 0.2 * kLagS) << between;
  }
}

TEST(FindPeriod, LooksBetweenFourLagsAndAQuarterOfTheLongest) {
  for (const auto& [period, state] :
       {std::pair{3.2, PeriodState::kNone}, std::pair{5.0, PeriodState::kFound},
        std::pair{98.0, PeriodState::kFound}, std::pair{103.0, PeriodState::kNone}})
    EXPECT_EQ(found_in(correlation_of([p = period](double l) { return turn(l, p); })).state ==
                      PeriodState::kFound &&
                  std::abs(found_in(correlation_of([p = period](double l) {
                             return turn(l, p);
                           })).period_s -
                           period * kLagS) < 0.01 * period * kLagS,
              state == PeriodState::kFound)
        << period;
}

TEST(FindPeriod, FindsNoneWithoutAPeak) {
  for (const auto& r : {correlation_of([](double l) { return std::exp(-l / 50.0); }),
                        correlation_of([](double) { return -0.1; })}) {
    const Period out = found_in(r);
    EXPECT_EQ(out.state, PeriodState::kNone);
    for (const double figure : {out.period_s, out.height, out.persistence, out.confidence})
      EXPECT_EQ(figure, 0.0);
  }
}

TEST(FindPeriod, PersistsWhollyAtMost) {
  const auto r = correlation_of([](double l) { return 0.5 * (1.0 + l / 800.0) * turn(l, 25.0); });
  const Period out = found_in(r);
  EXPECT_EQ(out.state, PeriodState::kFound);
  EXPECT_EQ(out.persistence, 1.0);
  EXPECT_LE(out.confidence, 1.0);
}

TEST(ConfirmPeriod, LooksThreePercentAround) {
  const auto r = correlation_of([](double l) { return 0.8 * turn(l, 80.0); });
  const auto confirmed = [&](double lags) {
    return confirm_period(r.data(), kRuleLags, kManyPairs, kLagS, lags * kLagS);
  };
  for (const double lags : {77.8, 80.0, 82.4}) {
    EXPECT_EQ(confirmed(lags).state, PeriodState::kFound) << lags;
    EXPECT_NEAR(confirmed(lags).period_s, 80.0 * kLagS, 1e-3);
  }
  for (const double lags : {77.0, 83.0, 40.0})
    EXPECT_EQ(confirmed(lags).state, PeriodState::kNone) << lags;
  const auto brief = correlation_of([](double l) { return 0.8 * turn(l, 10.0); });
  const auto of_brief = [&](double lags) {
    return confirm_period(brief.data(), kRuleLags, kManyPairs, kLagS, lags * kLagS).state;
  };
  EXPECT_EQ(of_brief(10.9), PeriodState::kFound) << "one lag at least";
  EXPECT_EQ(of_brief(11.1), PeriodState::kNone);
}

TEST(ConfirmPeriod, NeedsFourOfItAndFourLags) {
  const auto r = correlation_of([](double l) { return 0.8 * turn(l, 5.0); });
  const auto state = [&](double lags) {
    return confirm_period(r.data(), kRuleLags, kManyPairs, kLagS, lags * kLagS).state;
  };
  EXPECT_NE(state(4.001), PeriodState::kNotEnough);
  EXPECT_EQ(state(3.999), PeriodState::kNotEnough);
  EXPECT_NE(state(99.49), PeriodState::kNotEnough);
  EXPECT_EQ(state(99.51), PeriodState::kNotEnough);
  EXPECT_EQ(state(std::nan("")), PeriodState::kNotEnough);
  EXPECT_NE(confirm_period(r.data(), kRuleLags, kManyPairs, 0.5, 49.75).state,
            PeriodState::kNotEnough)
      << "four of 99.5 lags are those that there are";
  EXPECT_NE(confirm_period(r.data(), kRuleLags, kManyPairs, 0.5, 2.0).state,
            PeriodState::kNotEnough)
      << "four lags";
}

TEST(PeriodMeter, KnowsEnoughFromThreeTimesItsLags) {
  using Small = PeriodMeter<64>;
  Small meter = Small::make(0.01, 2).value();
  constexpr int kNeeded = 2 * (63 + 3 * 64);
  for (int i = 1; i <= kNeeded; ++i) {
    meter.update(100.0 + std::sin(0.3 * i));
    EXPECT_EQ(meter.period().state == PeriodState::kNotEnough, i < kNeeded) << i;
    EXPECT_EQ(meter.confirm(0.2).state == PeriodState::kNotEnough, i < kNeeded) << i;
  }
  EXPECT_FALSE(Small::make(std::numeric_limits<double>::infinity(), 1).ok());
  EXPECT_TRUE(Small::make(0.01, 1).ok());
}

TEST(PeriodMeter, AfterARestartNeighboursAreNew) {
  using Small = PeriodMeter<64>;
  Small meter{0.01, 1};
  for (int part = 0; part < 300; ++part) {
    for (int i = 0; i < 63; ++i) meter.update(std::sin(0.3 * i));  // one too few for a pair
    meter.restart();
  }
  EXPECT_EQ(meter.period().state, PeriodState::kNotEnough);
}

TEST(PeriodMeter, FindsAToneInAnyUnit) {
  for (const double unit : {1e-14, 1.0, 1e9}) {
    PeriodMeter<64> meter{0.01, 1};
    for (int i = 0; i < 6000; ++i) meter.update(unit * std::sin(2.0 * std::numbers::pi * i / 10.0));
    EXPECT_EQ(meter.period().state, PeriodState::kFound) << unit;
    EXPECT_NEAR(meter.period().period_s, 0.1, 1e-4);
  }
}

// Of a lag that a gap cuts off nothing is left in the next one, which would hide a small tone.
TEST(PeriodMeter, SumsNoLagAcrossAGap) {
  using Small = PeriodMeter<64>;
  for (const double constant : {0.0, 5.0}) {
    Small meter{0.01, 3};
    for (int part = 0; part < 20; ++part) {
      for (int i = 0; i < 600; ++i)
        meter.update(constant + 1e-3 * std::sin(2.0 * std::numbers::pi * i / 30.0));
      meter.update(constant + 1.0);
      meter.restart();
    }
    const Period out = meter.period();
    EXPECT_EQ(out.state, PeriodState::kFound) << constant;
    EXPECT_NEAR(out.period_s, 0.3, 1e-3);
    EXPECT_GT(out.height, 0.9);
  }
}

}  // namespace
}  // namespace dampline
