// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "dampline/density/joint_histogram.hpp"

namespace dampline {

struct Dependence {
  bool known{false};  ///< enough cells were visited often enough
  double size{0.0};   ///< sqrt(chi^2 / N), less what chance alone makes; 0...1
};

/// Chi-square of a joint histogram against the product of its marginals, over the cells where at
/// least five independent samples are expected. `independent` is the effective number of samples:
/// for an oscillation, the number of its half periods.
template <std::size_t XBins, std::size_t YBins>
[[nodiscard]] Dependence dependence(const JointHistogram<XBins, YBins>& joint,
                                    double independent) noexcept {
  constexpr double kFewestPerCell = 5.0;
  constexpr double kFewestCells = 9.0;
  std::array<double, XBins> x{};
  std::array<double, YBins> y{};
  for (std::size_t i = 0; i < XBins; ++i) {
    for (std::size_t j = 0; j < YBins; ++j) {
      x[i] += joint.share(i, j);
      y[j] += joint.share(i, j);
    }
  }
  double sum = 0.0;
  double cells = 0.0;
  for (std::size_t i = 0; i < XBins; ++i) {
    for (std::size_t j = 0; j < YBins; ++j) {
      const double expected = x[i] * y[j];
      if (!(independent * expected >= kFewestPerCell)) continue;
      const double excess = joint.share(i, j) - expected;
      sum += excess * excess / expected;
      cells += 1.0;
    }
  }
  if (cells < kFewestCells) return {};
  return {.known = true, .size = std::sqrt(std::max(sum - cells / independent, 0.0))};
}

}  // namespace dampline
