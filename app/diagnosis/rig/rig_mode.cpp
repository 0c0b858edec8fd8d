// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/rig_mode.hpp"

#include <algorithm>
#include <numbers>

namespace dampline::app {
namespace {

constexpr int kTerms = 16;
constexpr int kHalvings = 10;
constexpr double kOfPeriod = 0.25;

/// p'' + 2 D w p' + w^2 p = w^2 u from sample to sample, exact for a u that is straight between
/// them. State: p and p' / w.
class Resonance {
 public:
  Resonance(const RigMode& mode, double interval_s) {
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
  Eigen::Matrix4d step_;
  Eigen::Vector2d state_{0.0, 0.0};
};

/// x'' over the first quarter of a period, by a parabola through its mean, its rise and its bend.
double first_accel(const Eigen::VectorXd& x, double hz, double interval_s) {
  const auto samples = static_cast<Eigen::Index>(kOfPeriod / (hz * interval_s));
  const Eigen::Index third = std::min(std::max<Eigen::Index>(samples / 3, 1), x.size() / 3);
  if (third == 0) return 0.0;
  const double length_s = static_cast<double>(third) * interval_s;
  return (x.segment(0, third).mean() - 2.0 * x.segment(third, third).mean() +
          x.segment(2 * third, third).mean()) /
         (length_s * length_s);
}

/// As if the mass had followed its foot so far: at its speed, held back by its acceleration.
void start_along(const Eigen::VectorXd& x, double v, const RigMode& mode, double interval_s,
                 Resonance& resonance) {
  const double w = 2.0 * std::numbers::pi * mode.hz;
  const double back = first_accel(x, mode.hz, interval_s) / (w * w);
  resonance.start(x[0] - back - 2.0 * mode.damping * v / w, v / w);
}

}  // namespace

Eigen::VectorXd through_mode(const Eigen::VectorXd& u, const RigMode& mode, double interval_s) {
  if (!(mode.hz > 0.0)) return u;
  Resonance resonance{mode, interval_s};
  Eigen::VectorXd out{u.size()};
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    if (i == 0)
      resonance.start(u[0]);
    else
      resonance.advance(u[i - 1], u[i]);
    out[i] = resonance.value();
  }
  return out;
}

Eigen::VectorXd attached_accel(const Eigen::VectorXd& x, const Eigen::VectorXd& v,
                               const RigMode& mode, double interval_s) {
  const double w = 2.0 * std::numbers::pi * mode.hz;
  const double d = 2.0 * mode.damping;
  Resonance resonance{mode, interval_s};
  Eigen::VectorXd out{x.size()};
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (i == 0)
      start_along(x, v[0], mode, interval_s, resonance);
    else
      resonance.advance(x[i - 1], x[i]);
    // y = p + D' p' / w, and p'' / w^2 = x - p - D' p' / w.
    const double p = resonance.value();
    const double rate = resonance.rate_over_w();
    const double left = x[i] - p - d * rate;
    out[i] = w * w * (left + d * (v[i] / w - rate - d * left));
  }
  return out;
}

}  // namespace dampline::app
