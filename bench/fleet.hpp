// SPDX-License-Identifier: MIT
#pragma once
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <vector>

#include "bench/chain.hpp"
#include "bench/peers/rows.hpp"
#include "bench/ride.hpp"

namespace dampline::bench {

/// Large objects of one kind beside each other, in pages of 2 MiB where the system gives them, so
/// that a sample of any of them finds its addresses translated; else in ordinary pages.
template <class T>
class LargeArray {
 public:
  /// make(place, i) constructs number i at `place`. Throws std::bad_alloc where there is no memory.
  template <class Make>
  LargeArray(std::size_t count, Make make) : bytes_{count * sizeof(T) + kPage}, count_{count} {
    memory_ = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (memory_ == MAP_FAILED) throw std::bad_alloc{};
    static_cast<void>(::madvise(memory_, bytes_, MADV_HUGEPAGE));
    void* first = memory_;
    std::size_t space = bytes_;
    first_ = static_cast<T*>(std::align(kPage, count * sizeof(T), first, space));
    for (std::size_t i = 0; i < count; ++i) make(static_cast<void*>(first_ + i), i);
  }
  ~LargeArray() {
    std::destroy_n(first_, count_);
    ::munmap(memory_, bytes_);
  }
  LargeArray(const LargeArray&) = delete;
  LargeArray& operator=(const LargeArray&) = delete;

  [[nodiscard]] T* begin() noexcept { return first_; }
  [[nodiscard]] T* end() noexcept { return first_ + count_; }
  [[nodiscard]] std::size_t size() const noexcept { return count_; }

 private:
  static constexpr std::size_t kPage = std::size_t{2} << 20U;
  std::size_t bytes_;
  std::size_t count_;
  void* memory_{nullptr};
  T* first_{nullptr};
};

/// Misses of the last cache by this thread, where the machine lets a program count them.
class CacheMisses {
 public:
  explicit CacheMisses(std::uint32_t type = PERF_TYPE_HARDWARE,
                       std::uint64_t event = PERF_COUNT_HW_CACHE_MISSES) noexcept {
    perf_event_attr wanted{};
    wanted.type = type;
    wanted.size = sizeof wanted;
    wanted.config = event;
    wanted.disabled = 1;
    wanted.exclude_kernel = 1;
    wanted.exclude_hv = 1;
    counter_ = static_cast<int>(::syscall(SYS_perf_event_open, &wanted, 0, -1, -1, 0));
  }
  ~CacheMisses() {
    if (counter_ >= 0) ::close(counter_);
  }
  CacheMisses(const CacheMisses&) = delete;
  CacheMisses& operator=(const CacheMisses&) = delete;

  void start() const noexcept {
    if (counter_ < 0) return;
    ::ioctl(counter_, PERF_EVENT_IOC_RESET, 0);
    ::ioctl(counter_, PERF_EVENT_IOC_ENABLE, 0);
  }
  /// Since start(); nothing where they cannot be counted.
  [[nodiscard]] std::optional<std::uint64_t> stop() const noexcept {
    std::uint64_t count = 0;
    if (counter_ < 0 || ::ioctl(counter_, PERF_EVENT_IOC_DISABLE, 0) != 0 ||
        ::read(counter_, &count, sizeof count) != static_cast<ssize_t>(sizeof count))
      return std::nullopt;
    return count;
  }

 private:
  int counter_{-1};
};

/// Of one truck and sample.
struct TruckCost {
  double ns;
  std::optional<double> cache_misses;  ///< none where the machine does not count them
};

/// Trucks of one process, frames to estimate. A truck takes a batch of samples, then the next truck
/// its own: 1 as if every sample were handed on at once, 32 as a logger that sends every 0.1 s.
class Fleet {
 public:
  using Truck = Chain<kFramesToEstimate>;
  static constexpr std::size_t kLongestBatch = 32;

  explicit Fleet(std::size_t trucks)
      : trucks_{trucks, [](void* place, std::size_t) { new (place) Truck; }} {
    // Past the 3.9 s after which every scale makes rows.
    for (int i = 0; i < 50; ++i) feed_all(kLongestBatch);
  }

  /// At least a whole block of every truck.
  [[nodiscard]] TruckCost cost(std::size_t batch) {
    const std::size_t samples = std::max<std::size_t>(608, 1'000'000 / trucks_.size() / 32 * 32);
    const CacheMisses counter;
    counter.start();
    const double start_ns = thread_time_ns();
    for (std::size_t i = 0; i < samples; i += batch) feed_all(batch);
    const double all = static_cast<double>(samples) * static_cast<double>(trucks_.size());
    TruckCost out{(thread_time_ns() - start_ns) / all, std::nullopt};
    if (const auto misses = counter.stop()) out.cache_misses = static_cast<double>(*misses) / all;
    return out;
  }

 private:
  void feed_all(std::size_t batch) noexcept {
    const auto frames = std::span{frames_}.first(batch);
    for (auto& instant : frames) instant = feed_.next();
    for (Truck& truck : trucks_)
      for (const auto& instant : frames) truck.push(instant);
  }

  LargeArray<Truck> trucks_;
  FrameFeed feed_;
  std::array<std::array<CanFrame, kChannels>, kLongestBatch> frames_{};
};

}  // namespace dampline::bench
