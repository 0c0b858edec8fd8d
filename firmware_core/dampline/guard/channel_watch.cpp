// SPDX-License-Identifier: MIT
#include "dampline/guard/channel_watch.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace dampline {
namespace {

// A pile: this much more at the extreme than next to it, and this many samples. Records of three
// simulated cars without clipping reach 0.65.
constexpr double kPileRatio = 1.5;
constexpr double kPileSamples = 20.0;
constexpr double kPileFloor = 3.0;
// In a sound record the two counts differ by chance: by this many deviations at least in a pile.
constexpr double kPileDeviations = 5.0;
// Bits are judged where a channel spans this many codes.
constexpr std::int64_t kEnoughSamples = 600;  // samples in a block
constexpr std::int64_t kSpan = 24;
constexpr std::int64_t kNarrow = 40;    // of a pile's width: spans are at least this many
constexpr std::int64_t kSameLevel = 2;  // codes

constexpr double kLeastMps2 = 0.25;  // clean records of simulated cars stay below 0.034
constexpr double kTimesMad = 10.0 * 1.4826;
constexpr double kLevelUnitMps2 = 1e-4;
constexpr std::uint32_t kEnoughSeconds = 12;  // differences before their median means something

}  // namespace

void RangeEnd::add(std::int64_t code) noexcept {
  if (!any_) {
    any_ = true;
    extreme_ = code;
    count_.fill(0);
  }
  if (code > extreme_) {
    const auto rise = static_cast<std::size_t>(
        std::min<std::int64_t>(code - extreme_, static_cast<std::int64_t>(kDepth)));
    for (std::size_t i = kDepth; i-- > 0;) count_[i] = i >= rise ? count_[i - rise] : 0;
    extreme_ = code;
  }
  const std::int64_t depth = extreme_ - code;
  if (depth < static_cast<std::int64_t>(kDepth)) ++count_[static_cast<std::size_t>(depth)];
}

std::uint32_t RangeEnd::sum(std::size_t first, std::size_t width) const noexcept {
  std::uint32_t total = 0;
  for (std::size_t i = first; i < std::min(first + width, kDepth); ++i) total += count_[i];
  return total;
}

void CodeWatch::update(std::int64_t tick, std::int64_t code) noexcept {
  if (!any_) {
    any_ = true;
    first_code_ = code;
  }
  ++samples_;
  moved_bits_ |= static_cast<std::uint64_t>(code ^ first_code_);
  if (!top_.any() || code > top_.extreme()) top_tick_ = tick;
  if (!bottom_.any() || -code > bottom_.extreme()) bottom_tick_ = tick;
  top_.add(code);
  bottom_.add(-code);
}

// A pile is narrow beside what the channel spans: friction, too, bounds the frame's acceleration,
// but not to a code.
bool CodeWatch::judge(Pile& pile, const RangeEnd& end, std::int64_t span) noexcept {
  for (std::size_t i = 0; i < kWidths.size(); ++i) {
    if (kWidths[i] > 1 && static_cast<std::int64_t>(kWidths[i]) * kNarrow > span) continue;
    pile.outer[i] += static_cast<double>(end.outer(kWidths[i])) - 1.0;
    pile.inner[i] += static_cast<double>(end.inner(kWidths[i]));
    const double ratio = pile.outer[i] / (pile.inner[i] + kPileFloor);
    if (pile.outer[i] < kPileSamples || ratio <= kPileRatio) continue;
    const double more = pile.outer[i] - pile.inner[i];
    if (more * more < kPileDeviations * kPileDeviations * (pile.outer[i] + pile.inner[i])) continue;
    if (!pile.found) pile.level = end.extreme();
    pile.found = true;
  }
  // At a level that is known the block counts at once.
  return pile.found && end.extreme() >= pile.level - kSameLevel && end.outer(kWidths[0]) > 1;
}

CodeVerdict CodeWatch::close() noexcept {
  CodeVerdict verdict;
  if (!any_) return verdict;
  const std::int64_t span = top_.extreme() + bottom_.extreme();
  if (span >= kSpan && samples_ >= kEnoughSamples) {
    verdict.dead_bits = std::countr_zero(moved_bits_);
    const bool top = judge(top_pile_, top_, span);
    const bool bottom = judge(bottom_pile_, bottom_, span);
    verdict.clips = verdict.dead_bits == 0 && (top || bottom);
    const RangeEnd& end = top ? top_ : bottom_;
    verdict.clip_code = top ? top_.extreme() : -bottom_.extreme();
    verdict.clip_count = end.outer(kWidths[0]);
    verdict.clip_first = top ? top_tick_ : bottom_tick_;
  }
  any_ = false;
  samples_ = 0;
  moved_bits_ = 0;
  top_.clear();
  bottom_.clear();
  return verdict;
}

void LevelWatch::restart() noexcept {
  samples_ = 0;
  sum_ = 0.0;
  seconds_ = 0;
  since_peak_ = -1;
}

bool LevelWatch::update(std::int64_t tick, double accel_mps2, LevelJump& jump) noexcept {
  sum_ += accel_mps2;
  if (++samples_ < second_) return false;
  std::move(mean_.begin() + 1, mean_.end(), mean_.begin());
  mean_.back() = sum_ / static_cast<double>(samples_);
  samples_ = 0;
  sum_ = 0.0;
  seconds_ = std::min(seconds_ + 1, kSeconds);
  return seconds_ == kSeconds && end_second(tick, jump);
}

bool LevelWatch::end_second(std::int64_t tick, LevelJump& jump) noexcept {
  double difference = 0.0;
  for (std::size_t i = 0; i < kSide; ++i) difference += mean_[kSide + 1 + i] - mean_[i];
  difference /= static_cast<double>(kSide);
  const double size = std::abs(difference);
  differences_.add(static_cast<std::uint64_t>(std::lround(std::min(size, 1e4) / kLevelUnitMps2)));
  const double limit = std::max(kLeastMps2, kTimesMad * kLevelUnitMps2 * differences_.median());
  if (differences_.count() >= kEnoughSeconds && size > limit &&
      (since_peak_ < 0 || size > std::abs(peak_.size_mps2))) {
    const auto back = static_cast<std::int64_t>(2 * kSide + 1) * second_ / 2;
    peak_ = {.tick = tick - back, .size_mps2 = difference};
    since_peak_ = 0;
    return false;
  }
  if (since_peak_ < 0 || ++since_peak_ < static_cast<int>(kSide)) return false;
  jump = peak_;
  since_peak_ = -1;
  return true;
}

}  // namespace dampline
