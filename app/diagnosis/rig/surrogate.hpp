// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "app/diagnosis/rig/explanation.hpp"
#include "app/diagnosis/rig/library.hpp"
#include "app/law/free_run.hpp"

namespace dampline::app::rig {

/// Standard deviation of white noise, from fourth differences: jumps and curves of what is measured
/// do not count. At least what the resolution makes.
[[nodiscard]] double white_noise(const Eigen::VectorXd& values);
/// The step that a digitized signal is rounded to; 0: none is seen.
[[nodiscard]] double resolution_of(const Eigen::VectorXd& values);

/// A law as the surrogate needs it.
struct Law {
  std::vector<Regressor> columns;
  Eigen::VectorXd theta;
  /// Columns that are sign v in one way or another: a law no wider than an error of the velocity
  /// has the sign itself, the estimate any of `friction`.
  std::vector<Regressor> friction;
  double ridge{0.0};
  Scale scale;  ///< of the motion: what is narrower than an error of the velocity is a sign
  std::optional<law::Law> moves{};  ///< the same as a law of a driven mass that can be moved
};

/// The record that a driven mass's law makes by its own motion under the record's force, with its
/// leaps at reversals, as it would be measured: with the record's noise, and more of the force.
/// Nothing where it goes another way than the record.
[[nodiscard]] std::optional<Series> moved_surrogate(const Series& record, const law::Law& law,
                                                    double force_noise_n, std::uint64_t seed);

struct Floor {
  double nmse{0.0};         ///< held out, mean of the records; 0: not known
  double noise_share{0.0};  ///< of it, what the noise of the force makes
};
/// What the same estimator leaves of the surrogates of all records, which no effect can take away.
/// A surrogate is the record that the law alone would have made: by its own motion where it moves
/// as the record does, otherwise on the measured motion, smoothed; measured again with the record's
/// own noise and resolution; noise is no more than what periods of the motion differ by.
[[nodiscard]] Floor surrogate_floor(const std::vector<Series>& records, const Law& law);

}  // namespace dampline::app::rig
