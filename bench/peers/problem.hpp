// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

#include "sim_hw/noise.hpp"

namespace dampline::bench {

template <int N>
using Column = Eigen::Matrix<double, N, 1>;

/// What every least-squares contestant starts from: parameters 0 with this variance.
inline constexpr double kPriorVariance = 1.0e4;

template <int N>
[[nodiscard]] Column<N> true_parameters() noexcept {
  Column<N> out;
  for (int i = 0; i < N; ++i) out[i] = std::cos(1.0 + i);
  return out;
}

/// White regressors of variance 1, noise of standard deviation 0.1 on the right-hand side.
template <int N>
class WhiteRows {
 public:
  explicit WhiteRows(std::uint64_t seed) noexcept : random_{seed, sim::Stream::kSensors} {}
  void next(Column<N>& x, double& y) noexcept {
    for (int i = 0; i < N; ++i) x[i] = random_.normal();
    y = x.dot(truth_) + 0.1 * random_.normal();
  }

 private:
  sim::Random random_;
  Column<N> truth_ = true_parameters<N>();
};

template <int N>
struct Problem {
  std::vector<Column<N>> x;
  std::vector<double> y;
  explicit Problem(std::size_t rows) : x(rows), y(rows) {
    WhiteRows<N> white{1};
    for (std::size_t i = 0; i < rows; ++i) white.next(x[i], y[i]);
  }
};

}  // namespace dampline::bench
