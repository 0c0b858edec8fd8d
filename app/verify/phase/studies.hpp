// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "app/verify/phase/simulated.hpp"
#include "published/phase/friction_map.hpp"
#include "published/phase/planarity.hpp"
#include "published/phase/resonance.hpp"
#include "published/phase/scaling.hpp"

namespace dampline::app {

/// The friction of the phase-mapping literature: H1 = 1, y_c = 0.5, m = 1, r = y.
inline constexpr double kStudyReversalM = 0.5;

/// Amplitudes of a sweep over the rate of the drive.
struct AmplitudeSweep {
  std::vector<double> rate_rad_s;
  std::vector<double> amplitude_m;
  /// The rate of the largest amplitude; at an end of the sweep it is no resonance.
  [[nodiscard]] std::size_t largest() const;
  [[nodiscard]] bool has_peak_inside() const;
};
struct SweepBand {
  double low_rad_s{0.1};
  double high_rad_s{1.5};
  int count{29};
  int settle_periods{40};
  int steps_per_period{400};
};
[[nodiscard]] AmplitudeSweep sweep_amplitude(const sim::OscillatorLaw& law, double swing_mps2,
                                             const SweepBand& band);

/// The viscous oscillator's resonance, c = 1, k = m = 1: theory sqrt(1 - c^2 / 2).
[[nodiscard]] Resonance viscous_resonance();

/// Planarity of random regimes whose drive's mean and amplitude are not known, eight phases.
[[nodiscard]] PlanarityVerdict study_planarity(const sim::OscillatorLaw& law, double noise,
                                               std::uint64_t seed);
/// Rms distance from a plane over rms a, at one phase alone and at eight, the drive known.
struct PlanarityIndices {
  double one_phase{0.0};
  double all_phases{0.0};
};
[[nodiscard]] PlanarityIndices study_indices(const sim::OscillatorLaw& law, double noise,
                                             std::uint64_t seed);

/// Steady responses at two amplitudes of the drive, 1.5 and 3, eight phases, 50 periods each.
[[nodiscard]] ScalingVerdict study_scaling(const sim::OscillatorLaw& law, double noise,
                                           std::uint64_t seed);

inline constexpr int kStudyNodes = 33;
/// g(y), r(y) and the law's parameters from sections of the structural oscillator.
struct FrictionStudy {
  double friction_error{0.0};   ///< root of summed squares over that of the true g, at the nodes
  double restoring_error{0.0};  ///< the same of r
  int friction_inside{0};       ///< nodes whose g is within two stated deviations
  int nodes{0};                 ///< resolved
  std::uint64_t points{0};      ///< that moved
  std::uint64_t stuck{0};       ///< left out as too slow
  FrictionLaw law;
  FrictionCurve<kStudyNodes> curve;
  [[nodiscard]] double stuck_share() const {
    return static_cast<double>(stuck) / static_cast<double>(points + stuck);
  }
};
/// `phases`: flashes used of the eight; with two, those at which the drive's swing vanishes, so
/// that only its mean has to be known.
[[nodiscard]] FrictionStudy study_friction(double noise, std::uint64_t seed, int phases = 8);

/// g(y) under the inputs of the publication, P0 + P1 sin(omega t) in every combination of the
/// values. `start_spread`: deflection and velocity at each of 24 starts are drawn from +- this; 0:
/// each regime goes on from where the one before left it, the first from rest.
struct PublishedInputs {
  std::vector<double> rates_rad_s, swings_mps2, means_mps2;
};
[[nodiscard]] FrictionStudy study_published_inputs(const PublishedInputs& inputs,
                                                   double start_spread, double noise,
                                                   std::uint64_t seed);

}  // namespace dampline::app
