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

}  // namespace dampline
