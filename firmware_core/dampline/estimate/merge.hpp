// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/estimate/statistics.hpp"
#include "dampline/result.hpp"

namespace dampline {

/// into += from: information, rows, blocks and counts add. Entries are kept side by side, and
/// joined two by two where there are more than fit. Returns the blocks in the total; kMismatch, and
/// nothing changed, when the two do not have the same basis.
[[nodiscard]] Result<std::uint32_t> merge(Statistics& into, const Statistics& from) noexcept;

}  // namespace dampline
