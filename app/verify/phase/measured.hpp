// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/report/svg/figure.hpp"
#include "app/verify/phase/rows.hpp"
#include "published/phase/planarity.hpp"
#include "published/phase/scaling.hpp"

namespace dampline::app {

/// What a rig measured: motion that was imposed and the force that answered, at a uniform rate. All
/// three have as many values.
struct MeasuredRecord {
  std::string name;
  double interval_s{0.0};
  std::vector<double> deflection_m{}, velocity_mps{}, force_n{};
};

/// The cycles of a record whose motion repeats, and its sections at eight phases; phase 0 is where
/// the deflection rises through the middle of its range. `input` is the deflection, `accel_mps2`
/// the force in N.
struct MeasuredCycles {
  double period_s{0.0};
  double amplitude_m{0.0};  ///< half of the range
  int cycles{0};            ///< alike within 5 %
  SectionMeans<8> sections{};
};

/// None where fewer than three cycles, or fewer than half of them, have one length and amplitude.
[[nodiscard]] std::optional<MeasuredCycles> measured_cycles(const MeasuredRecord& record);

/// First evidence of linearity: m y'' = P - H - R, so that the force which moves an element without
/// mass is a plane over deflection and velocity if both are linear. The force stands where the
/// publication's equation 5 has the acceleration. Points slower than a twentieth of the rms
/// velocity are left out.
[[nodiscard]] PlanarityVerdict study_measured_plane(const MeasuredRecord& record);

/// Second evidence: of two records with the same period, whether the force grows as the motion
/// does. None where a record has no cycles or the periods differ by more than 2 %.
[[nodiscard]] std::optional<ScalingVerdict> study_measured_scaling(const MeasuredRecord& one,
                                                                   const MeasuredRecord& other);

/// Both evidences on the records: a row for each, and one for each pair of the same period.
[[nodiscard]] std::vector<PhaseRow> record_rows(const std::vector<MeasuredRecord>& records);

/// A record on its three planes, with its sections.
[[nodiscard]] Plot plot_measured(const MeasuredRecord& record);

}  // namespace dampline::app
