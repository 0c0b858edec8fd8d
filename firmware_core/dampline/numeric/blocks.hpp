// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>

namespace dampline {

/// Fixed memory for a record of any length: when all entries are in use, neighbours join two by two
/// and each stands for twice the time. join(entry, next) takes the next one in; an odd last entry
/// stays as it is. Returns how many are left.
template <class Entries, class Join>
std::size_t join_neighbours(Entries& entries, std::size_t count, const Join& join) noexcept {
  for (std::size_t i = 0; 2 * i < count; ++i) {
    if (i > 0) entries[i] = entries[2 * i];
    if (2 * i + 1 < count) join(entries[i], entries[2 * i + 1]);
  }
  return (count + 1) / 2;
}

}  // namespace dampline
