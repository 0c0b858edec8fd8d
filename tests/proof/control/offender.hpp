// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

namespace dampline::proof {

[[nodiscard]] void* offend(std::size_t bytes);

}  // namespace dampline::proof
