// SPDX-License-Identifier: MIT
#include "app/rig/csv_rig_source.hpp"

#include <fmt/format.h>

#include <array>
#include <memory>
#include <utility>

#include "app/error.hpp"
#include "app/rig/uniform_record.hpp"
#include "drivers/csv/reader.hpp"

namespace dampline::app {
namespace {

using drivers::CsvReader;

/// In the order of a row: those that a record must have go first.
constexpr std::array kOrder{Column::kDeflection, Column::kForce, Column::kTime, Column::kVelocity,
                            Column::kAccel};

drivers::CsvConfig csv_config(const std::string& path, const InputConfig& input,
                              bool skip_bad_lines) {
  drivers::CsvConfig out;
  out.path = path;
  for (const Column column : kOrder) {
    const std::string canonical{name(column)};
    const bool required = column == Column::kDeflection || column == Column::kForce ||
                          (column == Column::kTime && !input.sample_rate_is_set);
    (required ? out.required : out.optional).push_back(canonical);
    if (!input.columns[index(column)].empty()) out.renamed[canonical] = input.header(column);
  }
  out.time_column.clear();  // rounded times may stand still; RigClock judges them
  out.skip_bad_lines = skip_bad_lines;
  return out;
}

class CsvRigSource final : public RigSource {
 public:
  CsvRigSource(std::unique_ptr<CsvReader> reader, const InputConfig& input)
      : reader_{std::move(reader)}, scale_{input.scale}, interval_s_{1.0 / input.sample_rate_hz} {}

  bool next(RigLine& line) override {
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

  std::unique_ptr<CsvReader> reader_;
  std::array<double, kColumns> scale_;
  double interval_s_;  ///< where the record has no time
  std::uint64_t rows_{0};
};

}  // namespace

RigRecord csv_rig_record(const std::string& path, const InputConfig& input, bool skip_bad_lines) {
  const auto config = csv_config(path, input, skip_bad_lines);
  if (path == "-")
    throw RunError{
        "-: a rig's record is read several times and cannot come from standard input; expected a "
        "file"};
  return uniform_record({path, [config, input]() -> std::unique_ptr<RigSource> {
                           auto reader = CsvReader::open(config);
                           if (!reader) throw RunError{reader.error_text()};
                           return std::make_unique<CsvRigSource>(std::move(reader.value()), input);
                         }});
}

}  // namespace dampline::app
