// SPDX-License-Identifier: MIT
#include "dampline/guard/timing_watch.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kSignificant = 12.0;    // of a step or trend; clean records stay below 4
constexpr double kLeastDelayS = 150e-6;  // between the wheelsets
constexpr double kLeastLagS = 0.5e-3;    // of the frame; friction and mass move it by 0.35 ms
constexpr double kStays = 0.25;          // of the change of delay: what stays moves less
// Of the change of delay: that near to it, or to nothing, are the frame's lags where one wheelset
// is out of step; within 0.02 in simulated records, while a change of speed moves them by anything.
constexpr double kOutOfStep = 0.1;
constexpr double kSudden = 0.7;         // of the change, within
constexpr std::size_t kSuddenHops = 4;  // segments of 0.85 s
constexpr double kNoGapS = 8.0;         // across kSuddenHops + 2 segments
constexpr double kSameWay = 0.5;        // of the frame's lag behind all alike
constexpr double kWholeDelay = 0.03;    // samples: a step this near a whole number of them
constexpr double kWholeLag = 0.05;
constexpr double kReachS = 20.0;          // from where a step is sought
constexpr std::size_t kEnoughBlocks = 7;  // blocks
constexpr double kOtherSpeed = 0.2;       // of the delay before: no channel is as far out of step
constexpr double kLasts = 0.25;           // of its range: a drift goes one way
constexpr double kSameChangeS = 60.0;     // changes of speed this close are one

double middle_of(double a, double b, double c) noexcept {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

void TimingWatch::restart() noexcept {
  delay_.clear();
  for (BlockSeries& lag : lag_) lag.clear();
  segment_count_ = 0;
  newest_delay_s_ = 0.0;
}

void TimingWatch::add_segment(std::int64_t tick, double delay_s) noexcept {
  segments_[segment_count_++ % kSegments] = {tick, delay_s};
}

void TimingWatch::discard_segments(std::int64_t tick) noexcept {
  std::size_t left = std::min(segment_count_, kSegments);
  while (left-- > 0 && segments_[(segment_count_ - 1) % kSegments].tick >= tick) --segment_count_;
}

bool TimingWatch::is_other_speed(double delay_s) const noexcept {
  return newest_delay_s_ != 0.0 &&
         std::abs(delay_s - newest_delay_s_) > kOtherSpeed * std::abs(newest_delay_s_);
}

// The frame's lag is another at another speed, where friction holds it for another share of the
// time; nor is it known which speed it is while the delay is not known any more.
bool TimingWatch::add_block(const BlockFigures& block, bool has_delay,
                            GuardInputs& inputs) noexcept {
  const std::int64_t middle = (block.first_tick + block.last_tick) / 2;
  const bool other_speed = has_delay && is_other_speed(block.delay_s);
  if (other_speed) {
    restart();
    count_speed_change(middle, inputs);
  }
  if (has_delay) {
    newest_delay_s_ = block.delay_s;
    delay_.add(block.delay_s, middle);
  }
  if (other_speed || !block.has_lag || has_delay != (newest_delay_s_ != 0.0)) return other_speed;
  for (std::size_t i = 0; i < lag_.size(); ++i) lag_[i].add(block.lag_s[i], middle);
  return other_speed;
}

double TimingWatch::delay_s() const noexcept {
  if (delay_.size() < BlockSeries::kSide) return 0.0;
  return delay_.newest(6).median();
}

double TimingWatch::slope(const BlockSeries& series) const noexcept {
  const std::size_t n = series.size();
  const auto blocks = static_cast<double>(n - 1);
  const double seconds = static_cast<double>(series.tick(n - 1) - series.tick(0)) / rate_hz_;
  return series.trend().per_block * blocks / seconds;
}

bool TimingWatch::jumped(std::int64_t tick) const noexcept {
  return jump_tick_ >= 0 && static_cast<double>(std::abs(jump_tick_ - tick)) < kReachS * rate_hz_;
}

// The largest change of the delay within kSuddenHops segments round the step. Where the segments
// there were no good, the wheelsets' difference tells.
bool TimingWatch::sudden(std::int64_t tick, double size_s) const noexcept {
  const std::size_t held = std::min(segment_count_, kSegments);
  const auto segment = [&](std::size_t back) -> const Segment& {
    return segments_[(segment_count_ - 1 - back) % kSegments];
  };
  const auto delay = [&](std::size_t back) {
    return middle_of(segment(back - 1).delay_s, segment(back).delay_s, segment(back + 1).delay_s);
  };
  if (jumped(tick)) return true;
  const auto reach = static_cast<std::int64_t>(kReachS * rate_hz_);
  double largest = 0.0;
  for (std::size_t back = 1; back + kSuddenHops + 2 < held; ++back) {
    if (std::abs(segment(back).tick - tick) > reach) continue;
    const auto span =
        static_cast<double>(segment(back - 1).tick - segment(back + kSuddenHops + 1).tick);
    if (span > kNoGapS * rate_hz_) continue;
    largest = std::max(largest, std::abs(delay(back) - delay(back + kSuddenHops)));
  }
  return largest > kSudden * std::abs(size_s);
}

void TimingWatch::report_step(FaultLog& log, FaultChannel channel, std::int64_t tick, double size_s,
                              double whole_tolerance) const noexcept {
  const double samples = size_s * rate_hz_;
  const double whole = std::round(samples);
  if (whole != 0.0 && std::abs(samples - whole) < whole_tolerance) {
    const FaultKind kind = whole < 0.0 ? FaultKind::kLostSamples : FaultKind::kRepeatedSamples;
    log.report(kind, channel, log.seconds(tick), std::abs(whole));
  } else {
    log.report(FaultKind::kTimingStep, channel, log.seconds(tick), size_s);
  }
}

// The block that holds the change goes, too.
void TimingWatch::forget_before(std::int64_t tick) noexcept {
  for (BlockSeries* series : {&delay_, lag_.data(), &lag_[1], &lag_[2]}) {
    series->drop_before(tick);
    series->drop(1);
  }
}

// A wheelset out of step: the frame lags it by as much less or more, and the other as before. Else
// the frame's lag behind their mean stays when the speed changes. Where a wheelset is far out of
// step or drifts, the lag behind the mean may stay as well.
TimingWatch::Cause TimingWatch::cause_of(double delay_s, const std::array<double, 3>& lag_s,
                                         bool may_stay) noexcept {
  const double change_s = std::abs(delay_s);
  const bool stays = std::abs(lag_s[0]) <= kStays * change_s;
  if (stays && !may_stay) return Cause::kSpeed;
  const auto out_of_step = [&](double moved_s, double other_s) {
    return std::abs(std::abs(moved_s) - change_s) < kOutOfStep * change_s &&
           std::abs(other_s) < kOutOfStep * change_s;
  };
  if (out_of_step(lag_s[1], lag_s[2])) return Cause::kWheelset1;
  if (out_of_step(lag_s[2], lag_s[1])) return Cause::kWheelset2;
  return stays ? Cause::kSpeed : Cause::kUnknown;
}

// True when the change explains what the frame's lag does as well.
bool TimingWatch::judge_wheelsets(FaultLog& log, GuardInputs& inputs) noexcept {
  if (delay_.size() < kEnoughBlocks) return false;
  const BlockSeries::Step step = delay_.step();
  if (step.significance <= kSignificant || std::abs(step.size) <= kLeastDelayS) return false;
  if (step.block + BlockSeries::kSide + 1 > delay_.size()) return true;  // wait for one block more
  const std::int64_t tick = (delay_.tick(step.block) + delay_.tick(step.block - 1)) / 2;
  const double change_s = delay_.change_at(tick);
  const bool at_once = std::abs(change_s) > kSudden * delay_.range();
  const double moved_s = at_once ? change_s : delay_.change_since(delay_.tick(0));
  std::array<double, 3> lag_s{};
  for (std::size_t i = 0; i < lag_.size(); ++i) {
    lag_s[i] = at_once ? lag_[i].change_at(tick) : lag_[i].change_since(delay_.tick(0));
  }
  const bool has_lag = lag_[0].size() + 2 >= delay_.size();
  const Cause cause =
      has_lag ? cause_of(moved_s, lag_s, !at_once || jumped(tick)) : Cause::kUnknown;
  const bool passed = !at_once && std::abs(moved_s) < kLasts * delay_.range();
  if (cause == Cause::kSpeed || passed ||
      (cause == Cause::kUnknown &&
       !sudden(tick, std::max(std::abs(change_s), std::abs(step.size))))) {
    count_speed_change(tick, inputs);
    delay_.drop(delay_.size() - BlockSeries::kSide);  // what was before it no longer compares
    return true;
  }
  const FaultChannel channel = cause == Cause::kWheelset1   ? FaultChannel::kWheelset1
                               : cause == Cause::kWheelset2 ? FaultChannel::kWheelset2
                                                            : FaultChannel::kWheelsets;
  const double sign = cause == Cause::kWheelset1 ? -1.0 : 1.0;  // wheelset 1 late: less delay
  if (at_once && (cause == Cause::kUnknown || !delay_.is_straight(step.block))) {
    report_step(log, channel, tick, sign * change_s, kWholeDelay);
    forget_before(tick);
  } else {
    log.report(FaultKind::kClockDrift, channel, log.seconds(delay_.tick(0)),
               sign * 1e6 * slope(delay_));
  }
  return true;
}

void TimingWatch::count_speed_change(std::int64_t tick, GuardInputs& inputs) noexcept {
  if (last_speed_change_ < 0 ||
      static_cast<double>(tick - last_speed_change_) > kSameChangeS * rate_hz_) {
    ++inputs.speed_changes;
  }
  last_speed_change_ = tick;
}

void TimingWatch::judge_frame(FaultLog& log) noexcept {
  const BlockSeries& lag = lag_[0];
  if (lag.size() < kEnoughBlocks) return;
  const BlockSeries::Step step = lag.step();
  if (step.significance <= kSignificant || std::abs(step.size) <= kLeastLagS) return;
  const std::size_t b = step.block;
  if (b + BlockSeries::kSide + 1 > lag.size()) return;
  const std::int64_t tick = (lag.tick(b) + lag.tick(b - 1)) / 2;
  const double jump_s = lag[std::min(b + 1, lag.size() - 1)] - lag[b >= 2 ? b - 2 : 0];
  const bool is_sudden = std::abs(jump_s) > kSudden * lag.range();
  std::array<double, 3> change_s{};
  for (std::size_t i = 0; i < lag_.size(); ++i) {
    change_s[i] = is_sudden ? lag_[i].change_at(tick) : lag_[i].change_since(lag.tick(0));
  }
  for (std::size_t i = 1; i < lag_.size(); ++i) {
    if (change_s[i] * change_s[0] < kSameWay * change_s[0] * change_s[0]) return;
  }
  if (is_sudden) {
    report_step(log, FaultChannel::kFrame, tick, change_s[0], kWholeLag);
    forget_before(tick);
    return;
  }
  log.report(FaultKind::kClockDrift, FaultChannel::kFrame, log.seconds(lag.tick(0)),
             1e6 * slope(lag));
}

void TimingWatch::judge(FaultLog& log, GuardInputs& inputs) noexcept {
  if (!judge_wheelsets(log, inputs)) judge_frame(log);
}

}  // namespace dampline
