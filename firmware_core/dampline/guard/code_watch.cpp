// SPDX-License-Identifier: MIT
#include "dampline/guard/code_watch.hpp"

#include <algorithm>
#include <bit>

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
constexpr std::int64_t kEnough = 600;  // samples in a block
constexpr std::int64_t kSpan = 24;
constexpr std::int64_t kNarrow = 40;    // of a pile's width: spans are at least this many
constexpr std::int64_t kSameLevel = 2;  // codes

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
  if (span >= kSpan && samples_ >= kEnough) {
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

}  // namespace dampline
