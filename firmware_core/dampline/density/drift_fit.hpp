// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>

#include "dampline/snapshot.hpp"

namespace dampline {

/// Moments of one bin of velocity. u runs from 0 at the bin's end nearer to zero to 1 at the other.
struct DriftMoments {
  double n{0.0}, u{0.0}, uu{0.0};  ///< sums of 1, u, u^2
  double y{0.0}, uy{0.0};          ///< of y, u y; m
  double a{0.0}, ua{0.0};          ///< of z_b'', u z_b''; m/s^2
  void add(const DriftMoments& other, double factor) noexcept;
  void add(const DriftMoments& other) noexcept {
    n += other.n;
    u += other.u;
    uu += other.uu;
    y += other.y;
    uy += other.uy;
    a += other.a;
    ua += other.ua;
  }
};

/// The bins: on either side of zero half the curve's first segment, its other half, and the
/// curve's further segments, the last without end.
class DriftBins {
 public:
  static constexpr std::size_t kPerSide = kCurveSegments + 1;

  explicit DriftBins(const std::array<double, kCurveSegments>& curve_nodes_mps) noexcept;

  /// Left ends in |v|, m/s, and the end of the last curve segment.
  [[nodiscard]] const std::array<double, kPerSide + 1>& nodes_mps() const noexcept {
    return nodes_;
  }
  [[nodiscard]] std::size_t locate(double speed_mps) const noexcept {
    std::size_t bin = 0;
    for (std::size_t i = 1; i < kPerSide; ++i) bin += speed_mps >= nodes_[i] ? 1U : 0U;
    return bin;
  }
  [[nodiscard]] double place(std::size_t bin, double speed_mps) const noexcept {
    return (speed_mps - nodes_[bin]) * per_width_[bin];
  }

 private:
  std::array<double, kPerSide + 1> nodes_{};
  std::array<double, kPerSide> per_width_{};
};

/// What one instant adds, and where.
struct DriftPoint {
  std::size_t side{0};
  std::size_t bin{0};
  DriftMoments moments;
};

/// Of finite numbers.
[[nodiscard]] inline DriftPoint drift_point(const DriftBins& bins, double velocity_mps,
                                            double deflection_m, double frame_mps2,
                                            double weight) noexcept {
  const double speed_mps = std::abs(velocity_mps);
  const std::size_t bin = bins.locate(speed_mps);
  const double u = bins.place(bin, speed_mps);
  const double wu = weight * u;
  return {.side = velocity_mps < 0.0 ? std::size_t{0} : std::size_t{1},
          .bin = bin,
          .moments = {.n = weight,
                      .u = wu,
                      .uu = wu * u,
                      .y = weight * deflection_m,
                      .uy = wu * deflection_m,
                      .a = weight * frame_mps2,
                      .ua = wu * frame_mps2}};
}

/// Everything that the weak form and the known-input form need of a stretch of motion. Sums add.
struct DriftSums {
  /// [0]: v < 0, [1]: v >= 0.
  std::array<std::array<DriftMoments, DriftBins::kPerSide>, 2> sides{};

  void take(const DriftPoint& point) noexcept { sides[point.side][point.bin].add(point.moments); }
  void add(const DriftSums& other, double factor) noexcept;
  void scale(double factor) noexcept;
  [[nodiscard]] double count() const noexcept;
};

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
