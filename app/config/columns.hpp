// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
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
  kFrameEndAccel,
  kFarFrameAccel,
};
inline constexpr std::size_t kColumns = 10;

/// Canonical header names, indexed by Column.
inline constexpr std::array<std::string_view, kColumns> kColumnNames{"time_s",
                                                                     "frame_accel_mps2",
                                                                     "wheelset1_accel_mps2",
                                                                     "wheelset2_accel_mps2",
                                                                     "deflection_m",
                                                                     "velocity_mps",
                                                                     "force_n",
                                                                     "accel_mps2",
                                                                     "frame_end_accel_mps2",
                                                                     "far_frame_accel_mps2"};

[[nodiscard]] constexpr std::size_t index(Column column) noexcept {
  return static_cast<std::size_t>(column);
}
[[nodiscard]] constexpr std::string_view name(Column column) noexcept {
  return kColumnNames[index(column)];
}

/// What a column of a rig measures.
enum class Quantity : std::uint8_t { kTime, kDeflection, kVelocity, kForce, kAccel };

/// What somebody's header says of a column: "Displacement [mm]", "Load (kN)", "Weg in mm", "x_mm".
struct HeaderName {
  std::optional<Quantity> quantity;  ///< by the words in the name; none for commands and models
  std::string unit;                  ///< as it is written; empty: none is there
  std::optional<double> factor;      ///< to the canonical unit; none where the unit is not known
};
[[nodiscard]] HeaderName read_header_name(std::string_view cell);

/// Which of a truck's accelerations a header speaks of: "Frame acceleration [g]", "Axle box 2 (g)",
/// "Radsatz 1 [m/s²]". `unit`: where the record says it apart from the name, else empty. None: it
/// is no acceleration, or of neither the frame nor a numbered wheelset.
[[nodiscard]] std::optional<Column> truck_column(std::string_view cell, std::string_view unit);

/// A unit that is known, and not one of this quantity: V, A, %, or mm of a force.
[[nodiscard]] bool is_unit_of_other(Quantity quantity, std::string_view unit);

/// From a unit to the canonical one of a quantity: s, m, m/s, N, m/s^2. None: it is not known.
[[nodiscard]] std::optional<double> unit_factor(Quantity quantity, std::string_view unit);

}  // namespace dampline::app
