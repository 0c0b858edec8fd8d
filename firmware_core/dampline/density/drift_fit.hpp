// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/density/drift_sums.hpp"

namespace dampline {

/// y'' + beta y + alpha(v) = eta with alpha = 2 F / M, beta = 2 k / M. alpha as a broken line over
/// the curve's nodes with a jump at zero, and as level sign(v) + offset.
struct DriftFit {
  bool ok{false};
  double level_mps2{0.0};
  double offset_mps2{0.0};
  std::size_t segments{0};  ///< that the data reach; the last goes on without end
  /// [side][node], node 0 at zero; [0]: v < 0. m/s^2.
  std::array<std::array<double, kCurveSegments + 1>, 2> alpha_mps2{};
};

/// Segments that the samples of both sides reach, without a hole; 0: not even the first two.
[[nodiscard]] std::size_t supported_segments(const DriftSums& sums) noexcept;

/// Weak form of the stationary Fokker-Planck equation: for continuous g
///   E[g(v) alpha(v)] = -beta E[g(v) y] + (D / 2) E[g'(v)].
/// Needs a white input of two-sided level D, (m/s^2)^2 / Hz; no derivative of a density, and no
/// independence of y and v. The test functions g are the hats over the bins' nodes, weighted by the
/// inverse of E[g g'], the covariance of what white noise leaves in the equations.
///
/// What 300 s of white noise leave at a node is some 9 % of the level. So the curve, not the level,
/// knows that friction bends little: each node is a tenth of the level, one standard deviation,
/// from the line through its neighbours. A straight line costs nothing. The sums hold samples at
/// `sample_rate_hz`.
[[nodiscard]] DriftFit fit_weak_form(const DriftSums& sums, const DriftBins& bins, double beta,
                                     double input_level, double sample_rate_hz,
                                     std::size_t segments) noexcept;

/// Known input: alpha(v) = -E[2 z_b'' + beta y | v], needing nothing of the input. Velocities below
/// half the first segment are left out, where an error of v turns the sign; those of the whole
/// first segment are left out of the level.
[[nodiscard]] DriftFit fit_known_input(const DriftSums& sums, const DriftBins& bins, double beta,
                                       std::size_t segments) noexcept;

}  // namespace dampline
