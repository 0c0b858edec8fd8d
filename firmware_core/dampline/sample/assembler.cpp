// SPDX-License-Identifier: MIT
#include "dampline/sample/assembler.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace dampline {
namespace {

/// As near as 16 bits can.
std::int16_t microseconds(std::int64_t time_ns) noexcept {
  constexpr std::int64_t kMostNs = 32'767'000;
  return static_cast<std::int16_t>(std::clamp(time_ns, -kMostNs, kMostNs) / 1000);
}

}  // namespace

Result<AssemblerConfig> SampleAssembler::check(const AssemblerConfig& config) noexcept {
  if (!(config.sample_rate_hz > 0.0 && config.sample_rate_hz <= 1e6)) return Errc::kInvalidConfig;
  for (const ChannelConfig& channel : config.channels) {
    if (!is_valid(channel)) return Errc::kInvalidConfig;
  }
  for (const std::optional<ChannelConfig>& extra : config.extras) {
    if (extra && !is_valid(*extra)) return Errc::kInvalidConfig;
  }
  return config;
}

SampleAssembler::SampleAssembler(const AssemblerConfig& config) noexcept
    : most_missing_{config.most_missing},
      period_ns_{1e9 / config.sample_rate_hz},
      lanes_{ChannelLane{config.channels[0], config.sample_rate_hz},
             ChannelLane{config.channels[1], config.sample_rate_hz},
             ChannelLane{config.channels[2], config.sample_rate_hz},
             ChannelLane{{}, config.sample_rate_hz}, ChannelLane{{}, config.sample_rate_hz}},
      line_before_pause_{lanes_[0].line()},
      meter_{config.sample_rate_hz} {
  for (std::size_t e = 0; e < kExtras; ++e) {
    if (!config.extras[e]) continue;
    extra_of_[count_ - kChannels] = e;
    lanes_[count_++] = ChannelLane{*config.extras[e], config.sample_rate_hz};
  }
}

template <class Count>
bool SampleAssembler::waits(Count lanes) const noexcept {
  for (std::size_t c = lanes; c-- > 0;)
    if (lanes_[c].newest() - lane_offset_[c] < next_tick_) return true;
  return false;
}

template <class Count>
std::size_t SampleAssembler::find_all(Count lanes, std::int64_t tick,
                                      Readings& readings) const noexcept {
  std::size_t channels = 0;
  for (std::size_t c = 0; c < lanes; ++c) {
    readings[c] = find(c, tick);
    channels += readings[c] != nullptr ? 1U : 0U;
  }
  return channels;
}

template <class Count>
bool SampleAssembler::write(Count lanes, const Readings& readings, bool lost) noexcept {
  if (ready_count_ == kReady) {
    ++counts_.overflow;
    return false;
  }
  Sample& sample = ready_[(ready_first_ + ready_count_++) % kReady];
  sample.tick = next_tick_;
  sample.time_ns = readings[0]->time_ns;
  sample.lost = lost;
  unsigned saturated = 0;
  for (std::size_t c = 0; c < kChannels; ++c) {
    sample.accel_mps2[c] = readings[c]->accel_mps2;
    saturated |= unsigned{readings[c]->saturated} << c;
  }
  for (std::size_t w = 0; w < 2; ++w)
    sample.wheelset_after_us[w] = microseconds(readings[w + 1]->time_ns - sample.time_ns);
  for (std::size_t c = kChannels; c < lanes; ++c) {
    sample.extra_mps2[extra_of_[c - kChannels]] = static_cast<float>(readings[c]->accel_mps2);
    saturated |= unsigned{readings[c]->saturated} << c;
  }
  sample.saturated = static_cast<std::uint8_t>(saturated);
  return true;
}

template <class Count>
void SampleAssembler::emit(Count lanes, const Readings& readings) noexcept {
  if (!write(lanes, readings, false)) return;
  ++counts_.samples;
  meter_.update(next_tick_, readings[0]->time_ns);
}

bool SampleAssembler::is_short_hole(std::size_t channel, std::int64_t tick) const noexcept {
  std::int64_t length = 1;
  for (const std::int64_t step : {-1, 1})
    for (std::int64_t t = tick + step; length <= most_missing_ && find(channel, t) == nullptr;
         t += step)
      ++length;
  return length <= most_missing_;
}

// The channels that are missing read no number, at the time of one that is not.
void SampleAssembler::emit_incomplete(Readings readings, std::size_t channels) noexcept {
  Reading nothing;
  for (std::size_t c = count_; c-- > 0;) {
    if (readings[c] != nullptr)
      nothing.time_ns = readings[c]->time_ns;
    else if (!is_short_hole(c, next_tick_))
      return;
  }
  nothing.accel_mps2 = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t c = 0; c < count_; ++c)
    if (readings[c] == nullptr) readings[c] = &nothing;
  if (write(count_, readings, true)) counts_.completable += channels;
}

template <class Count>
void SampleAssembler::push_among(Count lanes, const CanFrame& frame) noexcept {
  ++counts_.frames;
  if (frame.error) {
    ++counts_.error;
    return;
  }
  bool wanted = false;
  bool far = false;
  for (std::size_t c = 0; c < lanes; ++c) {
    if (!lanes_[c].wants(frame)) continue;
    wanted = true;
    ChannelLane& lane = lanes_[c];
    if (!lane.push_next(frame)) push_unusual(lane, frame);
    far |= lane.newest() - lane_offset_[c] >= next_tick_ + kWaitTicks;
  }
  if (!wanted) {
    ++counts_.foreign;
    return;
  }
  if (!aligned_) {
    if (!ready_to_align(kAlignFrames)) return;
    if (is_bursty() && !(ready_to_align(kAlignBurst) && have_whole_ends())) return;
    align();
    far = true;
  }
  // Nearly always nothing, or one instant that is whole. A channel that did not advance is not far
  // ahead: the last frame left nothing to settle.
  for (Readings readings; far || !waits(lanes); ++next_tick_) {
    if (far || find_all(lanes, next_tick_, readings) < lanes) return settle(kWaitTicks);
    emit(lanes, readings);
  }
}

void SampleAssembler::push(const CanFrame& frame) noexcept {
  if (count_ == kChannels) {
    push_among(std::integral_constant<std::size_t, kChannels>{}, frame);
  } else {
    push_among(count_, frame);
  }
}

void SampleAssembler::push_unusual(ChannelLane& lane, const CanFrame& frame) noexcept {
  if (paused(lane, frame.time_ns)) restart(frame.time_ns);
  lane.push(frame);
  if (lane.has_lost_track()) restart(frame.time_ns);
}

void SampleAssembler::flush() noexcept {
  for (std::size_t c = 0; c < count_; ++c) lanes_[c].flush();
  if (!aligned_ && ready_to_align(1)) align();
  if (aligned_) settle(0);
}

bool SampleAssembler::paused(const ChannelLane& lane, std::int64_t time_ns) const noexcept {
  return lane.started() && lane.line().tick_at(time_ns) - static_cast<double>(lane.newest()) >
                               static_cast<double>(kPauseTicks);
}

// As counted by what the frame channel had of line and offset.
std::int64_t SampleAssembler::tick_before_pause(std::int64_t time_ns) const noexcept {
  return std::llround(line_before_pause_.tick_at(time_ns)) - offset_before_pause_;
}

// Ticks go on by time, as well as the line of the frame channel knows; where frames come in bursts,
// that is known to a burst, and better when the channels are aligned.
void SampleAssembler::restart(std::int64_t time_ns) noexcept {
  if (aligned_) {
    settle(0);
    line_before_pause_ = lanes_[0].line();
    offset_before_pause_ = lane_offset_[0];
    resume_tick_ = next_tick_;
    for (std::size_t c = 0; c < count_; ++c)
      before_pause_[c] = lanes_[c].newest() - lane_offset_[c];
    after_pause_ = true;
    next_tick_ = std::max(next_tick_, tick_before_pause(time_ns));
  }
  for (std::size_t c = 0; c < count_; ++c) lanes_[c].restart(next_tick_);
  aligned_ = false;
  meter_.begin_segment();
  ++counts_.restarts;
}

bool SampleAssembler::ready_to_align(std::uint64_t frames) const noexcept {
  const auto end = lanes_.begin() + static_cast<std::ptrdiff_t>(count_);
  return std::all_of(lanes_.begin(), end,
                     [frames](const ChannelLane& lane) { return lane.since_start() >= frames; });
}

bool SampleAssembler::have_whole_ends() const noexcept {
  const auto end = lanes_.begin() + static_cast<std::ptrdiff_t>(count_);
  return std::all_of(lanes_.begin(), end,
                     [](const ChannelLane& lane) { return lane.has_whole_end(); });
}

bool SampleAssembler::is_bursty() const noexcept {
  const auto end = lanes_.begin() + static_cast<std::ptrdiff_t>(count_);
  return std::any_of(lanes_.begin(), end, [](const ChannelLane& lane) { return lane.is_bursty(); });
}

// Lines, not single frames, are compared: one late frame must not shift a channel for good.
void SampleAssembler::find_offsets() noexcept {
  const std::int64_t now_ns = lanes_[0].line().time_ns();
  const double tick_now = lanes_[0].line().tick_at(now_ns);
  for (std::size_t c = 0; c < count_; ++c)
    lane_offset_[c] = std::llround(lanes_[c].line().tick_at(now_ns) - tick_now);
}

// A line through bursts wavers by half their length; their ends do not.
void SampleAssembler::find_offsets_of_bursts() noexcept {
  const std::int64_t first_ns = lanes_[0].earliest_ns();
  for (std::size_t c = 0; c < count_; ++c) {
    const std::int64_t after_ns = lanes_[c].earliest_ns() - first_ns;
    lane_offset_[c] = lanes_[c].newest() - lanes_[0].newest() -
                      std::llround(static_cast<double>(after_ns) / period_ns_);
  }
}

// The line before a pause went through the ends of bursts.
void SampleAssembler::go_on_by_line() noexcept {
  const std::int64_t later = tick_before_pause(lanes_[0].earliest_ns()) - lanes_[0].newest();
  for (std::size_t c = 0; c < count_; ++c) lane_offset_[c] -= later;
  next_tick_ = resume_tick_;
}

void SampleAssembler::align() noexcept {
  if (is_bursty()) {
    find_offsets_of_bursts();
    if (after_pause_) go_on_by_line();
  } else {
    find_offsets();
  }
  std::int64_t oldest = next_tick_;
  for (std::size_t c = 0; c < count_; ++c) {
    oldest = std::max(oldest, lanes_[c].oldest() - lane_offset_[c]);
    lanes_[c].aligned();
    const std::int64_t ticks = lanes_[c].first() - lane_offset_[c] - before_pause_[c] - 1;
    if (after_pause_ && ticks > 0) counts_.channels[c].paused += static_cast<std::uint64_t>(ticks);
  }
  after_pause_ = false;
  next_tick_ = oldest;
  aligned_ = true;
}

const Reading* SampleAssembler::find(std::size_t channel, std::int64_t tick) const noexcept {
  return lanes_[channel].find(tick + lane_offset_[channel]);
}

std::int64_t SampleAssembler::newest() const noexcept {
  std::int64_t tick = lanes_[0].newest() - lane_offset_[0];
  for (std::size_t c = 1; c < count_; ++c)
    tick = std::max(tick, lanes_[c].newest() - lane_offset_[c]);
  return tick;
}

void SampleAssembler::settle(std::int64_t wait_ticks) noexcept {
  const std::int64_t last = newest();
  // Two stretches at most can hold readings: the one before a jump, and the one that ends now.
  for (int stretch = 0; stretch < 2; ++stretch) {
    const std::int64_t end = std::min(last, next_tick_ + kLaneSpan);
    while (next_tick_ <= end) {
      Readings readings;
      const std::size_t channels = find_all(count_, next_tick_, readings);
      if (channels < count_ && last - next_tick_ < wait_ticks) return;
      if (channels == count_) {
        emit(count_, readings);
      } else if (channels > 0) {
        ++counts_.incomplete;
        emit_incomplete(readings, channels);
      }
      ++next_tick_;
    }
    if (next_tick_ > last) return;
    next_tick_ = std::max(next_tick_, last - kLaneSpan);
  }
}

bool SampleAssembler::pop(Sample& sample) noexcept {
  if (ready_count_ == 0) return false;
  sample = ready_[ready_first_];
  ready_first_ = (ready_first_ + 1) % kReady;
  --ready_count_;
  return true;
}

AssemblerCounts SampleAssembler::counts() const noexcept {
  AssemblerCounts all = counts_;
  all.lanes = count_;
  for (std::size_t c = 0; c < count_; ++c) {
    all.channels[c] = lanes_[c].counts();
    all.channels[c].paused = counts_.channels[c].paused;
  }
  return all;
}

FrameLedger ledger_of(const AssemblerCounts& counts, std::uint64_t kernel_drops) noexcept {
  FrameLedger ledger;
  ledger.kernel_drops = kernel_drops;
  ledger.processed = counts.lanes * counts.samples + counts.completable;
  ledger.error = counts.error;
  ledger.foreign = counts.foreign;
  std::uint64_t readings = 0;
  std::uint64_t missing = 0;           // places in the sequences that hold no reading
  std::uint64_t known = kernel_drops;  // of them, those whose frame arrived or was dropped
  for (const ChannelCounts& channel : counts.channels) {
    readings += channel.readings;
    missing += channel.lost + channel.paused - (channel.late - channel.too_late);
    known += channel.out_of_step + channel.wrong_length + channel.misjudged;
    ledger.repeated += channel.repeated;
    ledger.too_late += channel.too_late;
    ledger.out_of_step += channel.out_of_step;
    ledger.wrong_length += channel.wrong_length;
    ledger.not_data += channel.not_data;
    ledger.other_page += channel.other_page;
  }
  ledger.gaps = missing > known ? missing - known : 0;
  ledger.without_partner = readings - ledger.processed;
  ledger.excluded = ledger.error + ledger.foreign + ledger.repeated + ledger.too_late +
                    ledger.out_of_step + ledger.wrong_length + ledger.not_data + ledger.other_page +
                    ledger.without_partner;
  ledger.sent = ledger.processed + ledger.kernel_drops + ledger.gaps + ledger.excluded;
  return ledger;
}

}  // namespace dampline
