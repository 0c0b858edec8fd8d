// SPDX-License-Identifier: MIT
#include "drivers/mat/reader.hpp"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/bytes/spool.hpp"
#include "drivers/compressed/decompressor.hpp"
#include "drivers/mat/whole.hpp"
#include "drivers/record/column_file.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kMostVariables = 4096;

using Variable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;
using File = std::unique_ptr<mat_t, int (*)(mat_t*)>;

/// An array of numbers as rows and columns.
struct Array {
  std::string variable;
  std::string field;  ///< of it; empty: the variable itself
  std::uint64_t rows{0};
  std::size_t columns{1};
  [[nodiscard]] std::string name() const {
    return field.empty() ? variable : variable + "." + field;
  }
};

bool is_number(const matvar_t& variable) {
  const auto kind = variable.class_type;
  const bool number =
      kind == MAT_C_DOUBLE || kind == MAT_C_SINGLE || (kind >= MAT_C_INT8 && kind <= MAT_C_UINT64);
  return number && variable.isComplex == 0 && variable.rank == 2 && variable.dims != nullptr;
}

std::optional<Array> array_of(const matvar_t& variable) {
  if (!is_number(variable)) return std::nullopt;
  std::uint64_t rows = variable.dims[0];
  std::uint64_t columns = variable.dims[1];
  if (rows == 1) std::swap(rows, columns);
  if (rows == 0 || columns == 0 || columns > kMostColumns) return std::nullopt;
  Array out;
  out.rows = rows;
  out.columns = static_cast<std::size_t>(columns);
  return out;
}

template <class T>
void copy_numbers(const matvar_t& variable, std::uint64_t first, std::vector<double>& out) {
  const auto* const numbers = static_cast<const T*>(variable.data) + first;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<double>(numbers[i]);
}

/// One column of an array that was read.
std::vector<double> column_of(const matvar_t& variable, const Array& array, std::size_t column) {
  std::vector<double> out(static_cast<std::size_t>(array.rows));
  const std::uint64_t first = column * array.rows;
  switch (variable.data_type) {
    case MAT_T_DOUBLE:
      copy_numbers<double>(variable, first, out);
      break;
    case MAT_T_SINGLE:
      copy_numbers<float>(variable, first, out);
      break;
    case MAT_T_INT8:
      copy_numbers<std::int8_t>(variable, first, out);
      break;
    case MAT_T_UINT8:
      copy_numbers<std::uint8_t>(variable, first, out);
      break;
    case MAT_T_INT16:
      copy_numbers<std::int16_t>(variable, first, out);
      break;
    case MAT_T_UINT16:
      copy_numbers<std::uint16_t>(variable, first, out);
      break;
    case MAT_T_INT32:
      copy_numbers<std::int32_t>(variable, first, out);
      break;
    case MAT_T_UINT32:
      copy_numbers<std::uint32_t>(variable, first, out);
      break;
    case MAT_T_INT64:
      copy_numbers<std::int64_t>(variable, first, out);
      break;
    case MAT_T_UINT64:
      copy_numbers<std::uint64_t>(variable, first, out);
      break;
    default:
      return {};
  }
  return out;
}

class MatReader final : public RecordedRows {
 public:
  MatReader(const RowFileConfig& config, File file, std::uint64_t file_bytes)
      : RecordedRows{config},
        file_name_{config.path == "-" ? "standard input" : config.path},
        file_{std::move(file)},
        file_bytes_{file_bytes} {}

  [[nodiscard]] Outcome<bool> prepare(const RowFileConfig& config) {
    find_arrays();
    for (const Array& array : arrays_) rows_ = std::max(rows_, array.rows);
    std::erase_if(arrays_, [this](const Array& array) { return array.rows != rows_; });
    for (const Array& array : arrays_)
      for (std::size_t c = 0; c < array.columns; ++c)
        header_.push_back(array.columns == 1 ? array.name()
                                             : fmt::format("{}_{}", array.name(), c + 1));
    if (header_.empty())
      return refuse(
          "holds no array of numbers (tables and timeseries are objects: save their "
          "columns as arrays or in a structure)");
    if (auto chosen = choose_columns(config, file_name_); !chosen) return chosen;
    columns_.resize(names_.size());
    return load();
  }
  [[nodiscard]] std::optional<double> share_read() const noexcept override {
    return static_cast<double>(row_) / static_cast<double>(rows_);
  }

 private:
  [[nodiscard]] Failure refuse(std::string_view what) const {
    return {Errc::kMalformed, fmt::format("{}: {}", file_name_, what)};
  }

  void find_arrays() {
    for (std::size_t count = 0; count < kMostVariables; ++count) {
      const Variable variable{Mat_VarReadNextInfo(file_.get()), Mat_VarFree};
      if (!variable) return;
      if (variable->name == nullptr) continue;
      if (variable->class_type == MAT_C_STRUCT) {
        add_fields(*variable);
      } else if (auto array = array_of(*variable)) {
        array->variable = variable->name;
        arrays_.push_back(std::move(*array));
      }
    }
  }
  void add_fields(const matvar_t& variable) {
    if (variable.rank != 2 || variable.dims == nullptr || variable.dims[0] * variable.dims[1] != 1)
      return;
    const std::span fields{Mat_VarGetStructFieldnames(&variable),
                           Mat_VarGetNumberOfFields(const_cast<matvar_t*>(&variable))};
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const matvar_t* const field =
          Mat_VarGetStructFieldByIndex(const_cast<matvar_t*>(&variable), i, 0);
      auto array = field == nullptr ? std::nullopt : array_of(*field);
      if (!array || fields[i] == nullptr) continue;
      array->variable = variable.name;
      array->field = fields[i];
      arrays_.push_back(std::move(*array));
    }
  }

  /// Reads what was asked for.
  [[nodiscard]] Outcome<bool> load() {
    std::size_t column = 0;
    for (const Array& array : arrays_) {
      const auto* const places = place_of_.data() + column;
      column += array.columns;
      if (std::all_of(places, places + array.columns, [](std::size_t p) { return p == kUnused; }))
        continue;
      if (array.rows * array.columns / kMostDeflation > file_bytes_)
        return refuse("is damaged or cut off: it is too short for what it says");
      if (!load(array, places))
        return refuse(
            fmt::format("{} cannot be read: the file is damaged or cut off", array.name()));
    }
    return true;
  }
  [[nodiscard]] bool load(const Array& array, const std::size_t* places) {
    const Variable variable{Mat_VarRead(file_.get(), array.variable.c_str()), Mat_VarFree};
    if (!variable) return false;
    const matvar_t* numbers = variable.get();
    if (!array.field.empty())
      numbers = variable->class_type != MAT_C_STRUCT
                    ? nullptr
                    : Mat_VarGetStructFieldByName(variable.get(), array.field.c_str(), 0);
    if (numbers == nullptr || numbers->data == nullptr) return false;
    const auto again = array_of(*numbers);
    if (!again || again->rows != array.rows || again->columns != array.columns ||
        numbers->nbytes / Mat_SizeOf(numbers->data_type) < array.rows * array.columns)
      return false;
    for (std::size_t c = 0; c < array.columns; ++c) {
      if (places[c] == kUnused) continue;
      columns_[places[c]] = column_of(*numbers, array, c);
      if (columns_[places[c]].empty()) return false;
    }
    return true;
  }

  [[nodiscard]] Step read_one(std::span<double> row) noexcept override {
    if (row_ == rows_) return stop(Errc::kEndOfStream, {});
    for (std::size_t i = 0; i < row.size(); ++i)
      row[i] = columns_[i].empty() ? std::numeric_limits<double>::quiet_NaN()
                                   : columns_[i][static_cast<std::size_t>(row_)];
    health_.line = ++row_;
    const std::string fault = check_time(row);
    if (fault.empty()) return Step::kRow;
    return bad_row(fmt::format("{}: row {}: {}", file_name_, row_, fault));
  }

  std::string file_name_;
  File file_;
  std::uint64_t file_bytes_;
  std::vector<Array> arrays_;
  std::vector<std::vector<double>> columns_;  // by place in the row; empty: the file has none
  std::uint64_t rows_{0};
  std::uint64_t row_{0};
};

}  // namespace

Outcome<std::unique_ptr<RecordedRows>> open_mat(const RowFileConfig& config) {
  const auto path = spooled(config.path);
  if (!path) return path.failure();
  const auto bytes = RandomFile::open(path.value());
  if (!bytes) return bytes.failure();
  if (const std::string fault = fault_of_mat(*bytes.value()); !fault.empty())
    return Failure{Errc::kMalformed, fmt::format("{}: {}", config.path, fault)};
  // What it would print is told by errors here.
  Mat_LogInitFunc("dampline", [](int /*level*/, char* /*message*/) {});
  File file{Mat_Open(path.value().c_str(), MAT_ACC_RDONLY), Mat_Close};
  if (!file)
    return Failure{Errc::kMalformed,
                   fmt::format("{}: is a MAT file that is damaged or cut off", config.path)};
  auto out = std::make_unique<MatReader>(config, std::move(file), bytes.value()->size());
  if (const auto ready = out->prepare(config); !ready) return ready.failure();
  return std::unique_ptr<RecordedRows>{std::move(out)};
}

}  // namespace dampline::drivers
