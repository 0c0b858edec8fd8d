// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/rig/record.hpp"
#include "dampline/rig/config.hpp"
#include "dampline/rig/resonance.hpp"

namespace dampline::app::rig {

using Mode = core::Mode;

/// Between samples, by a cubic with the slopes of their neighbours; the ends beyond them.
[[nodiscard]] double between(const Eigen::VectorXd& y, double place);

/// What a mass on a spring makes of a force that acts on it, seen in the spring:
///   y'' + 2 D w y' + w^2 y = w^2 u, at rest at the first sample; u straight between samples.
/// Without a mode it is u.
[[nodiscard]] Eigen::VectorXd through_mode(const Eigen::VectorXd& u, const Mode& mode,
                                           double interval_s);

/// Acceleration, m/s^2, of a mass on a spring and a damper whose foot moves by x, m, at x', m/s:
///   w^2 (x - y) + 2 D w (x' - y').
[[nodiscard]] Eigen::VectorXd attached_accel(const Eigen::VectorXd& x, const Eigen::VectorXd& v,
                                             const Mode& mode, double interval_s);

/// A rig's record in memory: motion and force at a uniform rate. Samples that are no number are
/// left out; over a gap the motion goes on.
struct Series {
  std::string record;
  std::vector<std::string> notes;  ///< what was done to the record, a sentence each
  std::vector<FaultFinding> faults{};
  double interval_s{0.0};
  bool has_gap{false};
  core::Config config;  ///< test function and derivative, as the record's noise permits
  Eigen::VectorXd time_s;
  Eigen::VectorXd deflection_m;
  Eigen::VectorXd velocity_mps;
  Eigen::VectorXd force_n;
  Eigen::VectorXd reference_n;  ///< another prediction of the force, NaN where there is none; empty
  Eigen::VectorXd accel_mps2;   ///< measured beside the deflection; empty: it is not
  Eigen::VectorXd left_out;     ///< not 0: takes no part in a fit or its error; empty: all do
  double noise_m{0.0};          ///< of the deflection, rms
  Mode path;                    ///< that a force passes before it is measured
  double zero_m{0.0};           ///< of the record's deflection, where this one's is 0
  double force_sign{1.0};       ///< -1: the record's force was turned
  double start_m{0.0};          ///< slip of all friction elements at the first sample

  [[nodiscard]] Eigen::Index size() const { return force_n.size(); }
  static constexpr double kRest = 1.0;    ///< left out because it stands still
  static constexpr double kImpact = 2.0;  ///< because something struck
  [[nodiscard]] double why_left_out(Eigen::Index i) const {
    return left_out.size() == size() ? left_out[i] : 0.0;
  }
  void set_motion(const std::vector<core::Motion>& rows);
  /// `count` samples from `first` on.
  [[nodiscard]] Series part(Eigen::Index first, Eigen::Index count) const;
};

[[nodiscard]] inline Eigen::VectorXd vector_of(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// Samples on either side of a reversal where the sign of the velocity is uncertain, and with it
/// the friction.
[[nodiscard]] inline Eigen::Index reach_of_reversal(const Series& series) {
  return 3 + series.config.velocity_half_width;
}

/// Tenths of the records at which a parameter may step: those before and after which every record
/// moves to and fro at least once over its whole range. A friction with memory does not know its
/// state at the first sample, and what it makes of the first stroke is no change.
[[nodiscard]] std::vector<double> places_of_steps(const std::vector<Series>& records);

/// Leaves out standstill, and the way from it to the next reversal.
void leave_rest_out(Series& series);

/// Reads a record. `reference_column`: a column of another prediction; empty: none. Throws RunError
/// naming the file, what was found and what was expected.
[[nodiscard]] Series read_series(const std::string& path, const Config& config, bool skip_bad_lines,
                                 const std::string& reference_column = {});

}  // namespace dampline::app::rig
