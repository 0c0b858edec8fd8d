// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/report/svg/figure.hpp"
#include "app/verify/phase/studies.hpp"

namespace dampline::app {

/// The extended phase space of one simulated system: its trajectories on the three planes, the
/// section at the drive's phase 0, and that section seen along the plane that fits it best, where
/// the points of a linear system are a straight line.
struct PhasePictures {
  std::string name;       ///< of the system
  double off_plane{0.0};  ///< rms distance of the section from the plane over rms acceleration
  std::size_t points{0};  ///< of the section that move
  Plot plot;
};

/// The systems of the literature: viscous, Coulomb, structural friction, a cubic spring.
[[nodiscard]] std::vector<PhasePictures> phase_pictures();

/// g(y) under the publication's inputs: one curve per value of a family.
struct FrictionFamily {
  std::string name;  ///< "omega", "P1", "P0"
  struct Curve {
    double value{0.0};   ///< of the input that stays the same
    FrictionStudy rest;  ///< each regime goes on from where the one before ended, first from rest
    FrictionStudy started;  ///< from 24 starts within 3
  };
  std::vector<Curve> curves;
};

/// Families over frequency, amplitude and mean, as the publication's figures 2 and 4; a few
/// seconds.
[[nodiscard]] std::vector<FrictionFamily> friction_families();

/// Two panels a family: found over published, and what is between them.
[[nodiscard]] Plot plot_families(const std::vector<FrictionFamily>& families);

}  // namespace dampline::app
