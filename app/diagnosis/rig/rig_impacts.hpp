// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/rig_series.hpp"

namespace dampline::app {

/// Short, strong forces that nothing in the motion announces.
struct RigImpacts {
  std::vector<Eigen::VectorXd> left_out;  ///< of each record: 1 where an impact is, otherwise 0
  std::vector<double> time_s;
  std::vector<double> peak_n;
  [[nodiscard]] bool found() const noexcept { return time_s.size() >= kFewest; }
  static constexpr std::size_t kFewest = 3;
};

/// Looks at what a model leaves of each record, sample by sample: isolated peaks far above the
/// scatter about them, at moments whose deflection and velocity come without a peak elsewhere. A
/// reversal, a stop or a slot makes a peak whenever it is passed and is none.
[[nodiscard]] RigImpacts find_impacts(const std::vector<RigSeries>& records,
                                      const std::vector<Eigen::VectorXd>& left_n);

}  // namespace dampline::app
