// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "dampline/density/fokker_planck.hpp"

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

/// Relative distance of a curve from the two branches, |v| > 3 mm/s, root mean square over the
/// samples. Both forces are positive numbers.
inline double curve_error(const MethodResult& result, const VelocityHistogram& velocities,
                          double positive_n, double negative_n) {
  double errors = 0.0;
  double squares = 0.0;
  for (std::size_t b = 0; b < kVelocityBins; ++b) {
    const double v = velocities.axis().centre(b);
    if (std::abs(v) < 3.0e-3) continue;
    std::size_t right = 1;  // the ends go on
    while (right + 1 < result.points && result.curve[right].velocity_mps < v) ++right;
    const CurvePoint& p = result.curve[right - 1];
    const CurvePoint& q = result.curve[right];
    const double u = (v - p.velocity_mps) / (q.velocity_mps - p.velocity_mps);
    const double truth = v > 0.0 ? positive_n : -negative_n;
    errors += velocities.mass(b) * std::pow(p.force_n + u * (q.force_n - p.force_n) - truth, 2);
    squares += velocities.mass(b) * truth * truth;
  }
  return std::sqrt(errors / squares);
}

}  // namespace dampline::bench
