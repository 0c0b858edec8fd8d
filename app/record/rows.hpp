// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "app/config/config.hpp"
#include "app/record/feed.hpp"
#include "app/run/provenance.hpp"
#include "dampline/sample.hpp"
#include "dampline/sample/ticks.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::app {

/// Rows of a recording with a truck's time (s), three accelerations and those of the extras that
/// are wanted (m/s^2; else 0). Throws RunError with file and line.
class TruckRows {
 public:
  using Row = std::array<double, 1 + kChannels + kExtras>;

  TruckRows(const InputConfig& input, const std::array<bool, kExtras>& extras,
            const SourceOptions& source);

  /// The record's own rate by the time of its first rows, which are still handed on; 0: too few.
  [[nodiscard]] double first_rate_hz() const;
  /// Appends a batch; false at the end.
  bool read(std::vector<Row>& out);
  [[nodiscard]] const drivers::RecordedRows& reader() const noexcept { return *reader_; }

 private:
  bool read_batch(std::vector<Row>& out);

  std::vector<std::size_t> places_;  // in a row, of the columns that are read
  Row scale_{};
  std::unique_ptr<drivers::RecordedRows> reader_;
  std::vector<double> values_;
  std::vector<Row> first_;  // read but not yet handed on
};

/// Sample numbers of rows that carry only a time: each row gets the tick at which the line through
/// the rows before it expects its time, so that rounding and jitter of the times do not make gaps.
/// A tick that is jumped over is a lost row.
class RowClock {
 public:
  /// `rate_hz` is the record's own, from its first rows.
  explicit RowClock(double rate_hz)
      : rate_hz_{rate_hz}, line_{rate_hz, kPeriodRange}, meter_{rate_hz} {}

  struct Stamp {
    std::int64_t tick{0};
    std::int64_t time_ns{0};  ///< from the first row
  };
  /// Precondition: times increase.
  Stamp next(double time_s) {
    newest_time_s_ = time_s;
    if (!first_time_s_) {
      first_time_s_ = time_s;
      line_.start(0, 0);
      meter_.update(0, 0);
      return {};
    }
    const auto time_ns = static_cast<std::int64_t>(std::llround(1e9 * (time_s - *first_time_s_)));
    const auto due = static_cast<std::int64_t>(std::llround(line_.tick_at(time_ns)));
    const std::int64_t tick = std::max(due, tick_ + 1);
    if (static_cast<double>(tick - tick_) > kLongGapSeconds * rate_hz_) meter_.begin_segment();
    line_.update(tick, time_ns);
    meter_.update(tick, time_ns);
    tick_ = tick;
    return {tick, time_ns};
  }
  [[nodiscard]] MeasuredRate rate() const { return meter_.measured(); }
  /// First and newest row, where their times are dates.
  [[nodiscard]] RecordedSpan recorded() const {
    return first_time_s_ ? recorded_span_s(*first_time_s_, newest_time_s_) : RecordedSpan{};
  }

 private:
  static constexpr double kPeriodRange = 0.02;
  static constexpr double kLongGapSeconds =
      3.0;  // over which the line does not know the tick exactly
  double rate_hz_;
  TickLine line_;
  RateMeter meter_;
  std::optional<double> first_time_s_;
  double newest_time_s_{0.0};
  std::int64_t tick_{0};
};

}  // namespace dampline::app
