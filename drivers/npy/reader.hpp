// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/bytes/file_range.hpp"
#include "drivers/npy/header.hpp"
#include "drivers/record/rows.hpp"

namespace dampline::drivers {

/// NumPy's .npy and .npz as a source of rows. Of one array: its fields are the columns by name
/// where it is structured, else "1", "2", ... Of .npz, stored or deflated: each array of the most
/// rows is a column, called as it, or "NAME_1", "NAME_2", ... where it has several; others are left
/// out. Whole numbers, real ones of 4 or 8 bytes and times (datetime64, as s from the first row) of
/// either byte order, by row or by column. In constant memory: one buffer a column. A file that
/// holds less than it says sets truncated.
class NpyReader final : public RecordedRows {
 public:
  static Outcome<std::unique_ptr<RecordedRows>> open(const RowFileConfig& config,
                                                     RecordFormat format);
  [[nodiscard]] std::optional<double> share_read() const noexcept override {
    return rows_ == 0 ? 1.0 : static_cast<double>(row_) / static_cast<double>(rows_);
  }

 private:
  /// Rows of a fixed length, one behind the other, with some of the columns.
  struct Strand {
    FileRange range;
    std::size_t row_bytes{0};
    std::uint64_t rows{0};
    std::vector<NpyField> columns;
  };
  explicit NpyReader(const RowFileConfig& config) : RecordedRows{config}, name_{config.path} {}
  [[nodiscard]] Step read_one(std::span<double> row) noexcept override;
  [[nodiscard]] Outcome<bool> take_array(const std::shared_ptr<RandomFile>& file,
                                         std::uint64_t begin, std::uint64_t bytes, bool deflated,
                                         const std::string& name);
  [[nodiscard]] Outcome<bool> take_archive(const std::shared_ptr<RandomFile>& file);
  void keep_longest();
  [[nodiscard]] bool read_row(std::span<double> row) noexcept;

  std::string name_;
  std::vector<Strand> strands_;
  std::vector<NpyType::Kind> kinds_;            // by column of the header
  std::vector<std::optional<double>> first_s_;  // of columns that are times
  std::uint64_t rows_{0};
  std::uint64_t row_{0};
};

}  // namespace dampline::drivers
