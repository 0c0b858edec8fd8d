// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

namespace dampline::app {

/// Room for `count` elements whose pages are already mapped: filling it later neither allocates nor
/// faults.
template <class T>
void reserve_touched(std::vector<T>& vector, std::size_t count) {
  vector.resize(count);
  vector.clear();
}

}  // namespace dampline::app
