// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <atomic>
#include <cstdint>

namespace dampline::app {

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

}  // namespace dampline::app
