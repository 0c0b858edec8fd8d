// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "dampline/numeric/log_histogram.hpp"

namespace dampline {

/// A sudden change of one channel.
struct Strike {
  std::int64_t tick{0};
  std::int64_t height{0};  ///< what interpolation of its neighbours leaves of the sample, in codes
  bool digital{false};     ///< a wrong sample; otherwise an impact, which is input
};

/// Finds sudden changes in one channel by its second difference and tells single wrong samples from
/// impacts: replacing a wrong sample by x0 = (-x_-2 + 4 x_-1 + 4 x_+1 - x_+2) / 6 leaves little of
/// the second differences around it; an impact moves its neighbours too. Judged in segments of 2 s
/// against the segment's own median, so known up to 2 s later.
class SpikeWatch {
 public:
  static constexpr std::size_t kMost = 24;  ///< strikes that a segment can hold; the highest stay
  explicit SpikeWatch(std::int64_t segment_samples) noexcept : segment_{segment_samples} {}

  void update(std::int64_t tick, std::int64_t code) noexcept;
  /// Samples are missing: what comes next does not continue what came before.
  void restart() noexcept;
  /// No more samples: the open segment ends, judged by the deviation of the one before.
  void finish() noexcept;
  /// The strikes of the segment that ended, one a call; false when there is none left.
  [[nodiscard]] bool next(Strike& strike) noexcept;
  /// Robust standard deviation of the second difference, in codes; 0 before the first segment.
  [[nodiscard]] double scale() const noexcept { return scale_; }

 private:
  static constexpr std::int64_t kReach = 12;  // samples without a change that end an event
  // An event that goes on is judged by its largest change.
  static constexpr std::int64_t kLongest = 40;
  static constexpr std::size_t kRing = 64;
  static constexpr std::size_t kWindow = 11;  // samples around the centre that are kept
  static constexpr auto kHalf = static_cast<std::int64_t>(kWindow / 2);
  struct Candidate {
    std::int64_t tick{0};
    std::int64_t change{0};  // |second difference|
    std::array<std::int64_t, kWindow> codes{};
  };
  using Candidates = std::array<Candidate, kMost>;

  [[nodiscard]] std::int64_t past(std::int64_t back) const noexcept {
    return ring_[static_cast<std::size_t>(count_ - 1 - back) % kRing];
  }
  [[nodiscard]] bool is_whole() const noexcept { return count_ - 1 - open_count_ >= kHalf; }
  void settle() noexcept;
  void keep(const Candidate& candidate) noexcept;
  void end_segment() noexcept;
  void close_candidates() noexcept;
  [[nodiscard]] double current_scale() const noexcept;

  std::int64_t segment_;
  std::int64_t in_segment_{0};
  std::int64_t count_{0};
  std::array<std::int64_t, kRing> ring_{};
  MagnitudeHistogram changes_;
  double scale_{0.0};
  double gate_{0.0};            // below it nothing can become a strike
  bool open_{false};            // an event that may still grow
  std::int64_t open_tick_{0};   // of the event's largest change
  std::int64_t open_count_{0};  // its place in the ring
  std::int64_t open_change_{0};
  std::int64_t since_{0};   // samples since the event last exceeded the gate
  std::int64_t length_{0};  // of the open event
  Candidates candidates_{};
  std::size_t candidate_count_{0};
  Candidates closed_{};  // of the segment that ended, to be judged one a call
  std::size_t closed_count_{0};
};

/// Whether events come at multiples of one interval, as wheel flats and rail joints do and wrong
/// samples do not. Sees the newest eight intervals.
class Regularity {
 public:
  void add(std::int64_t tick) noexcept {
    if (any_) intervals_[count_++ % kKept] = std::abs(tick - last_);
    any_ = true;
    last_ = tick;
  }
  [[nodiscard]] bool regular() const noexcept {
    if (count_ < kKept) return false;
    const std::int64_t base = *std::min_element(intervals_.begin(), intervals_.end());
    if (base < kLeastTicks) return false;
    std::size_t fit = 0;
    for (const std::int64_t interval : intervals_) {
      const double turns = static_cast<double>(interval) / static_cast<double>(base);
      if (std::abs(turns - std::round(turns)) < kTolerance) ++fit;
    }
    return fit >= kFit;
  }

 private:
  static constexpr std::size_t kKept = 8;
  static constexpr std::size_t kFit = 7;
  static constexpr std::int64_t kLeastTicks = 12;
  static constexpr double kTolerance = 0.12;
  std::array<std::int64_t, kKept> intervals_{};
  std::size_t count_{0};
  bool any_{false};
  std::int64_t last_{0};
};

/// How much of a channel's fast motion comes in impulses, as the power of white noise that would
/// have it. The sixth difference passes what is above a third of the rate; of normal motion its
/// mean square is that which its median tells, of wheel flats it is more. So noise, which comes all
/// the time, differs from flats too weak to be seen one by one.
class ImpulsePower {
 public:
  void update(double accel_mps2) noexcept {
    std::array<double, kOrder + 1> difference{};
    difference[0] = accel_mps2;
    for (std::size_t i = 0; i < kOrder; ++i) difference[i + 1] = difference[i] - last_[i];
    last_ = difference;
    if (seen_ < kOrder) {
      ++seen_;
      return;
    }
    const double size = std::abs(difference[kOrder]);
    sum_squares_ += size * size;
    sizes_.add(static_cast<std::uint64_t>(std::min(size, kMostMps2) / kUnitMps2));
  }
  void restart() noexcept { seen_ = 0; }
  /// Of the samples since the last call, (m/s^2)^2.
  [[nodiscard]] double take() noexcept {
    const auto count = static_cast<double>(sizes_.count());
    const double usual = kMadToSigma * kUnitMps2 * sizes_.median();
    const double power = count > 0.0 ? (sum_squares_ / count - usual * usual) / kWhiteGain : 0.0;
    sizes_.clear();
    sum_squares_ = 0.0;
    return std::max(power, 0.0);
  }

 private:
  static constexpr std::size_t kOrder = 6;
  static constexpr double kWhiteGain = 924.0;  // sum of the squared binomials of order 6
  static constexpr double kMadToSigma = 1.0 / 0.6745;
  static constexpr double kUnitMps2 = 1e-3;
  static constexpr double kMostMps2 = 1e6;
  std::array<double, kOrder + 1> last_{};
  std::size_t seen_{0};
  MagnitudeHistogram sizes_;
  double sum_squares_{0.0};
};

}  // namespace dampline
