// SPDX-License-Identifier: MIT
#pragma once
#include <linux/can.h>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dampline::drivers {

/// Whose frames are wanted.
struct Identifier {
  std::uint32_t id{0};
  bool extended{false};  ///< 29 bits
};

/// The kernel takes no more filters than this (CAN_RAW_FILTER_MAX).
inline constexpr std::size_t kMostFilters = 512;

/// Filters that let exactly the data frames of these identifiers through: the mask holds the flags
/// too, so that neither a remote request nor the other frame format of the same number passes.
/// Sorted, each once.
[[nodiscard]] std::vector<can_filter> make_filters(std::span<const Identifier> identifiers);

}  // namespace dampline::drivers
