// SPDX-License-Identifier: MIT
#include "app/identify/collected.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "app/config/config.hpp"
#include "app/text/format.hpp"

namespace dampline::app {

void ConvergenceHistory::add(std::int64_t tick, const Level& level) {
  next_ = tick + interval_;
  if (!level.valid) return;
  rows_.push_back({tick, level.coulomb_n, level.stiffness_npm});
  if (rows_.size() < kMost) return;
  for (std::size_t i = 0; i < rows_.size() / 2; ++i) rows_[i] = rows_[2 * i + 1];
  rows_.resize(rows_.size() / 2);
  interval_ *= 2;
  next_ = tick + interval_;
}

MotionExcerpt::MotionExcerpt(double sample_rate_hz)
    : length_{static_cast<std::size_t>(kLengthSeconds * sample_rate_hz)} {
  reserve_touched(current_, length_);
  reserve_touched(best_, length_);
}

void MotionExcerpt::take(const Motion& motion) {
  if (settled_) return;
  if (!current_.empty() && motion.tick != current_.back().tick + 1) judge();
  current_.push_back(motion);
  current_sum_ += motion.velocity_mps * motion.velocity_mps;
  if (current_.size() == length_) judge();
}

void MotionExcerpt::judge() {
  const bool whole = current_.size() == length_;
  const bool longer = current_.size() > best_.size();
  if (longer || (whole && current_sum_ > best_sum_)) {
    best_.swap(current_);
    best_sum_ = current_sum_;
    settled_ = whole && best_sum_ > kLivelyRmsMps * kLivelyRmsMps * static_cast<double>(length_);
  }
  current_.clear();
  current_sum_ = 0.0;
}

const std::vector<Motion>& MotionExcerpt::best() const noexcept {
  return current_.size() > best_.size() ? current_ : best_;
}

namespace {

constexpr std::uint64_t kFewHits = 20;
constexpr double kShare = 2e-4;     // coarse codes repeat their largest value now and then
constexpr std::uint64_t kPile = 2;  // times the hits of the next value

}  // namespace

std::vector<std::string> ClippingWatch::warnings() const {
  std::vector<std::string> out;
  const auto limit =
      std::max(kFewHits, static_cast<std::uint64_t>(kShare * static_cast<double>(samples_)));
  for (std::size_t c = 0; c < kChannels; ++c) {
    const Extreme& worst = high_[c].hits >= low_[c].hits ? high_[c] : low_[c];
    if (worst.hits < std::max(limit, kPile * worst.next_hits) ||
        worst.value == -(&worst == &high_[c] ? low_[c] : high_[c]).value)
      continue;
    out.push_back(
        fmt::format("Channel {0} seems to clip: {1} samples stand at its extreme, {2:.4g} "
                    "m/s^2 in size, and the result is not to be trusted. [input.range_mps2] "
                    "{0} = {3:.4g} leaves such stretches out.",
                    kTruckChannels[c], format_count(worst.hits), worst.value, 0.999 * worst.value));
  }
  return out;
}

}  // namespace dampline::app
