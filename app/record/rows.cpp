// SPDX-License-Identifier: MIT
#include "app/record/rows.hpp"

#include <algorithm>

#include "app/error.hpp"
#include "app/record/columns.hpp"

namespace dampline::app {

namespace {

constexpr std::size_t kWidth = std::tuple_size_v<TruckRows::Row>;
constexpr std::size_t kRowBatch = 512;
constexpr std::size_t kFirstRows = 4 * kRowBatch;
constexpr std::array<Column, kWidth> kRowColumns{Column::kTime,           Column::kFrameAccel,
                                                 Column::kWheelset1Accel, Column::kWheelset2Accel,
                                                 Column::kFrameEndAccel,  Column::kFarFrameAccel};

}  // namespace

TruckRows::TruckRows(const InputConfig& input, const std::array<bool, kExtras>& extras,
                     const SourceOptions& source) {
  std::vector<Column> wanted;
  for (std::size_t i = 0; i < kWidth; ++i) {
    scale_[i] = input.scale[index(kRowColumns[i])];
    if (i > kChannels && !extras[i - kChannels - 1]) continue;
    places_.push_back(i);
    wanted.push_back(kRowColumns[i]);
  }
  reader_ = open_rows(input, source, wanted, {});
  while (first_.size() < kFirstRows && read_batch(first_)) {
  }
}

double TruckRows::first_rate_hz() const {
  std::vector<double> steps;
  // A pipe gives batches of any size: the same rows have to tell the rate as in a file.
  const std::size_t rows = std::min(first_.size(), kFirstRows);
  for (std::size_t i = 1; i < rows; ++i) steps.push_back(first_[i][0] - first_[i - 1][0]);
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

bool TruckRows::read(std::vector<Row>& out) {
  if (first_.empty()) return read_batch(out);
  out.insert(out.end(), first_.begin(), first_.end());
  first_.clear();
  return true;
}

bool TruckRows::read_batch(std::vector<Row>& out) {
  const std::size_t width = places_.size();
  values_.resize(width * kRowBatch);
  const auto count = reader_->read(values_);
  if (!count.ok() && count.error() != Errc::kEndOfStream) throw RunError{reader_->error_text()};
  for (std::size_t row = 0; count.ok() && row < count.value(); ++row) {
    Row& scaled = out.emplace_back();
    for (std::size_t i = 0; i < width; ++i)
      scaled[places_[i]] = scale_[places_[i]] * values_[width * row + i];
  }
  return count.ok();
}

}  // namespace dampline::app
