// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "dampline/can_frame.hpp"

namespace dampline::drivers {

/// Longest part of an object that is looked at.
inline constexpr std::size_t kBlfObjectHead = 192;
inline constexpr std::size_t kBlfBaseHeader = 16;
inline constexpr std::size_t kBlfContainerHeader = 32;
inline constexpr std::uint32_t kBlfContainer = 10;

struct BlfBase {
  std::uint32_t size{0};  ///< with this header
  std::uint32_t type{0};
};
/// Nothing: these bytes are no object. Precondition: kBlfBaseHeader bytes.
[[nodiscard]] std::optional<BlfBase> read_blf_base(std::span<const char> bytes) noexcept;

enum class BlfKind : std::uint8_t { kFrame, kOther, kBad };
/// A frame out of the beginning of an object, at most kBlfObjectHead bytes of it, with its time
/// from the measurement's begin; kOther: the object is no frame; kBad: it is too short for its
/// type.
[[nodiscard]] BlfKind read_blf_object(std::span<const char> object, CanFrame& frame,
                                      std::uint32_t& channel) noexcept;

/// SYSTEMTIME as ns since 1970 in the zone that it was written in; 0: it is none.
[[nodiscard]] std::int64_t read_system_time(std::span<const char> bytes) noexcept;

}  // namespace dampline::drivers
