// SPDX-License-Identifier: MIT
#include "dampline/basis/window_bank.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numbers>
#include <span>

#include "tests/steps.hpp"
#include "tests/wavelet/bump.hpp"

namespace dampline {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

/// Sum of table[n] f(n), n counted from the centre.
double sum(std::span<const double> table, const std::function<double(double)>& f) {
  const std::size_t centre = table.size() / 2;
  const auto half = static_cast<double>(centre);
  double out = 0.0;
  for (std::size_t i = 0; i < table.size(); ++i) out += table[i] * f(static_cast<double>(i) - half);
  return out;
}

/// Moment over the moment of the magnitude: 1 if nothing cancelled.
double moment(std::span<const double> table, int order) {
  const std::size_t centre = table.size() / 2;
  const auto half = static_cast<double>(centre);
  double signed_sum = 0.0;
  double magnitude = 0.0;
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double term = table[i] * std::pow(static_cast<double>(i) - half, order);
    signed_sum += term;
    magnitude += std::abs(term);
  }
  return std::abs(signed_sum) / magnitude;
}

class WindowBankAtRates : public testing::TestWithParam<double> {
 protected:
  const double step_s_ = 1.0 / GetParam();
  const WindowBank bank_{GetParam()};
};
INSTANTIATE_TEST_SUITE_P(Rates, WindowBankAtRates, testing::Values(150.0, 200.0, 300.0, 400.0));

// Sums of samples are not integrals: what is left falls with the sixth power of the length.
double moment_tolerance(int half) { return 1e-13 + 600.0 * std::pow(half, -6.0); }

TEST_P(WindowBankAtRates, PsiHasFourVanishingMoments) {
  for (std::size_t s = 0; s < kScales; ++s) {
    for (int order = 0; order < 4; ++order) {
      EXPECT_LT(moment(bank_.psi(s), order), moment_tolerance(bank_.half(s))) << s << " " << order;
      EXPECT_LT(moment(bank_.lumped_psi(s), order), moment_tolerance(bank_.half(s)));
    }
    EXPECT_GT(moment(bank_.psi(s), 4), 0.05) << "the fourth is the first that does not vanish";
  }
}

TEST_P(WindowBankAtRates, TheDoubleIntegralHasTwoVanishingMoments) {
  for (std::size_t s = 0; s < kScales; ++s) {
    for (int order = 0; order < 2; ++order) {
      EXPECT_LT(moment(bank_.lumped_double_integral(s), order), moment_tolerance(bank_.half(s)));
    }
    EXPECT_GT(moment(bank_.lumped_double_integral(s), 2), 0.05);
  }
}

TEST_P(WindowBankAtRates, TheSingleIntegralHasThreeVanishingMoments) {
  for (std::size_t s = 0; s < kScales; ++s) {
    for (int order = 0; order < 3; ++order) {
      EXPECT_LT(moment(bank_.lumped_psi1(s), order), moment_tolerance(bank_.half(s)));
    }
    EXPECT_GT(moment(bank_.lumped_psi1(s), 3), 0.05);
  }
}

TEST_P(WindowBankAtRates, TheTablesAreDerivativesOfTheBumpWithOneNormalisation) {
  for (std::size_t s = 0; s < kScales; ++s) {
    const int reach = bank_.half(s) + 1;
    long double energy = 0.0L;
    for (int n = -reach; n <= reach; ++n) {
      const auto psi = bump_derivative(4, static_cast<long double>(n) / reach);
      energy += psi * psi;
    }
    const auto norm = static_cast<double>(1.0L / std::sqrt(energy));
    const auto lumped = [&](int order, int n) {
      const auto at = [&](int m) {
        return bump_derivative(order, static_cast<long double>(m) / reach);
      };
      return norm * static_cast<double>((at(n - 1) + 10.0L * at(n) + at(n + 1)) / 12.0L);
    };
    const double tau_s = reach * step_s_;
    for (int n = -reach; n <= reach; ++n) {
      const auto i = static_cast<std::size_t>(n + reach);
      EXPECT_NEAR(bank_.lumped_psi(s)[i], lumped(4, n), 1e-13);
      EXPECT_NEAR(bank_.lumped_psi1(s)[i], tau_s * lumped(3, n), 1e-13);
      EXPECT_NEAR(bank_.lumped_double_integral(s)[i], tau_s * tau_s * lumped(2, n), 1e-13);
    }
  }
}

TEST_P(WindowBankAtRates, TheEnergyOfPsiIsOne) {
  for (std::size_t s = 0; s < kScales; ++s) {
    double energy = 0.0;
    double mass = 0.0;
    for (const double x : bank_.psi(s)) {
      energy += x * x;
      mass += std::abs(x);
    }
    EXPECT_NEAR(energy, 1.0, 1e-13);
    EXPECT_NEAR(bank_.mass(s), mass, 1e-12);
  }
}

/// The heart of the method: displacement and velocity through accelerations alone.
TEST_P(WindowBankAtRates, IntegrationByPartsHoldsForSmoothMotion) {
  for (std::size_t s = 0; s < kScales; ++s) {
    const double f_hz = 2.0 * std::pow(2.0, static_cast<double>(s));
    const double w = kTwoPi * f_hz * 0.8;
    const double h = step_s_;
    const auto y = [&](double n) { return std::sin(w * h * n + 0.7); };
    const auto v = [&](double n) { return w * std::cos(w * h * n + 0.7); };
    const auto a = [&](double n) { return -w * w * std::sin(w * h * n + 0.7); };
    const double scale = std::abs(sum(bank_.lumped_psi(s), y));
    ASSERT_GT(scale, 0.1);
    const double tolerance = 1e-12 + 100.0 * std::pow(bank_.half(s), -6.0);
    EXPECT_NEAR(sum(bank_.lumped_double_integral(s), a), sum(bank_.lumped_psi(s), y),
                tolerance * scale)
        << "scale " << s;
    EXPECT_NEAR(-sum(bank_.lumped_psi1(s), a), sum(bank_.lumped_psi(s), v), tolerance * scale * w)
        << "scale " << s;
  }
}

TEST_P(WindowBankAtRates, ADriftingSensorDropsOutOfTheStiffnessColumn) {
  for (std::size_t s = 0; s < kScales; ++s) {
    const auto table = bank_.lumped_double_integral(s);
    double magnitude = 0.0;
    for (const double x : table) magnitude += std::abs(x);
    EXPECT_LT(std::abs(sum(table, [](double n) { return 3.0 + 0.01 * n; })),
              3.1 * magnitude * moment_tolerance(bank_.half(s)));
  }
}

/// Where |sum psi cos| is largest, over a nominal frequency.
double peak_over(std::span<const double> psi, double nominal_hz, double step_s) {
  double best = 0.0;
  double best_hz = 0.0;
  for (const double f_hz : steps(0.5 * nominal_hz, 2.0 * nominal_hz, 0.002 * nominal_hz)) {
    const double w = kTwoPi * f_hz * step_s;
    const double c = std::abs(sum(psi, [w](double n) { return std::cos(w * n); }));
    if (c <= best) continue;
    best = c;
    best_hz = f_hz;
  }
  return best_hz / nominal_hz;
}

// The bump's spectrum is not quite Gaussian: the peak lies a tenth below the nominal octave.
TEST_P(WindowBankAtRates, PeaksATenthBelowOctavesFrom2Hz) {
  for (std::size_t s = 0; s < kScales; ++s) {
    const double nominal_hz = 2.0 * std::pow(2.0, static_cast<double>(s));
    // Half supports are whole numbers of samples, and psi ends one sample beyond.
    EXPECT_NEAR(peak_over(bank_.psi(s), nominal_hz, step_s_), 0.9, 0.01 + 1.2 / bank_.half(s)) << s;
    const double by_support_hz = 1.0 / ((bank_.half(s) + 1) * step_s_);
    EXPECT_NEAR(peak_over(bank_.psi(s), by_support_hz, step_s_), 1.245, 0.01) << s;
  }
}

/// The lumped table on samples is psi on the average by a hat of two samples' width.
TEST_P(WindowBankAtRates, LumpingMatchesTheHatAverageToFourthOrder) {
  for (std::size_t s = 0; s < kScales; ++s) {
    const double w = kTwoPi * 2.0 * std::pow(2.0, static_cast<double>(s)) * step_s_;
    // The hat average of a sine is the sine times sinc^2(w / 2).
    const double sinc = std::sin(0.5 * w) / (0.5 * w);
    const auto y = [w](double n) { return std::cos(w * n); };
    const double averaged = sinc * sinc * sum(bank_.psi(s), y);
    EXPECT_NEAR(sum(bank_.lumped_psi(s), y) / averaged, 1.0, std::pow(w, 4) / 100.0 + 1e-12);
    // Without it the difference is of second order.
    EXPECT_GT(std::abs(sum(bank_.psi(s), y) / averaged - 1.0), w * w / 20.0);
  }
}

TEST_P(WindowBankAtRates, RowsOverlapByThreeQuarters) {
  for (std::size_t s = 0; s < kScales; ++s) {
    const double half = WindowBank::kHalfSupportS / step_s_ / std::pow(2.0, static_cast<double>(s));
    EXPECT_NEAR(bank_.half(s), half, 0.5) << s;
    EXPECT_LE(bank_.stride(s), 0.25 * half) << s;
    EXPECT_GT(bank_.stride(s) + 1, 0.25 * half) << s;
  }
}

TEST(WindowBank, MovesByOneSampleAtLeast) {
  const WindowBank bank{60.0};  // a quarter of the shortest half support is 0.65 samples
  EXPECT_EQ(bank.stride(kScales - 1), 1);
}

TEST(WindowBank, TablesOfDifferentScalesDoNotOverlapAtTheHighestRate) {
  const WindowBank bank{WindowBank::kMaxRateHz};
  EXPECT_LE(bank.half(0), WindowBank::kMaxHalf);
  std::size_t taps = 0;
  for (std::size_t s = 0; s < kScales; ++s) {
    const auto left = bank.lumped_psi(s);
    taps += left.size();
    if (s + 1 < kScales) {
      EXPECT_LE(left.data() + left.size(), bank.lumped_psi(s + 1).data());
    }
  }
  // Four tables, and half of one in single precision: the least that holds them, and 3 %.
  EXPECT_LE(sizeof(bank), 1.03 * static_cast<double>(taps) * (4.0 * 8.0 + 2.0));
}

/// The share by its definition, of a ring that is marked at these places from the window's first
/// sample on.
template <class Bank>
void expect_shares_of(const Bank& bank, const WindowBank& exact, double tolerance) {
  constexpr std::size_t kRing = 1000;
  for (std::size_t s = 0; s < kScales; ++s) {
    const auto psi = exact.psi(s);
    for (const std::size_t first : {std::size_t{0}, kRing - 2}) {
      std::array<float, kRing> all{};
      for (std::size_t i = 0; i < psi.size(); ++i) {
        std::array<float, kRing> one{};
        one[(first + i) % kRing] = all[(first + i) % kRing] = 1.0F;
        EXPECT_NEAR(bank.marked_share(s, one, first), std::abs(psi[i]) / exact.mass(s), tolerance);
      }
      EXPECT_NEAR(bank.marked_share(s, all, first), 1.0, tolerance) << "nothing beyond its ends";
      all[(first + psi.size()) % kRing] = all[(first + kRing - 1) % kRing] = 1.0F;
      EXPECT_NEAR(bank.marked_share(s, all, first), 1.0, tolerance);
    }
  }
}

TEST_P(WindowBankAtRates, AMarkedSampleSharesByItsMagnitude) {
  expect_shares_of(bank_, bank_, 1e-12);
}

TEST(WindowBank, InSinglePrecisionIsTheSame) {
  for (const double rate_hz : {150.0, 300.0}) {
    const WindowBank exact{rate_hz};
    const BasicWindowBank<float, 300> bank{rate_hz};
    expect_shares_of(bank, exact, 1e-7);
    for (std::size_t s = 0; s < kScales; ++s) {
      ASSERT_EQ(bank.half(s), exact.half(s));
      EXPECT_EQ(bank.stride(s), exact.stride(s));
      for (int n = -bank.half(s); n <= bank.half(s); ++n) {
        const auto i = static_cast<std::size_t>(bank.half(s) - std::abs(n));
        const auto tap = static_cast<std::size_t>(bank.half(s) + n);
        EXPECT_NEAR(bank.half_psi(s)[i], exact.psi(s)[tap], 1e-7) << s << ", " << n;
        EXPECT_NEAR(bank.lumped_psi(s)[tap + 1], exact.lumped_psi(s)[tap + 1], 1e-7);
      }
    }
  }
}

}  // namespace
}  // namespace dampline
