// SPDX-License-Identifier: MIT
#pragma once
#include "app/diagnosis/rig/rig_explanation.hpp"

namespace dampline::app {

/// What a model leaves of its records' forces away from the reversals, where no error of the motion
/// counts.
struct RigLeft {
  double rms_n{0.0};
  double nmse{0.0};           ///< mean of the records
  double kurtosis{0.0};       ///< 3 where it is Gaussian
  double over_time{0.0};      ///< the loudest of twelve parts of a record over the quietest, power
  double over_speed{0.0};     ///< the same of five classes of |v|
  double over_reversal{0.0};  ///< the same of five classes of travel since the last reversal
  /// Gaussian, as loud at any time and in any motion.
  [[nodiscard]] bool is_like_noise() const noexcept;
};
/// `model`: without inertia among its columns.
[[nodiscard]] RigLeft what_is_left(const std::vector<RigSeries>& records, const RigModel& model);

}  // namespace dampline::app
