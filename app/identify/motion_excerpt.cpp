// SPDX-License-Identifier: MIT
#include "app/identify/motion_excerpt.hpp"

#include "app/identify/touched.hpp"

namespace dampline::app {

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

}  // namespace dampline::app
