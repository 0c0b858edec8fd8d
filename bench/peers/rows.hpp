// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <ctime>
#include <functional>
#include <limits>
#include <string>
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

/// Processor time of this thread; what other programs take from the core does not count.
inline double thread_time_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec);
}

struct Contestant {
  std::string name;
  std::function<void()> run;  ///< the whole work once, from a fresh start
  double best_ns{std::numeric_limits<double>::infinity()};
};

/// Every contestant once a round, so that a slow moment of the machine meets all of them; of each
/// the best round counts.
inline void race(std::vector<Contestant>& contestants, int rounds) {
  for (int round = 0; round < rounds; ++round) {
    for (Contestant& c : contestants) {
      const double start_ns = thread_time_ns();
      c.run();
      c.best_ns = std::min(c.best_ns, thread_time_ns() - start_ns);
    }
  }
}

}  // namespace dampline::bench
