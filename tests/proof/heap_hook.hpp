// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline::proof {

/// While one is alive, calls of this thread to the heap are counted. The program that links this
/// file takes malloc() and its kin from it, and through them operator new. They still work.
class HeapWatch {
 public:
  HeapWatch() noexcept;
  ~HeapWatch();
  HeapWatch(const HeapWatch&) = delete;
  HeapWatch& operator=(const HeapWatch&) = delete;
  HeapWatch(HeapWatch&&) = delete;
  HeapWatch& operator=(HeapWatch&&) = delete;

  /// Allocations, reallocations and releases since construction.
  [[nodiscard]] static std::uint64_t calls() noexcept;
};

}  // namespace dampline::proof
