// SPDX-License-Identifier: MIT
#pragma once
#include <semaphore.h>

#include <array>
#include <atomic>
#include <bit>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <vector>

#include "dampline/can_frame.hpp"
#include "hal/event.hpp"

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

/// The newest value from one thread for one other: three buffers, of which the writer fills one,
/// the reader holds one, and the third is exchanged. Neither side ever waits.
template <class T>
class Latest {
 public:
  /// The writer's own buffer; fill it, then publish().
  [[nodiscard]] T& back() noexcept { return buffers_[back_]; }
  void publish() noexcept {
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }
  /// True when there was something newer; front() is then that.
  [[nodiscard]] bool take() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) == 0) return false;
    front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    return true;
  }
  [[nodiscard]] const T& front() const noexcept { return buffers_[front_]; }

 private:
  static constexpr std::uint32_t kFresh = 4;
  static constexpr std::uint32_t kIndex = 3;
  std::array<T, 3> buffers_{};
  std::uint32_t back_{0};
  std::uint32_t front_{1};
  std::atomic<std::uint32_t> middle_{2};
};

/// Wakes another thread. Calling never waits. The semaphore of the C library sleeps in the kernel
/// at once; the one of the C++ library first watches the clock for a while, which a real-time
/// system can do without.
class WakeCall {
 public:
  WakeCall() noexcept { ::sem_init(&semaphore_, 0, 0); }
  WakeCall(const WakeCall&) = delete;
  WakeCall& operator=(const WakeCall&) = delete;
  ~WakeCall() { ::sem_destroy(&semaphore_); }

  void call() noexcept { ::sem_post(&semaphore_); }
  /// Until the next call, one that came before included, or the time is over.
  void wait(std::chrono::nanoseconds most) noexcept {
    constexpr long kSecond = 1'000'000'000;
    timespec until{};
    ::clock_gettime(CLOCK_MONOTONIC, &until);
    const auto ns = static_cast<long>(most.count()) + until.tv_nsec;
    until.tv_sec += ns / kSecond;
    until.tv_nsec = ns % kSecond;
    while (::sem_clockwait(&semaphore_, CLOCK_MONOTONIC, &until) != 0 && errno == EINTR) continue;
    while (::sem_trywait(&semaphore_) == 0) continue;  // calls in between are answered as well
  }

 private:
  sem_t semaphore_{};
};

/// What goes from the acquisition to the writer: a frame or an event, in the order in which they
/// happened.
struct RecordItem {
  bool is_event{false};
  CanFrame frame{};
  hal::Event event{};
};

/// The way from the acquisition to the writer, who comes by from time to time and is called when a
/// quarter of the room is taken. push() never waits; it counts what found no room.
class RecordQueue {
 public:
  explicit RecordQueue(std::size_t least) : ring_{least} {}

  // The acquisition's side.
  void push(const RecordItem& item) noexcept {
    if (!ring_.push(item)) lost_.fetch_add(1, std::memory_order_release);
    if (++since_call_ < ring_.capacity() / 4) return;
    since_call_ = 0;
    call_.call();
  }
  // The writer's side.
  [[nodiscard]] bool pop(RecordItem& item) noexcept { return ring_.pop(item); }
  void wait(std::chrono::nanoseconds most) noexcept { call_.wait(most); }
  // Anybody's.
  [[nodiscard]] std::uint64_t lost() const noexcept {
    return lost_.load(std::memory_order_acquire);
  }

 private:
  SpscRing<RecordItem> ring_;
  std::size_t since_call_{0};
  std::atomic<std::uint64_t> lost_{0};
  WakeCall call_;
};

}  // namespace dampline::app
