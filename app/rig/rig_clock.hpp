// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>

#include "app/rig/rig_source.hpp"
#include "dampline/rig/rig_sample.hpp"

namespace dampline::app {

/// Sample numbers from a record's own time column. Throws RunError naming record, line, what was
/// found and what was expected: time that does not advance, or a record whose time is not uniform
/// (more than kIrregularShare of the intervals off by more than kIrregularSamples; gaps of whole
/// samples are gaps, not irregular).
class RigClock {
 public:
  static constexpr double kIrregularSamples = 0.33;
  static constexpr double kIrregularShare = 0.01;

  RigClock(std::string record, double interval_s)
      : record_{std::move(record)}, interval_s_{interval_s} {}

  /// A row without a time counts as the next sample with no number in it.
  [[nodiscard]] RigSample sample(const RigLine& line);
  void check_uniform() const;

  [[nodiscard]] double interval_s() const noexcept { return interval_s_; }
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
  [[nodiscard]] double first_s() const noexcept { return first_s_; }
  /// Interval by the first and the last row; the one in use where there are too few.
  [[nodiscard]] double mean_interval_s() const noexcept;

 private:
  [[nodiscard]] std::int64_t advance(const RigLine& line);

  std::string record_;
  double interval_s_;
  std::uint64_t rows_{0};
  std::uint64_t irregular_{0};
  double irregular_s_{0.0};  ///< the first irregular interval
  std::uint64_t irregular_line_{0};
  bool started_{false};
  double first_s_{0.0};
  double last_s_{0.0};
  std::int64_t first_timed_tick_{0};
  std::int64_t last_timed_tick_{0};
  std::int64_t tick_{-1};
};

/// Median interval of the record's first rows. Throws RunError when there are too few.
[[nodiscard]] double measure_interval_s(const RigRecord& record);

}  // namespace dampline::app
