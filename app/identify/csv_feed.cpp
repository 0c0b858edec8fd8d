// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "app/error.hpp"
#include "app/identify/csv_columns.hpp"
#include "app/identify/rate_correction.hpp"
#include "app/identify/row_clock.hpp"
#include "app/identify/sample_feed.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kWidth = 1 + kChannels;  // time and three accelerations
constexpr std::size_t kFirstRows = 2000;       // for the record's own rate
constexpr std::array<Column, kWidth> kTruckColumns{
    Column::kTime, Column::kFrameAccel, Column::kWheelset1Accel, Column::kWheelset2Accel};

/// The rate from the median step; 0 from fewer than three rows.
double median_rate_hz(const std::vector<double>& rows, double time_scale) {
  std::vector<double> steps;
  for (std::size_t i = kWidth; i + kWidth <= rows.size(); i += kWidth)
    steps.push_back(time_scale * (rows[i] - rows[i - kWidth]));
  if (steps.size() < 2) return 0.0;
  // Rounded times make unequal steps whose median is off, so the steps near the median are
  // averaged.
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const double median = *middle;
  double sum = 0.0;
  double count = 0.0;
  for (const double step : steps) {
    if (!(step < 1.5 * median)) continue;
    sum += step;
    count += 1.0;
  }
  return count / sum;
}

class CsvFeed final : public SampleFeed {
 public:
  CsvFeed(const Config& config, std::unique_ptr<drivers::CsvReader> reader, const std::string& path)
      : config_{config.input}, reader_{std::move(reader)} {
    read_first_rows();
    const double time_scale = config_.scale[index(Column::kTime)];
    const MeasuredRate rate{median_rate_hz(rows_, time_scale), 0.0, rows_.size() / kWidth};
    static_cast<void>(make_correction(rate, config_.sample_rate_hz, path));
    clock_ = RowClock{rate.rate_hz > 0.0 ? rate.rate_hz : config_.sample_rate_hz};
  }

  bool read(std::vector<Sample>& out) override {
    bool more = true;
    if (rows_.empty()) more = read_rows(kBatch);
    for (std::size_t i = 0; i + kWidth <= rows_.size(); i += kWidth)
      out.push_back(to_sample(&rows_[i]));
    rows_.clear();
    return more;
  }
  [[nodiscard]] MeasuredRate rate() const override { return clock_.rate(); }
  [[nodiscard]] ScreenConfig screen() const override {
    ScreenConfig screen;
    const auto& range = config_.range_mps2;
    screen.find_flat_tops = !std::all_of(range.begin(), range.end(),
                                         [](const auto& limit) { return limit.has_value(); });
    return screen;
  }
  [[nodiscard]] std::uint64_t lines() const override { return reader_->health().line; }
  [[nodiscard]] std::string explain_emptiness() const override {
    return fmt::format("{} rows, {} malformed lines skipped", reader_->health().rows,
                       reader_->health().malformed);
  }
  void describe(RunResult& result) const override { describe_csv(*reader_, result); }

 private:
  static constexpr std::size_t kBatch = 512;

  void read_first_rows() {
    std::vector<double> first;
    while (first.size() < kWidth * kFirstRows && read_rows(kBatch))
      first.insert(first.end(), rows_.begin(), rows_.end());
    rows_ = std::move(first);
  }
  /// Fills rows_; false at the end.
  bool read_rows(std::size_t most) {
    rows_.resize(kWidth * most);
    const auto count = reader_->read(rows_);
    rows_.resize(count.ok() ? kWidth * count.value() : 0);
    if (!count.ok() && count.error() != Errc::kEndOfStream) throw RunError{reader_->error_text()};
    return count.ok();
  }
  [[nodiscard]] Sample to_sample(const double* row) {
    const RowClock::Stamp stamp = clock_.next(config_.scale[index(Column::kTime)] * row[0]);
    Sample sample{stamp.tick, stamp.time_ns, {}, 0};
    for (std::size_t c = 0; c < kChannels; ++c) {
      const double accel = config_.scale[index(kTruckColumns[c + 1])] * row[c + 1];
      sample.accel_mps2[c] = accel;
      if (config_.range_mps2[c] && std::fabs(accel) >= *config_.range_mps2[c])
        sample.saturated = static_cast<std::uint8_t>(sample.saturated | (1U << c));
    }
    return sample;
  }

  InputConfig config_;
  std::unique_ptr<drivers::CsvReader> reader_;
  std::vector<double> rows_;  // read but not yet handed on
  RowClock clock_{1.0};
};

}  // namespace

std::unique_ptr<SampleFeed> open_csv_feed(const Config& config, const SourceOptions& source) {
  auto reader = open_csv(config.input, source, kTruckColumns, {});
  return std::make_unique<CsvFeed>(config, std::move(reader), source.path);
}

}  // namespace dampline::app
