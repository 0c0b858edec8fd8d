// SPDX-License-Identifier: MIT
#include "app/diagnosis/rig/driven_mass.hpp"

#include <algorithm>

#include "app/diagnosis/rig/rig_evidence.hpp"

namespace dampline::app {
namespace {

constexpr double kDominant = 0.5;    // of the error without an inertia, that it takes
constexpr double kSignWidths = 3.0;  // times the width that an error of the velocity makes

}  // namespace

bool is_driven_mass(const std::vector<RigSeries>& records) {
  using Kind = RigColumn::Kind;
  double width_mps = 0.0;
  for (const RigSeries& s : records) width_mps = std::max(width_mps, s.config.sign_width_mps);
  const RigEvidence evidence{{{Kind::kOne, 0.0, 0.0},
                              {Kind::kDeflection, 0.0, 0.0},
                              {Kind::kCube, 0.0, 0.0},
                              {Kind::kVelocity, 0.0, 0.0},
                              {Kind::kSign, kSignWidths * width_mps, 0.0},
                              {Kind::kAcceleration, 0.0, 0.0}},
                             records};
  const RigFit without = evidence.fit({0, 1, 2, 3, 4}, 0.0);
  const RigFit with = evidence.fit({0, 1, 2, 3, 4, 5}, 0.0);
  return without.ok && with.ok && with.theta[5] > 0.0 &&
         with.held_out_nmse < kDominant * without.held_out_nmse;
}

}  // namespace dampline::app
