// SPDX-License-Identifier: MIT
#pragma once

namespace dampline {

/// The fourth difference about 0 of `at(j)`, j = -2 ... 2.
template <class At>
[[nodiscard]] constexpr double fourth_difference(const At& at) noexcept {
  return at(-2) + at(2) - 4.0 * (at(-1) + at(1)) + 6.0 * at(0);
}

/// The eighth difference about 0 of `at(j)`, j = -4 ... 4.
template <class At>
[[nodiscard]] constexpr double eighth_difference(const At& at) noexcept {
  return at(-4) + at(4) - 8.0 * (at(-3) + at(3)) + 28.0 * (at(-2) + at(2)) -
         56.0 * (at(-1) + at(1)) + 70.0 * at(0);
}

/// Standard deviation of Gaussian white noise of which the median of |fourth difference| is known:
/// the median of |x| over sigma, times the gain sqrt(70). Jumps and curves of what is measured do
/// not count.
[[nodiscard]] constexpr double sigma_of_fourth(double median) noexcept {
  return median / (0.67449 * 8.36660);
}

/// The same from fourth and eighth differences (gain sqrt(12870)). Where the eighth have clearly
/// less, there is motion in the fourth.
[[nodiscard]] constexpr double white_sigma(double median_fourth, double median_eighth) noexcept {
  constexpr double kOfMotion = 0.8;
  const double fourth = sigma_of_fourth(median_fourth);
  const double eighth = median_eighth / (0.67449 * 113.4460);
  return eighth < kOfMotion * fourth ? eighth : fourth;
}

}  // namespace dampline
