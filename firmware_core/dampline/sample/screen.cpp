// SPDX-License-Identifier: MIT
#include "dampline/sample/screen.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dampline/numeric/wide.hpp"

namespace dampline {
namespace {
constexpr double kFlatTopRms = 4.0;  // smaller extremes repeat by chance
constexpr double kSteepSteps = 6.0;
constexpr double kSameValue = 1e-9;  // rounding of a value that was printed
}  // namespace

template <std::size_t kMost>
Result<ScreenConfig> BasicSampleScreen<kMost>::check(const ScreenConfig& config) noexcept {
  if (!(config.sample_rate_hz > 0.0 && std::isfinite(config.sample_rate_hz)))
    return Errc::kInvalidConfig;
  if (!(config.moved_mps2 > 0.0)) return Errc::kInvalidConfig;
  for (const double step_mps2 : config.step_mps2) {
    if (!(step_mps2 >= 0.0)) return Errc::kInvalidConfig;
  }
  return config;
}

template <std::size_t kMost>
BasicSampleScreen<kMost>::BasicSampleScreen(const ScreenConfig& config) noexcept
    : window_{static_cast<std::size_t>(
          std::min(std::round(stuck_samples(config.sample_rate_hz)), double{kCapacity}))},
      config_{config} {}

template <std::size_t kMost>
typename BasicSampleScreen<kMost>::Held& BasicSampleScreen<kMost>::held(std::size_t age) noexcept {
  return ring_[(newest_ + kCapacity - age) % kCapacity];
}

template <std::size_t kMost>
const typename BasicSampleScreen<kMost>::Held& BasicSampleScreen<kMost>::held(
    std::size_t age) const noexcept {
  return ring_[(newest_ + kCapacity - age) % kCapacity];
}

template <std::size_t kMost>
DAMPLINE_WIDE bool BasicSampleScreen<kMost>::push(const Sample& sample, Screened& out) noexcept {
  newest_ = (newest_ + 1) % kCapacity;
  ring_[newest_].sample = sample;
  ring_[newest_].verdict = {};
  ++count_;
  const bool paused =
      count_ > 1 && sample.tick - held(1).sample.tick > static_cast<std::int64_t>(window_);
  for (std::size_t c = 0; config_.find_flat_tops && c < kChannels; ++c)
    follow_extremes(runs_[c], sample.accel_mps2[c]);
  for (std::size_t c = 0; c < kChannels; ++c) {
    follow(runs_[c], sample.accel_mps2[c], sample.tick, paused);
    if ((sample.saturated >> c & 1U) != 0U) mark(c, 1, Verdict::kSaturated);
    if (!is_number(sample.accel_mps2[c])) mark(c, 1, Verdict::kNotFinite);
  }
  if (sample.saturated >> kChannels != 0) mark(0, 1, Verdict::kSaturated);  // an extra
  for (std::size_t c = 0; sample.spoilt && c < kChannels; ++c) mark(c, 1, Verdict::kSpoilt);
  for (std::size_t c = 0; c < kChannels; ++c)
    if (runs_[c].stuck || holds(c, sample.tick)) judge_stuck(c);
  for (std::size_t c = 0; config_.find_flat_tops && c < kChannels; ++c) judge_flat_top(c);
  if (count_ < window_) return false;
  take_oldest(out);
  return true;
}

template <std::size_t kMost>
bool BasicSampleScreen<kMost>::drain(Screened& out) noexcept {
  if (count_ == 0) return false;
  take_oldest(out);
  return true;
}

template <std::size_t kMost>
void BasicSampleScreen<kMost>::take_oldest(Screened& out) noexcept {
  const Held& oldest = held(count_ - 1);
  out = Screened{oldest.sample, Verdict::kGood, 0};
  out.verdict = *std::max_element(oldest.verdict.begin(), oldest.verdict.end());
  for (std::size_t c = 0; c < kChannels; ++c) {
    if (out.verdict != Verdict::kGood && oldest.verdict[c] == out.verdict) {
      out.channels = static_cast<std::uint8_t>(out.channels | (1U << c));
    }
  }
  --count_;
}

template <std::size_t kMost>
void BasicSampleScreen<kMost>::mark(std::size_t channel, std::int64_t samples,
                                    Verdict verdict) noexcept {
  const std::size_t reach = std::min(static_cast<std::size_t>(samples), count_);
  for (std::size_t age = 0; age < reach; ++age) {
    Verdict& known = held(age).verdict[channel];
    known = std::max(known, verdict);
  }
}

// Lost samples do not end a run: a stuck channel stays stuck. A pause does.
template <std::size_t kMost>
void BasicSampleScreen<kMost>::follow(Run& run, double value, std::int64_t tick,
                                      bool paused) noexcept {
  if (run.samples > 0 && !paused && value == run.value) {
    ++run.samples;
    return;
  }
  run.value = value;
  run.first_tick = tick;
  run.samples = 1;
  run.stuck = false;
}

template <std::size_t kMost>
void BasicSampleScreen<kMost>::follow_extremes(Run& run, double value) noexcept {
  if (!is_number(value)) return;
  const double size = std::abs(value - run.value);
  if (run.count > 0.0 && size > kSameValue && (run.step_mps2 == 0.0 || size < run.step_mps2))
    run.step_mps2 = size;
  run.count += 1.0;
  const double off = value - run.mean;
  run.mean += off / run.count;
  run.sum_squares += off * (value - run.mean);
  if (run.count == 1.0 || value > run.highest) {
    run.highest = value;
    run.flat_top = false;
  }
  if (run.count == 1.0 || value < run.lowest) {
    run.lowest = value;
    run.flat_bottom = false;
  }
}

template <std::size_t kMost>
bool BasicSampleScreen<kMost>::holds(std::size_t channel, std::int64_t tick) const noexcept {
  return tick - runs_[channel].first_tick + 1 >= static_cast<std::int64_t>(window_);
}

template <std::size_t kMost>
void BasicSampleScreen<kMost>::judge_stuck(std::size_t channel) noexcept {
  Run& run = runs_[channel];
  if (run.stuck) {
    mark(channel, 1, Verdict::kStuck);
    return;
  }
  const std::int64_t tick = held(0).sample.tick;
  for (std::size_t other = 0; other < kChannels; ++other) {
    if (other == channel || holds(other, tick) || !moved(other)) continue;
    run.stuck = true;
    mark(channel, run.samples, Verdict::kStuck);
    return;
  }
}

template <std::size_t kMost>
bool BasicSampleScreen<kMost>::moved(std::size_t channel) const noexcept {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  const std::int64_t first_tick = held(0).sample.tick - static_cast<std::int64_t>(window_) + 1;
  for (std::size_t age = 0; age < count_ && held(age).sample.tick >= first_tick; ++age) {
    const double value = held(age).sample.accel_mps2[channel];
    if (!is_number(value)) continue;
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
  }
  const double step = config_.step_mps2[channel];
  return highest - lowest > (step > 0.0 ? double{kStepsMoved} * step : config_.moved_mps2);
}

/// The top of a parabola that a coarse step makes equal for n samples is three steps lower n / 2
/// samples before them; one that is cut off comes from farther below.
template <std::size_t kMost>
bool BasicSampleScreen<kMost>::rises_steeply(std::size_t channel) const noexcept {
  const Run& run = runs_[channel];
  const auto before = static_cast<std::size_t>(run.samples + (run.samples + 1) / 2 - 1);
  if (before >= count_) return true;
  const double known = config_.step_mps2[channel];
  const double step = known > 0.0 ? known : run.step_mps2;
  return std::abs(run.value - held(before).sample.accel_mps2[channel]) > kSteepSteps * step;
}

template <std::size_t kMost>
void BasicSampleScreen<kMost>::judge_flat_top(std::size_t channel) noexcept {
  Run& run = runs_[channel];
  if (run.count < static_cast<double>(window_)) return;
  const bool top = run.value == run.highest;
  if (!top && run.value != run.lowest) return;
  bool& flat = top ? run.flat_top : run.flat_bottom;
  if (flat) {
    mark(channel, 1, Verdict::kSaturated);
    return;
  }
  const double rms = std::sqrt(run.sum_squares / run.count);
  const double magnitude = std::abs(run.value - run.mean);
  if (run.samples < kFlatTop || magnitude <= std::max(kFlatTopRms * rms, config_.moved_mps2) ||
      !rises_steeply(channel))
    return;
  flat = true;
  mark(channel, run.samples, Verdict::kSaturated);
}

template class BasicSampleScreen<256>;
template class BasicSampleScreen<80>;

}  // namespace dampline
