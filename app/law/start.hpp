// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>

#include "app/law/free_run.hpp"

namespace dampline::app::law {

/// Of a motion, as the rms of deflection and velocity have it: 2 pi s_x / s_v, s.
[[nodiscard]] double period_of(const Eigen::VectorXd& deflection_m,
                               const Eigen::VectorXd& velocity_mps);

/// A measured motion under a force, and the noise of its deflection, rms.
struct Measured {
  const Eigen::VectorXd& force_n;
  const Eigen::VectorXd& deflection_m;
  const Eigen::VectorXd& velocity_mps;
  double interval_s;
  double noise_m;
};

/// Where the mass was at the first sample, and what its terms remembered: what leaves least of the
/// record's first sixteen periods. A law that misses more than the deflection's noise has
/// deflection and velocity as they were measured.
[[nodiscard]] State start_of(const Law& law, const Measured& motion);

}  // namespace dampline::app::law
