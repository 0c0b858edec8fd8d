// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "dampline/can_frame.hpp"
#include "dampline/result.hpp"
#include "dampline/sample.hpp"
#include "dampline/sample/channel.hpp"
#include "dampline/sample/ticks.hpp"

namespace dampline {

using ExtraSignals = std::array<std::optional<ChannelConfig>, kExtras>;  ///< by Extra

struct AssemblerConfig {
  std::array<ChannelConfig, kChannels> channels{};  ///< indexed by Channel
  ExtraSignals extras{};                            ///< those that are named belong to every sample
  double sample_rate_hz{300.0};                     ///< nominal, within 10 % (50 % with counters)
  /// So many instants in a row that lack the same channel are handed out, without a number there.
  std::int64_t most_missing{0};
};

/// Monotone.
struct AssemblerCounts {
  std::uint64_t frames{0};       ///< given to push()
  std::uint64_t foreign{0};      ///< other people's: no channel wants the identifier
  std::uint64_t error{0};        ///< error frames
  std::uint64_t samples{0};      ///< complete instants
  std::uint64_t incomplete{0};   ///< instants that lacked a channel
  std::uint64_t completable{0};  ///< readings of those that were handed out all the same
  std::uint64_t restarts{0};     ///< pauses after which all channels were aligned anew
  std::uint64_t overflow{0};     ///< samples lost because pop() was not called
  std::size_t lanes{kChannels};  ///< channels that make a sample: the three, then the extras named
  std::array<ChannelCounts, kChannels + kExtras> channels{};
};

/// CAN frames in, samples out: three channels, and extras where they are named, decoded, numbered
/// and brought together by tick.
///
/// Channels are aligned once by time, to the nearest tick, over the first kAlignFrames of each, and
/// then kept by their counters. Where frames come in bursts the last one of each counts, over
/// kAlignBurst frames and until each channel has shown the end of one, and a node that was off
/// makes all be aligned anew. An instant waits kWaitTicks for its channels, so frames may swap; an
/// instant that lacks a channel is dropped and the tick jumps, unless few are. After a pause of
/// kPauseTicks the channels are aligned anew. The work of one push() is bounded by kLaneSpan steps.
class SampleAssembler {
 public:
  static constexpr std::uint64_t kAlignFrames = 16;
  static constexpr std::uint64_t kAlignBurst = 48;
  static constexpr std::int64_t kWaitTicks = 16;
  static constexpr std::int64_t kPauseTicks = 1024;

  /// kInvalidConfig: a signal lies outside its frame, an identifier or the rate out of range.
  [[nodiscard]] static Result<AssemblerConfig> check(const AssemblerConfig& config) noexcept;
  /// Precondition: check(config).ok().
  explicit SampleAssembler(const AssemblerConfig& config) noexcept;

  /// Takes one frame, whoever sent it. Then pop() until it returns false.
  void push(const CanFrame& frame) noexcept;
  /// True when it wrote a sample. Ticks increase strictly.
  [[nodiscard]] bool pop(Sample& sample) noexcept;
  /// End of the stream: whatever is complete becomes ready.
  void flush() noexcept;

  [[nodiscard]] AssemblerCounts counts() const noexcept;
  /// From the times of the frame channel's samples.
  [[nodiscard]] MeasuredRate measured_rate() const noexcept { return meter_.measured(); }

 private:
  static constexpr std::int64_t kLaneSpan = ChannelLane::kKept;
  static constexpr std::size_t kReady = 128;
  static constexpr std::size_t kMostLanes = kChannels + kExtras;

  using Readings = std::array<const Reading*, kMostLanes>;
  // Count: of lanes, a constant where they are three, for which the loops unroll.
  template <class Count>
  void push_among(Count lanes, const CanFrame& frame) noexcept;
  void push_unusual(ChannelLane& lane, const CanFrame& frame) noexcept;
  void align() noexcept;
  void settle(std::int64_t wait_ticks) noexcept;
  /// The next instant; false where there is no room.
  template <class Count>
  bool write(Count lanes, const Readings& readings, bool lost) noexcept;
  template <class Count>
  void emit(Count lanes, const Readings& readings) noexcept;
  void emit_incomplete(Readings readings, std::size_t channels) noexcept;
  [[nodiscard]] bool is_short_hole(std::size_t channel, std::int64_t tick) const noexcept;
  void restart(std::int64_t time_ns) noexcept;
  [[nodiscard]] std::int64_t tick_before_pause(std::int64_t time_ns) const noexcept;
  [[nodiscard]] const Reading* find(std::size_t channel, std::int64_t tick) const noexcept;
  /// How many channels have the tick; null for the others.
  template <class Count>
  std::size_t find_all(Count lanes, std::int64_t tick, Readings& readings) const noexcept;
  [[nodiscard]] std::int64_t newest() const noexcept;
  /// A channel has nothing yet of the next instant, nor of a later one.
  template <class Count>
  [[nodiscard]] bool waits(Count lanes) const noexcept;
  [[nodiscard]] bool paused(const ChannelLane& lane, std::int64_t time_ns) const noexcept;
  [[nodiscard]] bool ready_to_align(std::uint64_t frames) const noexcept;
  [[nodiscard]] bool have_whole_ends() const noexcept;
  [[nodiscard]] bool is_bursty() const noexcept;
  void find_offsets() noexcept;
  void find_offsets_of_bursts() noexcept;
  void go_on_by_line() noexcept;

  std::int64_t most_missing_;
  double period_ns_;                             // nominal
  std::size_t count_{kChannels};                 // of lanes that are used
  std::array<std::size_t, kExtras> extra_of_{};  // by the lane after the three
  std::array<ChannelLane, kMostLanes> lanes_;
  std::array<std::int64_t, kMostLanes> lane_offset_{};   // lane tick = tick + offset
  std::array<std::int64_t, kMostLanes> before_pause_{};  // newest tick, where there was a pause
  TickLine line_before_pause_;                           // of the first channel
  std::int64_t offset_before_pause_{0};                  // of it
  std::int64_t resume_tick_{0};                          // the next one, before it
  bool aligned_{false};
  bool after_pause_{false};
  std::int64_t next_tick_{0};
  std::array<Sample, kReady> ready_{};
  std::size_t ready_first_{0};
  std::size_t ready_count_{0};
  RateMeter meter_;
  AssemblerCounts counts_;  // of its channels only `paused`; counts() fills in the rest
};

/// Where every frame went: sent = processed + kernel_drops + gaps + excluded, without a rest.
/// What nobody saw follows from the counters within the frames: frames before the first and after
/// the last one that arrived are unknown, and how long a pause of more than kPauseTicks was follows
/// from time. Exact where each channel has a counter and an identifier of its own, and where the
/// kernel drops no other frames than theirs.
struct FrameLedger {
  std::uint64_t sent{0};
  std::uint64_t processed{0};     ///< became part of a sample
  std::uint64_t kernel_drops{0};  ///< arrived, but there was no room
  std::uint64_t gaps{0};          ///< missing from their channel's sequence, for no known reason
  std::uint64_t excluded{0};      ///< arrived and was not used; the sum of those below
  std::uint64_t error{0};
  std::uint64_t foreign{0};
  std::uint64_t repeated{0};
  std::uint64_t too_late{0};
  std::uint64_t out_of_step{0};
  std::uint64_t wrong_length{0};
  std::uint64_t not_data{0};
  std::uint64_t other_page{0};
  std::uint64_t without_partner{0};  ///< another channel's reading of that instant was missing
};

/// Call after flush(): before it, up to four frames of a channel without a counter are undecided.
[[nodiscard]] FrameLedger ledger_of(const AssemblerCounts& counts,
                                    std::uint64_t kernel_drops) noexcept;

}  // namespace dampline
