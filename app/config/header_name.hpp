// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace dampline::app {

/// What a column of a rig measures.
enum class Quantity : std::uint8_t { kTime, kDeflection, kVelocity, kForce, kAccel };

/// What somebody's header says of a column: "Displacement [mm]", "Load (kN)", "Weg in mm", "x_mm".
struct HeaderName {
  std::optional<Quantity> quantity;  ///< by the words in the name; none for commands and models
  std::string unit;                  ///< as it is written; empty: none is there
  std::optional<double> factor;      ///< to the canonical unit; none where the unit is not known
};
[[nodiscard]] HeaderName read_header_name(std::string_view cell);

/// From a unit to the canonical one of a quantity: s, m, m/s, N, m/s^2. None: it is not known.
[[nodiscard]] std::optional<double> unit_factor(Quantity quantity, std::string_view unit);

}  // namespace dampline::app
