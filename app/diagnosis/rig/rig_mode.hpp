// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>

namespace dampline::app {

/// A resonance: natural frequency and damping ratio; hz = 0: none.
struct RigMode {
  double hz{0.0};
  double damping{0.0};
};

/// What a mass on a spring makes of a force that acts on it, seen in the spring:
///   y'' + 2 D w y' + w^2 y = w^2 u, at rest at the first sample; u straight between samples.
/// Without a mode it is u.
[[nodiscard]] Eigen::VectorXd through_mode(const Eigen::VectorXd& u, const RigMode& mode,
                                           double interval_s);

/// Acceleration, m/s^2, of a mass on a spring and a damper whose foot moves by x, m, at x', m/s:
///   w^2 (x - y) + 2 D w (x' - y').
[[nodiscard]] Eigen::VectorXd attached_accel(const Eigen::VectorXd& x, const Eigen::VectorXd& v,
                                             const RigMode& mode, double interval_s);

}  // namespace dampline::app
