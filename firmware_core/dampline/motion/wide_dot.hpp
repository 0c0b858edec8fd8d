// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

namespace dampline {

/// Sum of a[i] b[i]: number i goes to lane i % 8, then the lanes are added, and the last count % 4
/// numbers to that; the same bits on every machine.
[[nodiscard]] double wide_dot(const double* a, const double* b, std::size_t count) noexcept;

}  // namespace dampline
