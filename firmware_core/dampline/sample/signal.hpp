// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline {

enum class ByteOrder : std::uint8_t { kIntel, kMotorola };

/// Where a signal lies in a frame, in the terms of a DBC file:
/// SG_ NAME : start_bit|length@order sign (scale,offset) [minimum|maximum] "unit".
struct SignalLayout {
  std::uint16_t start_bit{0};  ///< Intel: least significant bit; Motorola: most significant bit
  std::uint8_t length{0};      ///< bits, 1...64
  ByteOrder order{ByteOrder::kIntel};
  bool is_signed{false};
  double scale{1.0};
  double offset{0.0};
  double minimum{0.0};  ///< physical; minimum == maximum means "not stated"
  double maximum{0.0};
};

}  // namespace dampline
