// SPDX-License-Identifier: MIT
#include "dampline/sample/placer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "dampline/sample/screen.hpp"

namespace dampline {
namespace {

constexpr double kStampPeriodRange = 0.02;
constexpr double kLineMemory = 2048.0;  // samples
constexpr double kFarthest = 0.5;       // ticks: farther off, a stamp is another tick's
constexpr int kOutsideInARow = 32;
constexpr std::int64_t kStampPauseTicks = 1024;
constexpr double kStampLookEveryS = 30.0;
constexpr double kLookS = 6.0;
constexpr double kJudgeEveryS = 1.0;
constexpr double kSettle = 64.0;     // samples of a look before it counts
constexpr double kOwnShare = 0.5;    // of the offs' power that is the samples' own
constexpr double kSure = 5.0;        // deviations
constexpr double kCorrelated = 4.4;  // of twelfth differences: sum of squared correlations
constexpr double kLeastOffS = 2e-5;  // rms

TickLine new_line(double rate_hz) noexcept { return {rate_hz, kStampPeriodRange, kLineMemory}; }

/// The newest of repeated differences.
template <std::size_t N>
double difference(std::array<double, N>& last, double x) noexcept {
  for (double& before : last) {
    const double change = x - before;
    before = x;
    x = change;
  }
  return x;
}

template <std::size_t N>
void push_back(std::array<double, N>& ring, double x) noexcept {
  std::move(ring.begin() + 1, ring.end(), ring.begin());
  ring.back() = x;
}

}  // namespace

// The ideal ones under Hann's window, exact for a line and a constant.
SamplePlacer::SamplePlacer(double sample_rate_hz) noexcept
    : rate_hz_{sample_rate_hz},
      look_samples_{std::llround(kLookS * sample_rate_hz)},
      look_every_{std::llround(kStampLookEveryS * sample_rate_hz)},
      judge_every_{std::llround(kJudgeEveryS * sample_rate_hz)},
      lanes_{Lane{new_line(sample_rate_hz)}, Lane{new_line(sample_rate_hz)},
             Lane{new_line(sample_rate_hz)}} {
  double line = 0.0;
  for (std::size_t k = 1; k <= kHalf; ++k) {
    const auto x = static_cast<double>(k);
    const double window = 0.5 + 0.5 * std::cos(std::numbers::pi * x / (kHalf + 1.0));
    slope_[k] = (k % 2 == 0 ? -window : window) / x;
    curvature_[k] = 2.0 * slope_[k] / x;
    curvature_[0] -= 2.0 * curvature_[k];
    line += 2.0 * slope_[k] * x;
  }
  for (double& share : slope_) share /= line;
}

void SamplePlacer::push(const Sample& sample) noexcept {
  const bool goes_on = count_ > 0 && sample.tick == held_[slot(count_ - 1)].sample.tick + 1;
  if (count_ > 0 && sample.tick - held_[slot(count_ - 1)].sample.tick > kStampPauseTicks)
    for (Lane& lane : lanes_) lane.started = false;
  Held& now = held_[slot(count_)];
  now = {.sample = sample, .first = goes_on ? held_[slot(count_ - 1)].first : count_};
  for (std::size_t c = 0; c < kChannels; ++c)
    lanes_[c].values[0][slot(count_)] = sample.accel_mps2[c];
  for (Lane& lane : lanes_) {
    if (!goes_on) lane.look.samples = 0.0;
    for (std::size_t round = 1; active_ && round < kRounds; ++round)
      lane.values[round][slot(count_)] = lane.values[0][slot(count_)];
  }
  look_at(sample);
  ++count_;
  for (std::size_t round = 0; active_ && round + 1 < kRounds; ++round) {
    const std::int64_t at = count_ - 1 - kHalf * static_cast<std::int64_t>(round + 1);
    if (at < 0) return;
    std::array<double, kChannels> placed{};
    place(round, at, placed);
    for (std::size_t c = 0; c < kChannels; ++c) lanes_[c].values[round + 1][slot(at)] = placed[c];
  }
}

bool SamplePlacer::pop(Sample& taken, Sample& placed) noexcept {
  if (count_ - next_ <= (active_ && !finished_ ? kAhead : 0)) return false;
  placed = taken = held_[slot(next_)].sample;
  if (active_) place(kRounds - 1, next_, placed.accel_mps2);
  ++next_;
  return true;
}

PlacedFigures SamplePlacer::figures() const noexcept {
  PlacedFigures out;
  for (std::size_t c = 0; c < kChannels; ++c)
    if (const Lane& lane = lanes_[c]; lane.count > 0)
      out.off_s[c] = std::sqrt(lane.square / static_cast<double>(lane.count)) / rate_hz_;
  return out;
}

void SamplePlacer::look_at(const Sample& sample) noexcept {
  const std::int64_t at = looked_++;
  const bool looks = at < look_samples_;
  if (looked_ >= look_every_) looked_ = 0;
  if (!looks && !active_) return;
  if (at == 0) {
    for (Lane& lane : lanes_) {
      lane.look = {};
      if (!active_) lane.started = false;
    }
  }
  for (std::size_t c = 0; c < kChannels; ++c) {
    Lane& lane = lanes_[c];
    const double off = off_of(c, sample);
    if (looks) lane.look.take(sample.accel_mps2[c], off);
    const bool stays = (unsigned{sample.saturated} >> c & 1U) != 0 || !lane.placed;
    if (stays || off == 0.0) continue;
    held_[slot(count_)].off[c] = off;
    ++lane.count;
    lane.square += off * off;
  }
  if (looks && (at + 1) % judge_every_ == 0) judge(at + 1 + judge_every_ > look_samples_);
}

/// Ticks by which a channel's own stamp is later than the even raster; 0: it has none.
double SamplePlacer::off_of(std::size_t channel, const Sample& sample) noexcept {
  Lane& lane = lanes_[channel];
  if (is_bridged(sample, channel)) return 0.0;
  std::int64_t time_ns = sample.time_ns;
  if (channel > 0) time_ns += 1000 * std::int64_t{sample.wheelset_after_us[channel - 1]};
  if (!lane.started) {
    lane.line = new_line(rate_hz_);
    lane.line.start(sample.tick, time_ns);
    lane.started = true;
    lane.outside = 0;
    return 0.0;
  }
  if (sample.tick <= lane.line.tick()) return 0.0;
  const double off = lane.line.tick_at(time_ns) - static_cast<double>(sample.tick);
  lane.line.update(sample.tick, time_ns);
  const bool is_near = std::abs(off) < kFarthest;
  lane.outside = is_near ? 0 : lane.outside + 1;
  if (lane.outside >= kOutsideInARow) lane.started = false;
  return is_near ? off : 0.0;
}

// The slope by central differences of sixth order.
void SamplePlacer::Look::take(double value_mps2, double off_ticks) noexcept {
  constexpr std::size_t kMiddle = kSlopeSpan / 2;
  if (!is_number(value_mps2)) {
    samples = 0.0;
    return;
  }
  push_back(value, value_mps2);
  push_back(off, off_ticks);
  const auto across = [&](std::size_t k) { return value[kMiddle + k] - value[kMiddle - k]; };
  const double slope = 0.75 * across(1) - 0.15 * across(2) + across(3) / 60.0;
  const double v = difference(of_value, value[kMiddle]);
  const double m = difference(of_moved, slope * off[kMiddle]);
  samples += 1.0;
  if (samples <= kSettle) return;
  square += off_ticks * off_ticks;
  vv += v * v;
  vm += v * m;
  mm += m * m;
}

Estimate SamplePlacer::Look::share() const noexcept {
  const double counted = samples - kSettle;
  if (!(counted > 0.0) || !(mm > 0.0)) return {};
  const double own = vm / mm;
  const double left = std::max(vv - own * vm, 0.0);
  return {own, std::sqrt(kCorrelated * left / (counted * mm))};
}

// A channel whose values hardly tell goes with the others.
void SamplePlacer::judge(bool whole) noexcept {
  std::array<Estimate, kChannels> share{};
  bool sure = false;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const Look& look = lanes_[c].look;
    share[c] = look.share();
    const double off_s = std::sqrt(look.square / std::max(look.samples, 1.0)) / rate_hz_;
    if (off_s < kLeastOffS) share[c].value = 0.0;
    sure = sure || (share[c].value > kOwnShare && share[c].value > kSure * share[c].std);
  }
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (sure && share[c].value > kOwnShare) lanes_[c].placed = true;
    if (whole && share[c].value + kSure * share[c].std < kOwnShare) lanes_[c].placed = false;
  }
  if (!sure || active_) return;
  active_ = true;
  for (Lane& lane : lanes_) std::fill(lane.values.begin() + 1, lane.values.end(), lane.values[0]);
}

/// By a round's values; what has no neighbours on either side stays.
void SamplePlacer::place(std::size_t round, std::int64_t at,
                         std::array<double, kChannels>& out) const noexcept {
  const Held& held = held_[slot(at)];
  const bool has_neighbours = at + kHalf < count_ && at - kHalf >= held.first &&
                              held_[slot(at + kHalf)].first == held.first;
  for (std::size_t c = 0; c < kChannels; ++c) {
    const auto& values = lanes_[c].values[round];
    const double taken = lanes_[c].values[0][slot(at)];
    out[c] = taken;
    const double off = held.off[c];
    if (!has_neighbours || off == 0.0) continue;
    double slope = 0.0;
    double curvature = curvature_[0] * values[slot(at)];
    for (std::int64_t k = 1; k <= kHalf; ++k) {
      const double before = values[slot(at - k)];
      const double after = values[slot(at + k)];
      slope += slope_[static_cast<std::size_t>(k)] * (after - before);
      curvature += curvature_[static_cast<std::size_t>(k)] * (after + before);
    }
    const double placed = taken - off * (slope + 0.5 * off * curvature);
    if (is_number(placed)) out[c] = placed;
  }
}

}  // namespace dampline
