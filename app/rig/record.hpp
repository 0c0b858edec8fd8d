// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/run/result.hpp"
#include "dampline/rig/motion.hpp"

namespace dampline::app::rig {

namespace core = dampline::rig;

/// One row of a rig's record in canonical units. A value that is not there is NaN.
struct Line {
  std::uint64_t line{0};  ///< of the file, from 1; 0: not known
  double time_s{0.0};
  double deflection_m{0.0};
  double velocity_mps{std::numeric_limits<double>::quiet_NaN()};
  double force_n{0.0};
  double accel_mps2{std::numeric_limits<double>::quiet_NaN()};
};

/// A rig's record, row by row.
class Source {
 public:
  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  virtual ~Source() = default;
  /// False at the end. Throws RunError naming file and line for a row that cannot be read.
  virtual bool next(Line& line) = 0;
  [[nodiscard]] virtual bool has_velocity() const = 0;
  /// At the end: what was skipped, cut off or not used, into the result's counts and notes.
  virtual void report(RunResult& result) const = 0;
};

/// The middle value, of an even number the upper one. Precondition: there is one.
[[nodiscard]] double median_of(std::vector<double>& values);

/// A record is read several times; each call starts it from its beginning.
struct Record {
  std::string name;  ///< what errors call it
  std::function<std::unique_ptr<Source>()> open;
  std::vector<std::string> notes{};  ///< what was done to the rows, a sentence each
  double force_sign{1.0};            ///< -1: the force was turned
  DataFaults faults{};               ///< wrong values and times that were taken out of the rows
};

/// A rig's record in a CSV file, its columns and scales as [input.columns] and [input.scale] say.
/// Opening throws RunError naming the file and the column that is missing; reading, file and line.
/// Standard input is copied first, as it is read several times.
[[nodiscard]] Record csv_record(const std::string& path, const InputConfig& input,
                                bool skip_bad_lines);

/// Sample numbers from a record's own time column. Throws RunError naming record, line, what was
/// found and what was expected: time that does not advance, or a record whose time is not uniform
/// (more than kIrregularShare of the intervals off by more than kIrregularSamples; gaps of whole
/// samples are gaps, not irregular).
class Clock {
 public:
  static constexpr double kIrregularSamples = 0.33;
  static constexpr double kIrregularShare = 0.01;

  Clock(std::string record, double interval_s)
      : record_{std::move(record)}, interval_s_{interval_s} {}

  /// A row without a time counts as the next sample with no number in it.
  [[nodiscard]] core::Sample sample(const Line& line);
  void check_uniform() const;

  [[nodiscard]] double interval_s() const noexcept { return interval_s_; }
  [[nodiscard]] std::uint64_t rows() const noexcept { return rows_; }
  /// First and last row, where their times are dates.
  [[nodiscard]] RecordedSpan recorded() const { return recorded_span_s(first_s_, last_s_); }
  /// Interval by the first and the last row; the one in use where there are too few.
  [[nodiscard]] double mean_interval_s() const noexcept;

 private:
  [[nodiscard]] std::int64_t advance(const Line& line);

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
[[nodiscard]] double measure_interval_s(const Record& record);

/// The record at uniform times. Times that only rounding keeps from a straight line are put onto
/// it; others are resampled at their median interval, gaps stay gaps. What is uniform as it is, but
/// for gaps of whole samples, comes back unread. Throws RunError naming the line where time stands
/// still.
[[nodiscard]] Record uniform_record(Record record);

}  // namespace dampline::app::rig
