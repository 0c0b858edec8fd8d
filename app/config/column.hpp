// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace dampline::app {

/// The columns of a CSV record that the program understands.
enum class Column : std::uint8_t {
  kTime,
  kFrameAccel,
  kWheelset1Accel,
  kWheelset2Accel,
  kDeflection,
  kVelocity,
  kForce,
  kAccel,  ///< second derivative of the deflection, measured beside it
};
inline constexpr std::size_t kColumns = 8;

/// Canonical header names, indexed by Column.
inline constexpr std::array<std::string_view, kColumns> kColumnNames{"time_s",
                                                                     "frame_accel_mps2",
                                                                     "wheelset1_accel_mps2",
                                                                     "wheelset2_accel_mps2",
                                                                     "deflection_m",
                                                                     "velocity_mps",
                                                                     "force_n",
                                                                     "accel_mps2"};

[[nodiscard]] constexpr std::size_t index(Column column) noexcept {
  return static_cast<std::size_t>(column);
}
[[nodiscard]] constexpr std::string_view name(Column column) noexcept {
  return kColumnNames[index(column)];
}

}  // namespace dampline::app
