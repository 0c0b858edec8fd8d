// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline {

/// One instant of the truck: relative deflection y = 2 z_b - (z_1 + z_2), its rate v, and the
/// accelerations of the same instant. Known some seconds after the sample. Deflection and velocity
/// are without drift and therefore without mean; accelerations are as measured.
struct Motion {
  std::int64_t tick{0};  ///< the sample that this is the motion of
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double frame_mps2{0.0};     ///< z_b''
  double relative_mps2{0.0};  ///< y'' = 2 z_b'' - z_1'' - z_2''
  bool still{false};          ///< a standstill: the wheelsets or the suspension do not move

  /// eta = -(z_1'' + z_2''), what drives the truck in y'' + beta y + alpha(v) = eta, with
  /// alpha(v) + beta y = -2 z_b''.
  [[nodiscard]] double input_mps2() const noexcept { return relative_mps2 - 2.0 * frame_mps2; }
};

}  // namespace dampline
