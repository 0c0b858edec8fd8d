// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "dampline/sample/signal.hpp"
#include "dampline/sample/ticks.hpp"

namespace dampline {

/// Where one acceleration channel is found among the frames.
struct ChannelConfig {
  std::uint32_t id{0};
  bool extended{false};
  std::int8_t interface_index{-1};  ///< -1: any
  SignalLayout accel{};             ///< physical unit m/s^2
  bool has_counter{false};          ///< false: samples are numbered by their time
  SignalLayout counter{};           ///< counts the channel's samples, any length, wraps to 0
  bool multiplexed{false};          ///< true: only frames whose multiplexor has this value
  SignalLayout multiplexor{};
  std::uint64_t multiplexor_value{0};
};

/// Raw codes at which a channel stands at full scale: at or beyond either of them it may have
/// clipped.
struct FullScale {
  std::int64_t low{std::numeric_limits<std::int64_t>::min()};
  std::int64_t high{std::numeric_limits<std::int64_t>::max()};
  [[nodiscard]] constexpr bool reached(std::int64_t raw) const noexcept {
    return raw <= low || raw >= high;
  }
};

/// First and last code of the bit length, or the codes of the stated [minimum|maximum] where those
/// lie inside it. A stated limit within a quarter of a step of a code means that code.
/// Precondition: is_valid(signal) and at most 53 bits, so that codes are exact in a double.
[[nodiscard]] inline FullScale full_scale_of(const SignalLayout& signal) noexcept {
  const auto span = std::int64_t{1} << (signal.is_signed ? signal.length - 1 : signal.length);
  FullScale codes{signal.is_signed ? -span : 0, span - 1};
  if (!(signal.minimum < signal.maximum)) return codes;
  double low = (signal.minimum - signal.offset) / signal.scale;
  double high = (signal.maximum - signal.offset) / signal.scale;
  if (low > high) std::swap(low, high);
  low = std::floor(low + 0.25);
  high = std::ceil(high - 0.25);
  if (low > static_cast<double>(codes.low)) codes.low = static_cast<std::int64_t>(low);
  if (high < static_cast<double>(codes.high)) codes.high = static_cast<std::int64_t>(high);
  return codes;
}

/// False where the assembler could not use the channel.
[[nodiscard]] constexpr bool is_valid(const ChannelConfig& channel) noexcept {
  const std::uint32_t id_limit = channel.extended ? 0x1FFFFFFFU : 0x7FFU;
  if (channel.id > id_limit || !is_valid(channel.accel) || channel.accel.length > 53) return false;
  if (channel.has_counter && !is_valid(channel.counter)) return false;
  return !channel.multiplexed || is_valid(channel.multiplexor);
}

/// What happened to the frames of one channel. Monotone.
struct ChannelCounts {
  std::uint64_t readings{0};      ///< decoded and numbered
  std::uint64_t gaps{0};          ///< jumps of the channel's own sequence
  std::uint64_t lost{0};          ///< ticks jumped over; those that came after all are in late
  std::uint64_t late{0};          ///< out of order; used when the instant was still open
  std::uint64_t too_late{0};      ///< of the late: not a reading any more
  std::uint64_t repeated{0};      ///< the same counter (or instant) once more; ignored
  std::uint64_t out_of_step{0};   ///< counter contradicts time; ignored
  std::uint64_t realigned{0};     ///< node restarted its counter
  std::uint64_t misjudged{0};     ///< of the repeated and too late: a restarted node's first frames
  std::uint64_t paused{0};        ///< ticks of long pauses, by time; not among the lost
  std::uint64_t saturated{0};     ///< at full scale
  std::uint64_t wrong_length{0};  ///< too short for the signals; ignored
  std::uint64_t not_data{0};      ///< remote frames with this identifier; ignored
  std::uint64_t other_page{0};    ///< the multiplexor selects other signals; ignored
};

/// One acceleration channel: recognises its frames, decodes and numbers them, and keeps the newest
/// kKept readings by tick. Ticks are the lane's own; the assembler aligns lanes.
class ChannelLane {
 public:
  static constexpr std::int64_t kKept = 64;

  /// Precondition: is_valid(config).
  ChannelLane(const ChannelConfig& config, double rate_hz) noexcept;

  [[nodiscard]] bool wants(const CanFrame& frame) const noexcept {
    return frame.id == config_.id && frame.extended == config_.extended &&
           (config_.interface_index < 0 ||
            int{config_.interface_index} == int{frame.interface_index});
  }
  /// Precondition: wants(frame).
  void push(const CanFrame& frame) noexcept;
  /// push() where the frame is the next one by its counter, and in time; else false, and nothing is
  /// done.
  [[nodiscard]] bool push_next(const CanFrame& frame) noexcept;
  void flush() noexcept;
  /// Forgets readings and sequence, keeps the counts. The next frame gets first_tick.
  void restart(std::int64_t first_tick) noexcept;

  [[nodiscard]] const Reading* find(std::int64_t tick) const noexcept {
    const Reading& reading = kept_[slot_of(tick)];
    return reading.tick == tick ? &reading : nullptr;
  }
  [[nodiscard]] bool started() const noexcept { return since_start_ > 0; }
  [[nodiscard]] std::uint64_t since_start() const noexcept { return since_start_; }
  [[nodiscard]] std::int64_t oldest() const noexcept;
  [[nodiscard]] std::int64_t newest() const noexcept { return newest_; }
  /// Since the start, or the restart.
  [[nodiscard]] std::int64_t first() const noexcept { return first_tick_; }
  [[nodiscard]] const TickLine& line() const noexcept {
    return config_.has_counter ? by_counter_.line() : by_time_.line();
  }
  [[nodiscard]] bool is_bursty() const noexcept {
    return config_.has_counter && by_counter_.is_bursty();
  }
  /// Time and counters do not tell where the newest frames belong: to be restarted, with the
  /// others.
  [[nodiscard]] bool has_lost_track() const noexcept { return lost_track_; }
  /// It can be aligned by its bursts.
  [[nodiscard]] bool has_whole_end() const noexcept {
    return !config_.has_counter || by_counter_.has_whole_end();
  }
  /// When the newest reading would have come at the earliest, by all since the start. Frames may be
  /// late, not early: of a burst the last one is in time. Precondition: not aligned() yet.
  [[nodiscard]] std::int64_t earliest_ns() const noexcept;
  void aligned() noexcept { counting_ = config_.has_counter && !config_.multiplexed; }
  [[nodiscard]] const ChannelCounts& counts() const noexcept { return counts_; }

 private:
  static constexpr std::size_t slot_of(std::int64_t tick) noexcept {
    return static_cast<std::size_t>(static_cast<std::uint64_t>(tick) %
                                    static_cast<std::uint64_t>(kKept));
  }
  void forget() noexcept;
  [[nodiscard]] bool decode(const CanFrame& frame, Reading& reading,
                            std::uint64_t& counter) noexcept;
  void number_by_counter(Reading reading, std::uint64_t counter) noexcept;
  void number_by_time(const Reading& reading) noexcept;
  void take_released() noexcept;
  void store_next(const Reading& reading) noexcept;
  void store_late(const Reading& reading) noexcept;
  [[nodiscard]] double expected_ns(std::int64_t tick) const noexcept;  ///< after the first one

  ChannelConfig config_;
  SignalReader accel_;
  SignalReader counter_;
  SignalReader multiplexor_;
  FullScale full_scale_;
  int needed_;            // payload bytes
  bool counting_{false};  // aligned, by a counter, and every frame has the signals
  double rate_hz_;
  CounterSequence by_counter_;
  TimeSequence by_time_;
  std::array<Reading, kKept> kept_{};
  std::int64_t first_tick_{0};
  std::int64_t first_ns_{0};
  double earliest_ns_{0.0};  // of those before the alignment, to what is expected
  std::int64_t newest_{0};
  std::uint64_t since_start_{0};
  bool lost_track_{false};
  std::uint64_t suspects_{0};  // not used, and perhaps a restarted node's first frames
  ChannelCounts counts_;
};

}  // namespace dampline
