// SPDX-License-Identifier: MIT
#pragma once
#include <vector>

namespace dampline {

/// from, from + step, ..., not beyond to.
inline std::vector<double> steps(double from, double to, double step) {
  const auto count = static_cast<int>((to - from) / step + 1e-9);
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(count) + 1);
  for (int i = 0; i <= count; ++i) out.push_back(from + step * i);
  return out;
}

}  // namespace dampline
