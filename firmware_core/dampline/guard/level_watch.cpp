// SPDX-License-Identifier: MIT
#include "dampline/guard/level_watch.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

constexpr double kLeastMps2 = 0.25;  // clean records of simulated cars stay below 0.034
constexpr double kTimesMad = 10.0 * 1.4826;
constexpr double kUnitMps2 = 1e-4;
constexpr std::uint32_t kEnough = 12;  // differences before their median means something

}  // namespace

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
  differences_.add(static_cast<std::uint64_t>(std::lround(std::min(size, 1e4) / kUnitMps2)));
  const double limit = std::max(kLeastMps2, kTimesMad * kUnitMps2 * differences_.median());
  if (differences_.count() >= kEnough && size > limit &&
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
