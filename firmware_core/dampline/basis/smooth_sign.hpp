// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

namespace dampline {
namespace detail {

inline constexpr std::size_t kErfPerUnit = 256;
inline constexpr double kErfLimit = 4.0;
inline constexpr std::size_t kErfSize = static_cast<std::size_t>(kErfLimit) * kErfPerUnit + 2;

constexpr double erf_series(double x) noexcept {
  double term = x;
  double sum = x;
  for (int n = 1; n < 80; ++n) {
    term *= -x * x / n;
    sum += term / (2 * n + 1);
    if (term < 1e-17 && term > -1e-17) break;
  }
  return 1.1283791670955126 * sum;
}

constexpr std::array<float, kErfSize> make_erf_table() noexcept {
  std::array<float, kErfSize> table{};
  for (std::size_t i = 0; i < kErfSize; ++i) {
    table[i] = static_cast<float>(erf_series(static_cast<double>(i) / kErfPerUnit));
  }
  return table;
}
inline constexpr std::array<float, kErfSize> kErfTable = make_erf_table();

}  // namespace detail

/// erf of a number that is not negative; 1 for what is none.
inline double erf_of_magnitude(double magnitude) noexcept {
  // NaN must not become an index.
  if (!(magnitude < detail::kErfLimit)) return 1.0;
  const double position = magnitude * detail::kErfPerUnit;
  const int whole = static_cast<int>(position);
  const auto i = static_cast<std::size_t>(whole);
  const double below{detail::kErfTable[i]};
  const double above{detail::kErfTable[i + 1]};
  return below + (position - whole) * (above - below);
}

/// erf of a number that is not negative, in single precision; error below 2e-6. Abramowitz and
/// Stegun, Handbook of Mathematical Functions, 7.1.28: of equal operations for every number, so
/// that several go through one instruction, and the same on every machine.
inline float erf_of_magnitude(float x) noexcept {
  float p = (((((4.30638e-5F * x + 2.765672e-4F) * x + 1.520143e-4F) * x + 9.2705272e-3F) * x +
              4.22820123e-2F) *
                 x +
             7.05230784e-2F) *
                x +
            1.0F;
  p *= p;
  p *= p;
  p *= p;
  p *= p;  // the sixteenth power; where it overflows, erf is 1
  return 1.0F - 1.0F / p;
}

/// erf by a table made at compile time, so that it is the same on every machine; error below 2e-6.
inline double erf_table(double x) noexcept {
  return std::copysign(erf_of_magnitude(std::abs(x)), x);
}

/// sqrt(pi) / 2: erf(kSignSlope v / w) has slope 1 / w at v = 0.
inline constexpr double kSignSlope = 0.886226925452758;

/// The expected sign of a velocity that is known with a Gaussian error: erf(0.8862 v / w).
/// `width_mps` gathers that error and the rounding of the friction law itself.
inline double smooth_sign(double velocity_mps, double width_mps) noexcept {
  return erf_table(kSignSlope * velocity_mps / width_mps);
}

}  // namespace dampline
