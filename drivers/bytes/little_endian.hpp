// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace dampline::drivers {

/// A number as little-endian files have it; integers and IEEE floating point. Precondition: its
/// bytes are there.
template <class T>
[[nodiscard]] T little(const char* at) noexcept {
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__);
  T out{};
  std::memcpy(&out, at, sizeof out);
  return out;
}

}  // namespace dampline::drivers
