// SPDX-License-Identifier: MIT
#pragma once
#include <array>
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
  /// The strikes of the segment that ended, one a call; false when there is none left.
  [[nodiscard]] bool next(Strike& strike) noexcept;
  /// Robust standard deviation of the second difference, in codes; 0 before the first segment.
  [[nodiscard]] double scale() const noexcept { return scale_; }

 private:
  static constexpr std::int64_t kReach = 12;  // samples without a change that end an event
  static constexpr std::int64_t kLongest =
      40;  // an event that goes on is judged by its largest change
  static constexpr std::size_t kRing = 64;
  static constexpr std::size_t kWindow = 11;  // samples around the centre that are kept
  struct Candidate {
    std::int64_t tick{0};
    std::int64_t change{0};  // |second difference|
    std::array<std::int64_t, kWindow> codes{};
  };
  using Candidates = std::array<Candidate, kMost>;

  [[nodiscard]] std::int64_t past(std::int64_t back) const noexcept {
    return ring_[static_cast<std::size_t>(count_ - 1 - back) % kRing];
  }
  void settle() noexcept;
  void keep(const Candidate& candidate) noexcept;
  void end_segment() noexcept;
  [[nodiscard]] double current_scale() const noexcept;

  std::int64_t segment_;
  std::int64_t in_segment_{0};
  std::int64_t count_{0};
  std::array<std::int64_t, kRing> ring_{};
  MagnitudeHistogram changes_;
  double scale_{0.0};
  double gate_{0.0};  // below it nothing can become a strike
  bool open_{false};  // an event that may still grow
  std::int64_t open_tick_{0};
  std::int64_t open_change_{0};
  std::int64_t since_{0};   // samples since the event last exceeded the gate
  std::int64_t length_{0};  // of the open event
  Candidates candidates_{};
  std::size_t candidate_count_{0};
  Candidates closed_{};  // of the segment that ended, to be judged one a call
  std::size_t closed_count_{0};
};

}  // namespace dampline
