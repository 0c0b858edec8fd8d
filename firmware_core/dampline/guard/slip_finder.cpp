// SPDX-License-Identifier: MIT
#include "dampline/guard/slip_finder.hpp"

#include <algorithm>
#include <cmath>

namespace dampline {
namespace {

// In simulated cars whose wheelsets differ by a tenth of their power, slips reach 5 deviations and
// more, with fits of 0.59 to 1.07 and below -0.49 on either side; what is left is up to 3.3 times
// what it usually is. More than that is left in 0.3 % of the windows at most; with wheel flats, in
// some 10 to 50 %.
constexpr double kDeviations = 4.3;
constexpr double kFits = 0.55;
constexpr double kFitsNot = -0.45;
constexpr double kMostLeft = 4.5;
constexpr double kMostRough = 0.01;     // share of windows with more left than that
constexpr double kRoughWindows = 4500;  // that it is smoothed over; a minute

}  // namespace

SlipFinder::Window SlipFinder::window(std::int64_t tick, std::size_t length,
                                      double sigma) const noexcept {
  ShiftSums sums;
  for (std::size_t i = 0; i < length; ++i) {
    const ShiftSums& chunk = chunks_[(count_ - i) % kMost];
    for (std::size_t s = 0; s < ShiftSums::kShifts; ++s) {
      sums.error[s] += chunk.error[s];
      sums.change[s] += chunk.change[s];
    }
  }
  const auto samples = static_cast<double>(length * std::size_t{ShiftSums::kSamples});
  const auto best = static_cast<std::size_t>(
      std::min_element(sums.error.begin(), sums.error.end()) - sums.error.begin());
  Window out{.tick = tick, .shift = best, .left = sums.error[best] / (samples * sigma * sigma)};
  for (std::size_t s = 0; s < ShiftSums::kShifts; ++s) {
    if (s == ShiftSums::kNone || !(sums.change[s] > 0.0)) continue;
    const double gain = sums.error[ShiftSums::kNone] - sums.error[s];
    out.fit[s] = gain / sums.change[s];
    if (s == best) out.deviations = gain / (2.0 * sigma * std::sqrt(sums.change[s]));
  }
  return out;
}

bool SlipFinder::is_slip(const Window& found, const Window& before, const Window& after) noexcept {
  const std::size_t s = found.shift;
  const int samples = static_cast<int>(s) - ShiftSums::kReach;
  return std::abs(samples) <= kMostShift && found.deviations >= kDeviations &&
         found.left <= kMostLeft && found.fit[s] >= kFits && before.fit[s] <= kFitsNot &&
         after.fit[s] <= kFitsNot;
}

bool SlipFinder::update(std::int64_t tick, const ShiftSums& chunk, std::int64_t delay_samples,
                        double sigma, Slip& out) noexcept {
  const std::int64_t whole = delay_samples / ShiftSums::kSamples - 1;
  if (whole < 1 || whole > static_cast<std::int64_t>(kMost) || !(sigma > 0.0)) {
    restart();
    return false;
  }
  const auto length = static_cast<std::size_t>(whole);
  chunks_[count_ % kMost] = chunk;
  const Window newest = window(tick, length, sigma);
  windows_[count_++ % kRing] = newest;
  rough_ += ((newest.left > kMostLeft ? 1.0 : 0.0) - rough_) / kRoughWindows;
  const std::size_t apart = length + 2;
  if (count_ < 3 * apart || tick < quiet_until_ || rough_ > kMostRough) return false;
  const Window& found = back(apart);
  if (!is_slip(found, back(2 * apart), newest)) return false;
  quiet_until_ = tick + 2 * delay_samples;
  out = {.tick = found.tick - (whole - 1) * ShiftSums::kSamples,
         .samples = static_cast<int>(found.shift) - ShiftSums::kReach};
  return true;
}

}  // namespace dampline
