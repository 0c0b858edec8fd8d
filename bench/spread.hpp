// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>

namespace dampline::bench {

/// Mean, standard deviation and largest magnitude of what was added.
class Spread {
 public:
  void add(double x) {
    n_ += 1.0;
    const double delta = x - mean_;
    mean_ += delta / n_;
    squares_ += delta * (x - mean_);
    worst_ = std::max(worst_, std::abs(x));
  }
  [[nodiscard]] double mean() const { return mean_; }
  [[nodiscard]] double std() const { return n_ > 1.0 ? std::sqrt(squares_ / (n_ - 1.0)) : 0.0; }
  [[nodiscard]] double worst() const { return worst_; }
  [[nodiscard]] int count() const { return static_cast<int>(n_); }

 private:
  double n_{0.0}, mean_{0.0}, squares_{0.0}, worst_{0.0};
};

}  // namespace dampline::bench
