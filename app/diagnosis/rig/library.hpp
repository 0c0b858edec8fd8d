// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/rig/regression.hpp"

namespace dampline::app::rig {

/// One way an effect may look in a rig's force.
struct Candidate {
  std::string effect;
  double place{0.0};  ///< its length, m, speed, m/s, or time, s
  ColumnSet columns;  ///< without those that every model has
  int sign{0};        ///< that the first coefficient must have; 0: any
};

/// A geometric grid below `to`.
[[nodiscard]] std::vector<double> ratios(double from, double to, double ratio);

/// The size of a motion: half the range of x, rms of v, over all records.
struct Scale {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double noise_m{0.0};
  double step_m{0.0};    ///< rms of the motion from sample to sample
  double sign_mps{0.0};  ///< below it the sign of v is uncertain
  bool steady{false};    ///< all motion is at one speed: nothing can be a function of it
};
[[nodiscard]] Scale scale_of(const std::vector<Series>& records);

/// From one width of a smooth law of friction to the next.
inline constexpr double kFrictionWidthRatio = 1.2;

/// A travel that is a memory, and does not only stand for a sign.
[[nodiscard]] bool is_memory_travel(double travel_m, const Scale& scale) noexcept;

/// A law of friction wider than an error of the velocity makes it.
[[nodiscard]] bool is_smooth(const Regressor& column, const Scale& scale) noexcept;

/// Columns of every candidate and of the base model.
struct Library {
  std::vector<Regressor> columns;
  std::vector<Eigen::Index> friction;  ///< ways to write sign v: short stops, tanh(v / w)
  ColumnSet base;                      ///< beside the friction
  bool base_friction{false};
  std::vector<std::string> base_terms;
  std::vector<std::string> base_searched;  ///< effects of the base that are candidates, too
  Eigen::Index offset{0};
  Eigen::Index spring{0};
  Eigen::Index mass{0};
  bool base_offset{false};
  bool base_spring{false};
  bool may_add_spring{false};   ///< nobody has said that there is none
  bool base_is_declared{true};  ///< otherwise the record chooses friction and damping
  Eigen::Index viscous{0};
  bool wants_skew{false};
  bool wants_drift{false};
  bool wants_impacts{false};
  bool wants_mode{false};
  bool wants_viscoelastic{false};  ///< in the place of a memory; otherwise it is a candidate
  std::vector<Candidate> candidates;

  Eigen::Index add(const Regressor& column);
  [[nodiscard]] const Regressor& at(Eigen::Index i) const {
    return columns[static_cast<std::size_t>(i)];
  }
};

/// Whether somebody has said what the base is.
[[nodiscard]] bool is_base_declared(const ModelConfig& model);

/// Throws UsageError for a base that a rig cannot have.
[[nodiscard]] Library make_library(const Config& config, const Scale& scale);

/// Times of a spring behind a dashpot that a motion can tell, s.
[[nodiscard]] std::vector<double> viscoelastic_times(const Scale& scale);

/// Columns of a bank of stop operators: hats over u for each travel, and what each side loses with
/// speed.
struct BankElement {
  double travel_m{0.0};
  ColumnSet hats;
  ColumnSet speed;
};
[[nodiscard]] BankElement add_bank_element(Library& library, double travel_m);

}  // namespace dampline::app::rig
