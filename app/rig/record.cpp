// SPDX-License-Identifier: MIT
#include "app/rig/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "app/error.hpp"
#include "app/rig/consistent.hpp"
#include "app/rig/wrong.hpp"
#include "drivers/bytes/spool.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::app::rig {
namespace {

constexpr std::size_t kFirstRows = 2000;
constexpr std::size_t kFewestRows = 100;
constexpr double kLongestGapSamples = 1e12;

constexpr double kGapIntervals = 5.0;

using Lines = std::vector<Line>;

/// Rows that are in memory.
class MemorySource final : public Source {
 public:
  MemorySource(std::shared_ptr<const Lines> lines, std::shared_ptr<const Source> first,
               std::string note)
      : lines_{std::move(lines)}, first_{std::move(first)}, note_{std::move(note)} {}
  bool next(Line& line) override {
    if (next_ == lines_->size()) return false;
    line = (*lines_)[next_++];
    return true;
  }
  [[nodiscard]] bool has_velocity() const override { return first_->has_velocity(); }
  void report(RunResult& result) const override {
    first_->report(result);
    result.notes.push_back(note_);
  }

 private:
  std::shared_ptr<const Lines> lines_;
  std::shared_ptr<const Source> first_;  ///< that read the file
  std::string note_;
  std::size_t next_{0};
};

struct Times {
  double median_s{0.0};
  double least_s{0.0};  ///< but 0
  double irregular_share{0.0};
  double uneven_share{0.0};  ///< of the steps that are not one interval
  bool judged{false};  ///< false: too few, or time goes back or is missing, which Clock reports
};

double mean_step_s(const Lines& lines) {
  return (lines.back().time_s - lines.front().time_s) / static_cast<double>(lines.size() - 1);
}

Times times_of(const Lines& lines) {
  Times out;
  std::vector<double> steps;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const double step = lines[i].time_s - lines[i - 1].time_s;
    if (!(step >= 0.0)) return out;
    steps.push_back(step);
    if (step > 0.0 && (out.least_s == 0.0 || step < out.least_s)) out.least_s = step;
  }
  if (steps.size() < kFewestRows || out.least_s == 0.0) return out;
  out.median_s = median_of(steps);
  if (!(out.median_s > 0.0)) out.median_s = mean_step_s(lines);
  const auto share_off = [&](auto wanted) {
    const auto off = std::count_if(steps.begin(), steps.end(), [&](double step) {
      const double samples = step / out.median_s;
      return std::abs(samples - wanted(samples)) > Clock::kIrregularSamples;
    });
    return static_cast<double>(off) / static_cast<double>(steps.size());
  };
  out.irregular_share = share_off([](double x) { return std::max(1.0, std::round(x)); });
  out.uneven_share = share_off([](double) { return 1.0; });
  out.judged = true;
  return out;
}

/// Puts rounded times back onto their line. False: it is more than rounding.
bool straighten(Lines& lines, const Times& times) {
  const double start_s = lines.front().time_s;
  const double step_s = mean_step_s(lines);
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (std::abs(lines[i].time_s - start_s - step_s * static_cast<double>(i)) >
        1.01 * times.least_s)
      return false;
  for (std::size_t i = 0; i < lines.size(); ++i)
    lines[i].time_s = start_s + step_s * static_cast<double>(i);
  return true;
}

double slope(const Line& a, const Line& b) {
  return (b.deflection_m - a.deflection_m) / (b.time_s - a.time_s);
}

/// The deflection between two rows by a cubic with the slopes of their neighbours' parabolas,
/// everything else by a straight line: a force may jump.
Line between(const Lines& lines, std::size_t i, double time_s) {
  const Line& a = lines[i];
  const Line& b = lines[i + 1];
  const double h = b.time_s - a.time_s;
  const double u = (time_s - a.time_s) / h;
  Line out = a;
  out.time_s = time_s;
  const auto line = [u](double from, double to) { return from + u * (to - from); };
  out.velocity_mps = line(a.velocity_mps, b.velocity_mps);
  out.force_n = line(a.force_n, b.force_n);
  out.accel_mps2 = line(a.accel_mps2, b.accel_mps2);
  const double middle = slope(a, b);
  double left = middle;
  double right = middle;
  if (i > 0) {
    const double before = a.time_s - lines[i - 1].time_s;
    left = (h * slope(lines[i - 1], a) + before * middle) / (h + before);
  }
  if (i + 2 < lines.size()) {
    const double after = lines[i + 2].time_s - b.time_s;
    right = (h * slope(b, lines[i + 2]) + after * middle) / (h + after);
  }
  const double w = 1.0 - u;
  out.deflection_m = line(a.deflection_m, b.deflection_m) +
                     h * u * w * (w * (left - middle) - u * (right - middle));
  return out;
}

Lines resampled(const Lines& lines, double step_s) {
  Lines out;
  std::size_t i = 0;
  const double start_s = lines.front().time_s;
  for (std::size_t k = 0;; ++k) {
    const double time_s = start_s + step_s * static_cast<double>(k);
    while (i + 1 < lines.size() && lines[i + 1].time_s < time_s) ++i;
    if (i + 1 >= lines.size()) return out;
    if (lines[i + 1].time_s - lines[i].time_s > kGapIntervals * step_s) continue;
    out.push_back(between(lines, i, time_s));
  }
}

void check_advance(const std::string& name, const Lines& lines) {
  for (std::size_t i = 1; i < lines.size(); ++i)
    if (!(lines[i].time_s > lines[i - 1].time_s))
      throw RunError{fmt::format(
          "{}:{}: time_s: found {:.9g} s twice, expected time to advance (are digits missing?)",
          name, lines[i].line, lines[i].time_s)};
}

/// In the order of a row: those that a record must have go first.
constexpr std::array kOrder{Column::kDeflection, Column::kForce, Column::kTime, Column::kVelocity,
                            Column::kAccel};

drivers::RowFileConfig csv_config(const std::string& path, const InputConfig& input,
                                  bool skip_bad_lines) {
  drivers::RowFileConfig out;
  out.path = path;
  for (const Column column : kOrder) {
    const std::string canonical{name(column)};
    const bool required = column == Column::kDeflection || column == Column::kForce ||
                          (column == Column::kTime && !input.sample_rate_is_set);
    (required ? out.required : out.optional).push_back(canonical);
    if (!input.columns[index(column)].empty()) out.renamed[canonical] = input.header(column);
  }
  out.time_column.clear();  // rounded times may stand still; Clock judges them
  out.skip_bad_lines = skip_bad_lines;
  return out;
}

class CsvSource final : public Source {
 public:
  CsvSource(std::unique_ptr<drivers::RecordedRows> reader, const InputConfig& input)
      : reader_{std::move(reader)}, scale_{input.scale}, interval_s_{1.0 / input.sample_rate_hz} {}

  bool next(Line& line) override {
    std::array<double, kOrder.size()> row{};
    auto rows = reader_->read(row);
    while (rows && rows.value() == 0) rows = reader_->read(row);  // a pipe that has nothing yet
    if (!rows && rows.error() == Errc::kEndOfStream) return false;
    if (!rows) throw RunError{reader_->error_text()};
    line = {reader_->health().line, scaled(row, 2), scaled(row, 0),
            scaled(row, 3),         scaled(row, 1), scaled(row, 4)};
    if (!reader_->has(name(Column::kTime))) line.time_s = static_cast<double>(rows_) * interval_s_;
    ++rows_;
    return true;
  }

  [[nodiscard]] bool has_velocity() const override { return reader_->has(name(Column::kVelocity)); }

  void report(RunResult& result) const override {
    const hal::RowHealth health = reader_->health();
    if (health.malformed > 0) result.counts.emplace_back("lines_malformed", health.malformed);
    if (health.truncated)
      result.notes.emplace_back("The record was cut off in its last line, which was not used.");
    std::string ignored;
    for (const std::string& column : reader_->ignored_columns())
      ignored += (ignored.empty() ? "" : ", ") + column;
    if (!ignored.empty())
      result.notes.push_back(fmt::format("Columns that were not used: {}.", ignored));
  }

 private:
  [[nodiscard]] double scaled(const std::array<double, kOrder.size()>& row, std::size_t i) const {
    return row[i] * scale_[index(kOrder[i])];
  }

  std::unique_ptr<drivers::RecordedRows> reader_;
  std::array<double, kColumns> scale_;
  double interval_s_;  ///< where the record has no time
  std::uint64_t rows_{0};
};

}  // namespace

double median_of(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::int64_t Clock::advance(const Line& line) {
  if (!started_) {
    started_ = true;
    first_s_ = line.time_s;
    last_s_ = line.time_s;
    first_timed_tick_ = tick_ + 1;
    return last_timed_tick_ = first_timed_tick_;
  }
  const double samples = (line.time_s - last_s_) / interval_s_;
  if (!(samples > 0.0) || samples > kLongestGapSamples)
    throw RunError{
        fmt::format("{}:{}: time_s: found {:.9g} s after {:.9g} s, expected time to advance",
                    record_, line.line, line.time_s, last_s_)};
  const double whole = std::max(1.0, std::round(samples));
  if (std::abs(samples - whole) > kIrregularSamples) {
    ++irregular_;
    if (irregular_ == 1) {
      irregular_line_ = line.line;
      irregular_s_ = line.time_s - last_s_;
    }
  }
  last_s_ = line.time_s;
  return last_timed_tick_ += static_cast<std::int64_t>(whole);
}

core::Sample Clock::sample(const Line& line) {
  ++rows_;
  core::Sample out{0, line.deflection_m, line.velocity_mps, line.force_n};
  if (std::isfinite(line.time_s)) {
    tick_ = std::max(advance(line), tick_);
  } else {
    ++tick_;
    out.deflection_m = std::numeric_limits<double>::quiet_NaN();
  }
  out.tick = tick_;
  return out;
}

void Clock::check_uniform() const {
  if (static_cast<double>(irregular_) <= kIrregularShare * static_cast<double>(rows_)) return;
  throw RunError{fmt::format(
      "{}: time_s: {} of {} intervals are irregular, the first at line {} with {:.6g} s; expected "
      "whole multiples of {:.6g} s (resample the record at a uniform rate)",
      record_, irregular_, rows_, irregular_line_, irregular_s_, interval_s_)};
}

double Clock::mean_interval_s() const noexcept {
  const auto intervals = static_cast<double>(last_timed_tick_ - first_timed_tick_);
  return intervals > 0.0 ? (last_s_ - first_s_) / intervals : interval_s_;
}

double measure_interval_s(const Record& record) {
  const auto source = record.open();
  std::vector<double> intervals;
  double last_s = std::numeric_limits<double>::quiet_NaN();
  Line line;
  std::size_t rows = 0;
  for (; rows < kFirstRows && source->next(line); ++rows) {
    const double interval_s = line.time_s - last_s;
    if (interval_s > 0.0) intervals.push_back(interval_s);
    if (std::isfinite(line.time_s)) last_s = line.time_s;
  }
  if (intervals.size() < kFewestRows)
    throw RunError{fmt::format("{}: found {} rows whose time advances, expected at least {}",
                               record.name, intervals.size(), kFewestRows)};
  return median_of(intervals);
}

Record uniform_record(Record record) {
  const std::shared_ptr<Source> source = record.open();
  auto lines = std::make_shared<Lines>();
  for (Line line; source->next(line);) lines->push_back(line);
  const Times times = times_of(*lines);
  if (!times.judged || times.uneven_share <= Clock::kIrregularShare) return record;
  if (straighten(*lines, times)) {
    record.notes.emplace_back("The times are rounded: they were put onto a straight line.");
  } else if (times.irregular_share <= Clock::kIrregularShare) {
    return record;  // with gaps of whole samples
  } else {
    check_advance(record.name, *lines);
    const double step_s = std::min(times.median_s, mean_step_s(*lines));
    *lines = resampled(*lines, step_s);
    record.notes.push_back(fmt::format(
        "The times are not uniform ({:.0f} % of the intervals): resampled every {:.4g} ms.",
        100.0 * times.irregular_share, 1e3 * step_s));
  }
  record.open = [lines, source, note = record.notes.back()]() -> std::unique_ptr<Source> {
    return std::make_unique<MemorySource>(lines, source, note);
  };
  return record;
}

Record csv_record(const std::string& path, const InputConfig& input, bool skip_bad_lines) {
  const auto file = drivers::spooled(path);
  if (!file) throw RunError{file.error_text()};
  const auto config = csv_config(file.value(), input, skip_bad_lines);
  const auto open = [config, input]() -> std::unique_ptr<Source> {
    auto reader = drivers::open_rows(config);
    if (!reader) throw RunError{reader.error_text()};
    return std::make_unique<CsvSource>(std::move(reader.value()), input);
  };
  return consistent_record(uniform_record(screened_record({path, open}, skip_bad_lines)));
}

}  // namespace dampline::app::rig
