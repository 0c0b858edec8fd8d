// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "dampline/estimate/statistics.hpp"
#include "dampline/snapshot.hpp"

namespace dampline {

enum class DriftingParameter : std::uint8_t { kFriction, kStiffness, kMass };

[[nodiscard]] constexpr const char* name_of(DriftingParameter parameter) noexcept {
  switch (parameter) {
    case DriftingParameter::kFriction:
      return "coulomb";
    case DriftingParameter::kStiffness:
      return "stiffness";
    case DriftingParameter::kMass:
      break;
  }
  return "moving_mass";
}

/// Whether a parameter changed while the record was made (`time_drift`), which, when, how much.
struct ParameterDrift {
  bool judged{false};  ///< there are enough entries to say anything
  bool found{false};
  DriftingParameter parameter{};
  bool step{false};                    ///< at once; else slowly over the whole record
  double time_s{0.0};                  ///< of the step, in moving time from the oldest entry on
  double interval_s{0.0};              ///< the step lies within half of it on either side of time_s
  Estimate change;                     ///< relative: 0.1 means 10 % more after it, or at the end
  double gain{0.0};                    ///< share of the held-out error that the change explains
  double friction_significance{0.0};   ///< largest step of the entries' own friction, in deviations
  double stiffness_significance{0.0};  ///< the same of their stiffness
};

/// Tests the entries of the statistics for a step between any two of them and for a trend, of
/// friction, stiffness and mass (both at once: the rows are per unit of mass). A change of
/// parameter p is one more column w_b X_b u, where u is the part of the solution that p scales and
/// w_b is 0 before a step and 1 after it, or the place in the record; its normal equations follow
/// from those of the entries, so the data are not needed again. Compared by the error of held-out
/// entries.
///
/// Some hundred small systems of equations: not for the sample path.
[[nodiscard]] ParameterDrift find_parameter_drift(const ScaleFactors& total, EntryList entries,
                                                  double entry_s) noexcept;
[[nodiscard]] ParameterDrift find_parameter_drift(const Statistics& statistics,
                                                  double block_s) noexcept;

}  // namespace dampline
