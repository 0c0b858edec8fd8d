// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

#include "sim_hw/noise.hpp"
#include "sim_hw/track.hpp"

namespace dampline::sim {

/// Impacts. Joints and flats move the wheelsets, so their sensors measure them; shocks act on the
/// frame and no sensor measures them. A depth or force of 0 switches a kind off.
struct ImpulseEffects {
  double joint_depth_m{0.0};  ///< dips of the rail, under both wheelsets
  double joint_length_m{0.3};
  double joint_spacing_m{25.0};
  double flat_depth_m{0.0};  ///< once per turn of wheelset 1
  double flat_length_m{0.1};
  double wheel_circumference_m{2.89};
  double shock_force_n{0.0};  ///< peak of a half sine on the frame, either sign
  double shock_rate_hz{0.2};  ///< mean rate of shocks, at random times
  double shock_duration_s{0.02};
};

/// A dip -depth sin^4(pi x / length) at every multiple of the spacing; curvature is continuous.
[[nodiscard]] TrackPoint dip(double position_m, double depth_m, double length_m,
                             double spacing_m) noexcept;

/// Shocks at random times; asked for times that never go back.
class Shocks {
 public:
  Shocks(const ImpulseEffects& config, std::uint64_t seed);
  [[nodiscard]] double force_n(double time_s) noexcept;

 private:
  void draw(double after_s) noexcept;
  double peak_n_;
  double rate_hz_;
  double duration_s_;
  Random random_;
  double start_s_{0.0};
  double sign_{1.0};
};

}  // namespace dampline::sim
