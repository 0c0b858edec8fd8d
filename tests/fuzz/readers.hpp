// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <span>
#include <string_view>

namespace dampline::fuzz {

using Bytes = std::span<const std::uint8_t>;

/// A reader of what comes from outside, given bytes that may be anything. It may refuse them, by a
/// failure or by RunError and UsageError; whatever else happens is a fault.
struct Reader {
  std::string_view name;  ///< of its corpus, tests/fuzz/corpus/NAME
  void (*read)(Bytes bytes);
};

/// Every one there is.
[[nodiscard]] std::span<const Reader> readers();

}  // namespace dampline::fuzz
