// SPDX-License-Identifier: MIT
#pragma once
#include <atomic>
#include <cstdint>

#include "app/live/handover.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/motion/motion.hpp"
#include "dampline/sample.hpp"

namespace dampline::app {

/// The motion on its way from the acquisition to the server's thread. All memory is the
/// constructor's; what finds no room is counted and goes.
class MotionTap {
 public:
  static constexpr std::size_t kRoom = 32768;  // 109 s at 300 Hz

  // The acquisition's side: each sample that was judged.
  void take(const Sample& sample, const UpdateResult& result) noexcept {
    if (first_tick_.load(std::memory_order_relaxed) == kNone)
      first_tick_.store(sample.tick, std::memory_order_release);
    if (result.block_closed && is_usable(result.block.status))
      blocks_.fetch_add(1, std::memory_order_release);
    if (result.has_motion && !ring_.push(result.motion))
      lost_.fetch_add(1, std::memory_order_release);
  }
  // The server's side.
  [[nodiscard]] bool pop(Motion& motion) noexcept { return ring_.pop(motion); }
  // Anybody's.
  [[nodiscard]] std::uint64_t lost() const noexcept {
    return lost_.load(std::memory_order_acquire);
  }
  /// Blocks of 2 s that an estimate is made of.
  [[nodiscard]] std::uint64_t blocks() const noexcept {
    return blocks_.load(std::memory_order_acquire);
  }
  /// Of the record; once a motion was popped it is known.
  [[nodiscard]] std::int64_t first_tick() const noexcept {
    return first_tick_.load(std::memory_order_acquire);
  }

 private:
  static constexpr std::int64_t kNone = INT64_MIN;
  static constexpr bool is_usable(BlockStatus status) noexcept {
    return status == BlockStatus::kUsed || status == BlockStatus::kPartial;
  }
  SpscRing<Motion> ring_{kRoom};
  std::atomic<std::uint64_t> lost_{0};
  std::atomic<std::uint64_t> blocks_{0};
  std::atomic<std::int64_t> first_tick_{kNone};
};

}  // namespace dampline::app
