// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/guard/block_series.hpp"
#include "dampline/guard/block_survey.hpp"
#include "dampline/guard/config.hpp"
#include "dampline/guard/fault_log.hpp"
#include "dampline/guard/pair_spectra.hpp"
#include "dampline/guard/place_watch.hpp"
#include "dampline/guard/timing_watch.hpp"

namespace dampline {

/// The guards that live on wheelset 2 seeing the track that wheelset 1 saw, L/V later, and on the
/// frame following both: by blocks of some 10 s.
class SpectralGuard {
 public:
  explicit SpectralGuard(const GuardConfig& config) noexcept;

  void push(std::int64_t tick, const std::array<double, kChannels>& accel_mps2,
            bool made_up) noexcept {
    spectra_.push(tick, accel_mps2, made_up);
  }
  /// A slice of the work that is due; faults go to the log. `inputs.impacts` tells impacts so far.
  void advance(FaultLog& log, GuardInputs& inputs) noexcept;
  /// Robust deviation of the second difference of a channel: white noise shows there, too.
  void set_bridged(const BridgeFigures& figures) noexcept { bridged_ = figures; }
  void set_change_scale(std::size_t channel, double mps2) noexcept { change_mps2_[channel] = mps2; }
  /// What of a channel's fast motion comes in impulses, as white noise of that power.
  void set_impulse_power(std::size_t channel, double power) noexcept {
    impulse_power_[channel] = power;
  }
  /// Root of the median squared difference of the wheelsets side by side: noise is in it all the
  /// time, impacts are not.
  void set_difference(double mps2) noexcept { difference_mps2_ = mps2; }
  /// The wheelsets moved apart at once at this tick; -1: never.
  void set_jump(std::int64_t tick) noexcept { timing_.set_jump(tick); }
  /// A pause or a long gap.
  void restart() noexcept;
  /// True once the delay of wheelset 2 is known, in seconds.
  [[nodiscard]] bool has_delay() const noexcept { return has_delay_; }
  /// The newest block tells the delay.
  [[nodiscard]] bool knows_delay() const noexcept { return usable_; }
  /// The delay is what it was a block before.
  [[nodiscard]] bool steady() const noexcept { return steady_; }
  [[nodiscard]] double delay_s() const noexcept { return delay_s_; }
  /// Of the newest block that was judged.
  [[nodiscard]] const BlockFigures& figures() const noexcept { return survey_.figures(); }
  /// White noise of a channel, rms, what its resolution makes included: median over the newest
  /// blocks. Of the wheelsets the mean of both, or the frame's where they are not side by side.
  [[nodiscard]] double noise_mps2(std::size_t channel) const noexcept;

  [[nodiscard]] FrameFollow frame_follow() const noexcept;
  [[nodiscard]] Misplacement misplacement() const noexcept { return places_.misplacement(); }

 private:
  enum class Test : std::uint8_t { kNone, kOrder, kTiming, kGain, kPlaces, kRate, kNoise, kBurst };

  void take_block(FaultLog& log) noexcept;
  void judge(FaultLog& log, GuardInputs& inputs) noexcept;
  [[nodiscard]] bool in_order(FaultLog& log) noexcept;
  void align() noexcept;
  void judge_gain(FaultLog& log) noexcept;
  void judge_rate(FaultLog& log) noexcept;
  [[nodiscard]] bool is_noisy(const BlockFigures& block) const noexcept;
  void judge_noise(FaultLog& log) noexcept;
  void count_impacts(const GuardInputs& inputs) noexcept;
  void add_noise(BlockSeries& series, double most, double power, std::int64_t tick) const noexcept;
  [[nodiscard]] bool rises_with(double noise, std::size_t which, std::size_t block) const noexcept;
  void judge_burst(FaultLog& log, std::size_t which) noexcept;
  [[nodiscard]] double noise_limit(std::size_t channel) const noexcept;  // density

  GuardConfig config_;
  PairSpectra spectra_;
  BlockSurvey survey_;
  TimingWatch timing_;
  PlaceWatch places_;
  BlockSeries gain_;
  BlockSeries following_;
  std::array<BlockSeries, 2> noise_{};  // of the frame; of both wheelsets together
  BlockSeries white_{};                 // of both wheelsets, without what is folded
  BlockSeries frame_in_band_{};
  std::array<std::int64_t, 2> burst_tick_{-1, -1};
  std::array<BlockSeries, kChannels> level_{};
  std::array<double, kChannels> change_mps2_{};
  std::array<double, kChannels> impulse_power_{};
  double difference_mps2_{0.0};
  Test next_{Test::kNone};
  bool aligned_{false};
  bool usable_{false};  // the block's wheelsets are coherent and stand side by side
  bool has_delay_{false};
  bool steady_{false};
  double delay_s_{0.0};
  int swapped_blocks_{0};
  int reversed_blocks_{0};
  std::array<int, kChannels> inverted_blocks_{};
  int wrong_rate_blocks_{0};
  std::array<std::uint64_t, kChannels> impacts_before_{};
  std::array<bool, kChannels> few_impacts_{};  // in this block
  BridgeFigures bridged_{};
};

}  // namespace dampline
