// SPDX-License-Identifier: MIT
#pragma once
#include <array>

#include "dampline/snapshot.hpp"

namespace dampline {

/// Right ends of the curve's segments in m/s; the last segment goes on without end. Fixed in
/// advance, so that statistics of different runs have the same basis and merge.
inline constexpr std::array<double, kCurveSegments> kDefaultCurveNodesMps{
    3.0e-3, 5.5e-3, 8.0e-3, 11.0e-3, 14.5e-3, 19.0e-3, 26.0e-3, 40.0e-3};

}  // namespace dampline
