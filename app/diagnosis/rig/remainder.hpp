// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/series.hpp"

namespace dampline::app::rig {

/// What a model leaves of its records' forces away from the reversals, where no error of the motion
/// counts.
struct Remainder {
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
[[nodiscard]] Remainder what_is_left(const std::vector<Series>& records, const Model& model);

/// Short, strong forces that nothing in the motion announces.
struct Impacts {
  std::vector<Eigen::VectorXd> left_out;  ///< of each record, as Series has it
  std::vector<double> time_s;
  std::vector<double> peak_n;
  [[nodiscard]] bool found() const noexcept { return time_s.size() >= kFewest; }
  static constexpr std::size_t kFewest = 3;
};

/// Looks at what a model leaves of each record, sample by sample: isolated peaks far above the
/// scatter about them, at moments whose deflection and velocity come without a peak elsewhere. A
/// reversal, a stop or a slot makes a peak whenever it is passed and is none.
[[nodiscard]] Impacts find_impacts(const std::vector<Series>& records,
                                   const std::vector<Eigen::VectorXd>& left_n);

}  // namespace dampline::app::rig
