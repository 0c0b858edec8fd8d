// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>

#include "dampline/density/histogram.hpp"
#include "dampline/density/input_statistics.hpp"

namespace dampline {

/// The estimator of Kisilowski and Urbanski (1987): p(y, v) = p1(y) p2(v), alpha(v) a broken line
/// of k = 20 segments, 10 a side, with a jump at zero, and the stationary Fokker-Planck equation
///   -v p1' p2 + beta y p1 p2' + (alpha p2)' p1 + psi(y)^2 p1 p2'' / 2 = 0
/// met in the least squares sense. It factors into integrals over y and over v.
inline constexpr std::size_t kPaperSegments = 10;  ///< a side, as published
inline constexpr std::size_t kMostPaperSegments = 20;
inline constexpr std::size_t kVelocityBins = 512;
inline constexpr std::size_t kDeflectionBins = 128;
inline constexpr std::size_t kSampleGroups = 16;
using VelocityHistogram = Histogram<kVelocityBins, kSampleGroups>;
using DeflectionHistogram = Histogram<kDeflectionBins>;

struct PaperFormConfig {
  double beta{0.0};         ///< 2 k / M, 1/s^2
  double input_level{0.0};  ///< mean of psi^2, two-sided, (m/s^2)^2 / Hz
  Modulation::Polynomial modulation{1.0};
  double bandwidth_mps{0.0};  ///< of the Gaussian kernel that smooths p2; at least one bin
  double excluded_mps{0.0};   ///< |v| below this, in whole segments, is left out; 0: the paper
  double reach_mps{0.0};      ///< end of the last segment; 0: where 99 % of the mass lies
  std::size_t segments{kPaperSegments};       ///< a side, 1...kMostPaperSegments
  std::size_t left_out_group{kSampleGroups};  ///< of the samples; kSampleGroups: none
};

/// Integrals over y that the ten products share; each is over p1 dy.
struct DeflectionIntegrals {
  double p1_p1{0.0};       ///< p1^2
  double psi2_p1_p1{0.0};  ///< psi^2 p1^2
  double psi4_p1_p1{0.0};  ///< psi^4 p1^2
  double y_p1_p1{0.0};     ///< y p1^2: 0 for a symmetric density
  double p1_dp1{0.0};      ///< p1 p1': always 0, so that the dynamics of y drop out
};

/// The ten integrals, over all of v that is not excluded. A = psi^2 p2'' / 2, B = p2', C = p2,
/// D = -v p2 p1' / p1, R = beta-less y p2'.
struct PaperIntegrals {
  double aa{0.0}, ab{0.0}, ac{0.0}, bb{0.0}, bc{0.0}, cc{0.0}, bd{0.0}, cd{0.0}, br{0.0}, cr{0.0};
};

struct PaperSegment {
  double from_mps{0.0}, to_mps{0.0};
  double slope_ps{0.0};    ///< of alpha, 1/s
  double alpha_mps2{0.0};  ///< at the end of the segment
};

struct PaperForm {
  bool ok{false};
  std::size_t used{0};  ///< segments a side
  /// [0]: v < 0, from zero outwards; [1]: v > 0.
  std::array<std::array<PaperSegment, kMostPaperSegments>, 2> segments{};
  std::array<double, 2> offset_mps2{};  ///< alpha beside zero
  /// Mean of alpha over what is not excluded, weighted by p2^2 as the equations are.
  std::array<double, 2> mean_mps2{};
  PaperIntegrals integrals{};
  double level_mps2() const noexcept { return 0.5 * (mean_mps2[1] - mean_mps2[0]); }
  double offset() const noexcept { return 0.5 * (mean_mps2[1] + mean_mps2[0]); }
};

[[nodiscard]] DeflectionIntegrals deflection_integrals(
    const DeflectionHistogram& deflections, const Modulation::Polynomial& modulation) noexcept;

/// Some 30,000 exponentials and two systems of 21 equations at most: off the path of a sample.
[[nodiscard]] PaperForm fit_paper_form(const VelocityHistogram& velocities,
                                       const DeflectionIntegrals& deflections,
                                       const PaperFormConfig& config) noexcept;

/// |v| that holds this share of the mass, from the bins.
[[nodiscard]] double speed_quantile(const VelocityHistogram& velocities, double share) noexcept;

}  // namespace dampline
