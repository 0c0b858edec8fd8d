// SPDX-License-Identifier: MIT
#include "dampline/guard/spike_watch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace dampline {
namespace {

constexpr double kMadToSigma = 1.0 / 0.6745;
constexpr double kStrike = 7.0;        // times the robust deviation
constexpr double kWrong = 10.0;        // a wrong sample: joints and flats reach this seldom
constexpr double kGate = 5.0;          // kept as a candidate before the deviation is final
constexpr double kRemains = 0.35;      // of the second difference, after the centre is replaced
constexpr double kOrdinary = 4.0;      // times the robust deviation: what is left of it is usual
constexpr int kMostExceeding = 4;      // second differences that one wrong sample can raise
constexpr std::int64_t kRefresh = 75;  // samples between looks at the first segment's median

std::int64_t second_difference(const std::array<double, 11>& x, std::size_t i) noexcept {
  return std::llround(std::abs(x[i - 1] - 2.0 * x[i] + x[i + 1]));
}

}  // namespace

double SpikeWatch::current_scale() const noexcept { return changes_.median() * kMadToSigma + 0.5; }

void SpikeWatch::update(std::int64_t tick, std::int64_t code) noexcept {
  ring_[static_cast<std::size_t>(count_++) % kRing] = code;
  if (count_ >= 3) {
    const std::int64_t change = std::abs(past(2) - 2 * past(1) + past(0));
    changes_.add(static_cast<std::uint64_t>(change));
    const bool strikes = static_cast<double>(change) > gate_ && gate_ > 0.0;
    if (strikes && (!open_ || change > open_change_)) {
      open_tick_ = tick - 1;
      open_count_ = count_ - 2;
      open_change_ = change;
    }
    if (strikes) {
      if (!open_) length_ = 0;
      open_ = true;
      since_ = 0;
    }
  }
  if (open_) {
    ++since_;
    ++length_;
    if (since_ > kReach || (length_ > kLongest && is_whole())) settle();
  }
  if (scale_ == 0.0 && in_segment_ % kRefresh == kRefresh - 1) gate_ = kGate * current_scale();
  if (++in_segment_ >= segment_ && !open_) end_segment();
}

void SpikeWatch::settle() noexcept {
  open_ = false;
  Candidate candidate{.tick = open_tick_, .change = open_change_};
  open_change_ = 0;
  const std::int64_t centre = count_ - 1 - open_count_;
  // The first samples after a restart have no whole window around them.
  if (centre + kHalf >= std::min<std::int64_t>(count_, kRing)) return;
  for (std::int64_t i = 0; i < static_cast<std::int64_t>(kWindow); ++i) {
    candidate.codes[static_cast<std::size_t>(i)] = past(centre + kHalf - i);
  }
  keep(candidate);
}

void SpikeWatch::keep(const Candidate& candidate) noexcept {
  if (candidate_count_ < kMost) {
    candidates_[candidate_count_++] = candidate;
    return;
  }
  auto* const least =
      std::min_element(candidates_.begin(), candidates_.end(),
                       [](const Candidate& a, const Candidate& b) { return a.change < b.change; });
  if (least->change < candidate.change) *least = candidate;
}

void SpikeWatch::end_segment() noexcept {
  if (changes_.count() > 0) scale_ = current_scale();
  gate_ = kGate * scale_;
  changes_.clear();
  in_segment_ = 0;
  close_candidates();
}

void SpikeWatch::close_candidates() noexcept {
  closed_ = candidates_;
  closed_count_ = candidate_count_;
  candidate_count_ = 0;
}

void SpikeWatch::finish() noexcept {
  if (scale_ == 0.0 || closed_count_ > 0) return;
  if (open_ && is_whole()) settle();
  close_candidates();
}

void SpikeWatch::restart() noexcept {
  count_ = 0;
  open_ = false;
  open_change_ = 0;
}

bool SpikeWatch::next(Strike& strike) noexcept {
  while (closed_count_ > 0) {
    const Candidate& candidate = closed_[--closed_count_];
    const double limit = kStrike * scale_;
    if (static_cast<double>(candidate.change) <= limit) continue;
    std::array<double, kWindow> x{};
    for (std::size_t i = 0; i < kWindow; ++i) x[i] = static_cast<double>(candidate.codes[i]);
    constexpr std::size_t kCentre = kWindow / 2;
    int exceeding = 0;
    for (std::size_t i = 1; i + 1 < kWindow; ++i) {
      if (static_cast<double>(second_difference(x, i)) > limit) ++exceeding;
    }
    const double measured = x[kCentre];
    x[kCentre] =
        (-x[kCentre - 2] + 4.0 * x[kCentre - 1] + 4.0 * x[kCentre + 1] - x[kCentre + 2]) / 6.0;
    std::int64_t left = 0;
    for (std::size_t i = kCentre - 3; i <= kCentre + 3; ++i) {
      left = std::max(left, second_difference(x, i));
    }
    strike = {
        .tick = candidate.tick,
        .height = static_cast<std::int64_t>(std::lround(measured - x[kCentre])),
        .digital = static_cast<double>(candidate.change) > kWrong * scale_ &&
                   exceeding <= kMostExceeding && static_cast<double>(left) < kOrdinary * scale_ &&
                   static_cast<double>(left) < kRemains * static_cast<double>(candidate.change)};
    return true;
  }
  return false;
}

}  // namespace dampline
