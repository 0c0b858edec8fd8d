// SPDX-License-Identifier: MIT
#include "dampline/rig/rig_test_function.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>

namespace dampline {
namespace {

/// Central differences, Fornberg, Mathematics of Computation 51 (1988) 699, table 1.
constexpr std::array<double, 4> kFirst{0.0, 3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0};
constexpr std::array<double, 4> kSecond{-49.0 / 18.0, 3.0 / 2.0, -3.0 / 20.0, 1.0 / 90.0};

}  // namespace

TestFunction::TestFunction(int half, double interval_s) noexcept
    : half_{half}, interval_s_{interval_s} {
  double sum = 0.0;
  for (int j = -half; j <= half; ++j) sum += psi(j);
  norm_ = 1.0 / sum;
}

double TestFunction::psi(int j) const noexcept {
  const int end = half_ - kDifference + 1;  // psi is 0 from here on, its differences three later
  if (std::abs(j) >= end) return 0.0;
  const double u = static_cast<double>(j) / end;
  const double q = 1.0 - u * u;
  return norm_ * q * q * q * q * q;
}

TestFunction::Values TestFunction::at(int j) const noexcept {
  Values out{psi(j), 0.0, kSecond[0] * psi(j)};
  for (int m = 1; m <= kDifference; ++m) {
    const auto i = static_cast<std::size_t>(m);
    const double before = psi(j - m);
    const double after = psi(j + m);
    out.first += kFirst[i] * (after - before);
    out.second += kSecond[i] * (after + before);
  }
  out.first /= interval_s_;
  out.second /= interval_s_ * interval_s_;
  return out;
}

double TestFunction::second_noise_gain() const noexcept {
  double sum = 0.0;
  for (int j = -half_; j <= half_; ++j) {
    const double second = at(j).second;
    sum += second * second;
  }
  return std::sqrt(sum);
}

}  // namespace dampline
