// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/rig/rig_config.hpp"
#include "dampline/rig/rig_snapshot.hpp"

namespace dampline {

/// Point of the curve that is nearest to a velocity, on the velocity's own branch.
[[nodiscard]] std::size_t nearest_rig_point(const RigConfig& config, double velocity_mps) noexcept;

/// Both branches of the broken line from a solution of RigModel::curve().
[[nodiscard]] RigCurve rig_curve(
    const RigSolution& solution, const RigConfig& config,
    const std::array<std::uint64_t, kRigCurvePoints>& support) noexcept;

}  // namespace dampline
