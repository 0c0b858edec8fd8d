// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <numbers>

namespace dampline::rig {

/// A resonance: natural frequency and damping ratio; hz = 0: none.
struct Mode {
  double hz{0.0};
  double damping{0.0};
};

/// p'' + 2 D w p' + w^2 p = w^2 u from sample to sample, exact for a u that is straight between
/// them. State: p and p' / w.
class Resonance {
 public:
  Resonance(const Mode& mode, double interval_s) {
    const double turn = 2.0 * std::numbers::pi * mode.hz * interval_s;
    // State, u and its rise within the interval; van Loan's exponential.
    Eigen::Matrix4d rate = Eigen::Matrix4d::Zero();
    rate(0, 1) = turn;
    rate(1, 0) = -turn;
    rate(1, 1) = -2.0 * mode.damping * turn;
    rate(1, 2) = turn;
    rate(2, 3) = 1.0;
    rate /= static_cast<double>(1 << kHalvings);
    step_ = Eigen::Matrix4d::Identity();
    Eigen::Matrix4d term = step_;
    for (int i = 1; i <= kTerms; ++i) {
      term = (term * rate / static_cast<double>(i)).eval();
      step_ += term;
    }
    for (int i = 0; i < kHalvings; ++i) step_ = (step_ * step_).eval();
  }

  void start(double u, double rate_over_w = 0.0) { state_ = {u, rate_over_w}; }
  void advance(double before, double after) {
    const double rise = after - before;
    const double p = step_(0, 0) * state_[0] + step_(0, 1) * state_[1] + step_(0, 2) * before +
                     step_(0, 3) * rise;
    const double rate = step_(1, 0) * state_[0] + step_(1, 1) * state_[1] + step_(1, 2) * before +
                        step_(1, 3) * rise;
    state_ = {p, rate};
  }
  [[nodiscard]] double value() const { return state_[0]; }
  [[nodiscard]] double rate_over_w() const { return state_[1]; }

 private:
  static constexpr int kTerms = 16;
  static constexpr int kHalvings = 10;

  Eigen::Matrix4d step_;
  Eigen::Vector2d state_{0.0, 0.0};
};

}  // namespace dampline::rig
