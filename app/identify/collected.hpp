// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "app/run/result.hpp"
#include "dampline/sample.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::app {

/// Room for `count` elements whose pages are already mapped: filling it later neither allocates nor
/// faults.
template <class T>
void reserve_touched(std::vector<T>& vector, std::size_t count) {
  vector.resize(count);
  vector.clear();
}

/// How the level and the stiffness developed, in at most kMost rows however long the record is:
/// when they are full, every other row goes and the interval doubles. add() does not allocate.
class ConvergenceHistory {
 public:
  static constexpr std::size_t kMost = 240;

  /// `interval` ticks between rows at first.
  ConvergenceHistory(std::int64_t interval, std::int64_t first_tick)
      : interval_{interval}, next_{first_tick + interval} {
    reserve_touched(rows_, kMost);
  }
  /// Begins at another tick. Precondition: nothing was added yet.
  void start(std::int64_t first_tick) noexcept { next_ = first_tick + interval_; }
  [[nodiscard]] bool due(std::int64_t tick) const noexcept { return tick >= next_; }
  void add(std::int64_t tick, const Level& level);

  struct Row {
    std::int64_t tick{0};
    Estimate coulomb_n;
    Estimate stiffness_npm;
  };
  [[nodiscard]] const std::vector<Row>& rows() const noexcept { return rows_; }

 private:
  std::int64_t interval_;
  std::int64_t next_;
  std::vector<Row> rows_;
};

/// Stretches of the record that were left out. Neighbours with one reason become one stretch.
/// Bounded: what comes after kMost stretches is only counted. add() does not allocate.
class ExcludedList {
 public:
  static constexpr std::size_t kMost = 2000;

  ExcludedList() { reserve_touched(list_, kMost); }
  /// Stretches come in the order of time. `reason` is a literal: it is not copied.
  void add(double start_s, double end_s, std::string_view reason) noexcept {
    const bool same = !list_.empty() && list_.back().reason == reason;
    if (same && more_ == 0 && start_s <= list_.back().end_s + kTouchingSeconds) {
      list_.back().end_s = end_s;
    } else if (list_.size() < kMost) {
      list_.push_back({start_s, end_s, reason});
    } else {
      ++more_;
    }
  }
  [[nodiscard]] std::vector<Excluded> list() const {
    std::vector<Excluded> out;
    for (const Stretch& s : list_) out.push_back({s.start_s, s.end_s, std::string{s.reason}});
    return out;
  }
  [[nodiscard]] std::uint64_t more() const noexcept { return more_; }

 private:
  static constexpr double kTouchingSeconds = 0.01;
  struct Stretch {
    double start_s{0.0};
    double end_s{0.0};
    std::string_view reason;
  };
  std::vector<Stretch> list_;
  std::uint64_t more_{0};
};

/// The first stretch of kLengthSeconds without a gap in which the truck really moves; where there
/// is none, the liveliest or, of a short record, the longest that there is. Bounded memory.
class MotionExcerpt {
 public:
  static constexpr double kLengthSeconds = 20.0;

  explicit MotionExcerpt(double sample_rate_hz);
  void take(const Motion& motion);
  /// Consecutive ticks; empty when there was no motion at all.
  [[nodiscard]] const std::vector<Motion>& best() const noexcept;

 private:
  static constexpr double kLivelyRmsMps = 4e-3;
  void judge();

  std::size_t length_;
  std::vector<Motion> current_;
  std::vector<Motion> best_;
  double current_sum_{0.0};  // of v^2, (m/s)^2
  double best_sum_{-1.0};
  bool settled_{false};
};

/// Notices channels that clip where nobody stated a full scale: motion reaches its largest value
/// once or twice, or, of coarse codes, less often than the next; a limiter again and again. That is
/// known only at the end, so it makes a warning, not an exclusion.
class ClippingWatch {
 public:
  void take(const Sample& sample) noexcept {
    ++samples_;
    for (std::size_t c = 0; c < kChannels; ++c) {
      if ((sample.saturated >> c & 1U) != 0U) continue;  // known, and excluded
      high_[c].take(sample.accel_mps2[c]);
      low_[c].take(-sample.accel_mps2[c]);
    }
  }
  /// One sentence for every channel that seems to clip.
  [[nodiscard]] std::vector<std::string> warnings() const;

 private:
  struct Extreme {
    double value{-std::numeric_limits<double>::infinity()};
    std::uint64_t hits{0};
    double next_value{-std::numeric_limits<double>::infinity()};  // the largest below it
    std::uint64_t next_hits{0};
    /// A value that is no number compares false and leaves everything as it is.
    void take(double x) noexcept {
      if (x > value) {
        next_value = value;
        next_hits = hits;
        value = x;
        hits = 1;
      } else if (x == value) {
        ++hits;
      } else if (x > next_value) {
        next_value = x;
        next_hits = 1;
      } else if (x == next_value) {
        ++next_hits;
      }
    }
  };
  std::array<Extreme, kChannels> high_{};
  std::array<Extreme, kChannels> low_{};
  std::uint64_t samples_{0};
};

}  // namespace dampline::app
