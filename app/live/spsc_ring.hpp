// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <bit>
#include <cstddef>
#include <vector>

namespace dampline::app {

/// Hand-over from one thread to one other without locks. All memory is allocated, and touched, by
/// the constructor; push() and pop() take constant time.
/// Padded on purpose: the two threads share no cache line.
template <class T>
class SpscRing {  // NOLINT(clang-analyzer-optin.performance.Padding)
 public:
  /// Room for at least `least` elements.
  explicit SpscRing(std::size_t least)
      : slots_(std::bit_ceil(least)), mask_{std::bit_ceil(least) - 1} {}

  /// False when the ring is full; nothing is written then. For the producer.
  [[nodiscard]] bool push(const T& value) noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - seen_tail_ > mask_) {
      seen_tail_ = tail_.load(std::memory_order_acquire);
      if (head - seen_tail_ > mask_) return false;
    }
    slots_[head & mask_] = value;
    head_.store(head + 1, std::memory_order_release);
    return true;
  }
  /// False when the ring is empty. For the consumer.
  [[nodiscard]] bool pop(T& value) noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == seen_head_) {
      seen_head_ = head_.load(std::memory_order_acquire);
      if (tail == seen_head_) return false;
    }
    value = slots_[tail & mask_];
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }
  [[nodiscard]] std::size_t capacity() const noexcept { return slots_.size(); }

 private:
  static constexpr std::size_t kCacheLine = 64;  // so that the two sides do not share one
  std::vector<T> slots_;
  std::size_t mask_;
  alignas(kCacheLine) std::atomic<std::size_t> head_{0};
  std::size_t seen_tail_{0};  // the producer's
  alignas(kCacheLine) std::atomic<std::size_t> tail_{0};
  std::size_t seen_head_{0};  // the consumer's
};

}  // namespace dampline::app
