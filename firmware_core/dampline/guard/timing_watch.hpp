// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "dampline/guard/block_series.hpp"
#include "dampline/guard/block_survey.hpp"
#include "dampline/guard/config.hpp"
#include "dampline/guard/fault_log.hpp"

namespace dampline {

/// Delays between channels, block by block. Between the wheelsets it changes with speed, and when
/// one of their channels is out of step; the frame tells these apart. Its lag behind the wheelsets'
/// mean stays when the speed changes; its lag behind wheelset 1 stays when wheelset 2 is out of
/// step, and the other way round. A change of lag without one of delay is the frame's.
class TimingWatch {
 public:
  explicit TimingWatch(double sample_rate_hz) noexcept : rate_hz_{sample_rate_hz} {}

  /// A segment's delay between the wheelsets, to tell sudden from gradual.
  void add_segment(std::int64_t tick, double delay_s) noexcept;
  /// True where the car has another speed than in the blocks before, and they are forgotten.
  bool add_block(const BlockFigures& block, bool has_delay, GuardInputs& inputs) noexcept;
  /// Looks for changes; reports each once, a drift again and again with its newest size.
  void judge(FaultLog& log, GuardInputs& inputs) noexcept;
  /// A segment's delays between the wheelsets were no good from this tick on.
  void discard_segments(std::int64_t tick) noexcept;
  /// Wheelset 2 moved against wheelset 1 within a few samples, at this tick; -1: never.
  void set_jump(std::int64_t tick) noexcept { jump_tick_ = tick; }
  /// The delays start again from nothing.
  void restart() noexcept;
  /// Median of the newest six blocks; 0 where there are fewer than three.
  [[nodiscard]] double delay_s() const noexcept;

 private:
  static constexpr std::size_t kSegments = 768;
  struct Segment {
    std::int64_t tick{0};
    double delay_s{0.0};
  };
  enum class Cause : std::uint8_t { kUnknown, kSpeed, kWheelset1, kWheelset2 };
  [[nodiscard]] static Cause cause_of(double delay_s, const std::array<double, 3>& lag_s,
                                      bool may_stay) noexcept;
  [[nodiscard]] bool is_other_speed(double delay_s) const noexcept;
  [[nodiscard]] bool jumped(std::int64_t tick) const noexcept;
  [[nodiscard]] bool judge_wheelsets(FaultLog& log, GuardInputs& inputs) noexcept;
  void count_speed_change(std::int64_t tick, GuardInputs& inputs) noexcept;
  void judge_frame(FaultLog& log) noexcept;
  void forget_before(std::int64_t tick) noexcept;
  [[nodiscard]] bool sudden(std::int64_t tick, double size_s) const noexcept;
  [[nodiscard]] double slope(const BlockSeries& series) const noexcept;  // s/s
  void report_step(FaultLog& log, FaultChannel channel, std::int64_t tick, double size_s,
                   double whole_tolerance) const noexcept;

  double rate_hz_;
  BlockSeries delay_;
  std::array<BlockSeries, 3> lag_{};  // of the frame, behind mean, wheelset 1, wheelset 2
  double newest_delay_s_{0.0};        // of the blocks that are compared; 0: not known yet
  std::array<Segment, kSegments> segments_{};
  std::size_t segment_count_{0};  // since the restart; the ring holds the newest
  std::int64_t last_speed_change_{-1};
  std::int64_t jump_tick_{-1};
};

}  // namespace dampline
