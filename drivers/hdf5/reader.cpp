// SPDX-License-Identifier: MIT
#include "drivers/hdf5/reader.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/bytes/spool.hpp"
#include "drivers/hdf5/handle.hpp"
#include "drivers/record/column_file.hpp"

namespace dampline::drivers {
namespace {

constexpr std::size_t kMostSets = 1024;
constexpr std::size_t kPieceNumbers = 16384;  // of a data set at once

using Handle = Hdf5Handle;

/// A data set of numbers as rows and columns.
struct Set {
  std::string name;
  Handle handle;
  std::uint64_t rows{0};
  std::size_t columns{1};
  bool one_row{false};  // 1 x N, as MATLAB's columns lie there
  int dimensions{1};
  std::vector<double> piece;  // rows of it that were read
  std::uint64_t piece_begin{0};
  std::uint64_t piece_rows{0};
};

bool has_numbers(hid_t set) {
  const Handle type{H5Dget_type(set), H5Tclose};
  const H5T_class_t kind = H5Tget_class(type.id());
  return kind == H5T_FLOAT || kind == H5T_INTEGER;
}

std::optional<Set> open_set(hid_t file, const std::string& name) {
  Handle handle{H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose};
  if (!handle.ok() || !has_numbers(handle.id())) return std::nullopt;
  const Handle space{H5Dget_space(handle.id()), H5Sclose};
  const int dimensions = H5Sget_simple_extent_ndims(space.id());
  if (dimensions < 1 || dimensions > 2) return std::nullopt;
  std::array<hsize_t, 2> sizes{1, 1};
  H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr);
  const bool one_row = dimensions == 2 && sizes[0] == 1 && sizes[1] > 1;
  if (one_row) std::swap(sizes[0], sizes[1]);
  if (sizes[0] == 0 || sizes[1] == 0 || sizes[1] > kMostColumns) return std::nullopt;
  return Set{name,    std::move(handle), sizes[0], static_cast<std::size_t>(sizes[1]),
             one_row, dimensions,        {},       0,
             0};
}

struct Names {
  std::vector<std::string> list;
};

herr_t take_name(hid_t /*file*/, const char* name, const H5O_info_t* info, void* data) {
  auto& names = *static_cast<Names*>(data);
  if (info->type == H5O_TYPE_DATASET && names.list.size() < kMostSets)
    names.list.emplace_back(name);
  return 0;
}

class Hdf5Reader final : public RecordedRows {
 public:
  Hdf5Reader(const RowFileConfig& config, Handle file)
      : RecordedRows{config}, file_name_{config.path}, file_{std::move(file)} {}

  [[nodiscard]] Outcome<bool> prepare(const RowFileConfig& config) {
    Names names;
    H5Ovisit2(file_.id(), H5_INDEX_NAME, H5_ITER_INC, take_name, &names, H5O_INFO_BASIC);
    for (const std::string& name : names.list) {
      if (auto set = open_set(file_.id(), name)) sets_.push_back(std::move(*set));
    }
    for (const Set& set : sets_) rows_ = std::max(rows_, set.rows);
    for (const Set& set : sets_) {
      if (set.rows != rows_) continue;  // settings, not columns
      for (std::size_t c = 0; c < set.columns; ++c)
        header_.push_back(set.columns == 1 ? set.name : fmt::format("{}_{}", set.name, c + 1));
    }
    if (header_.empty())
      return Failure{Errc::kMalformed,
                     fmt::format("{}: holds no data set of numbers in rows", file_name_)};
    return choose_columns(config, file_name_);
  }
  [[nodiscard]] std::optional<double> share_read() const noexcept override {
    return static_cast<double>(row_) / static_cast<double>(rows_);
  }

 private:
  /// The numbers of `row`; null where they cannot be read.
  static const double* numbers(Set& set, std::uint64_t row) {
    if (row >= set.piece_begin && row < set.piece_begin + set.piece_rows)
      return &set.piece[static_cast<std::size_t>(row - set.piece_begin) * set.columns];
    const std::uint64_t most = std::max<std::uint64_t>(1, kPieceNumbers / set.columns);
    const std::uint64_t count = std::min(most, set.rows - row);
    std::array<hsize_t, 2> begin{row, 0};
    std::array<hsize_t, 2> size{count, set.columns};
    if (set.one_row) {
      std::swap(begin[0], begin[1]);
      std::swap(size[0], size[1]);
    }
    set.piece.resize(static_cast<std::size_t>(count) * set.columns);
    const Handle space{H5Dget_space(set.handle.id()), H5Sclose};
    const Handle memory{H5Screate_simple(set.dimensions, size.data(), nullptr), H5Sclose};
    set.piece_rows = 0;
    if (H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, begin.data(), nullptr, size.data(),
                            nullptr) < 0 ||
        H5Dread(set.handle.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT,
                set.piece.data()) < 0)
      return nullptr;
    set.piece_begin = row;
    set.piece_rows = count;
    return set.piece.data();
  }

  [[nodiscard]] bool read_row(std::span<double> row) {
    std::fill(row.begin(), row.end(), std::numeric_limits<double>::quiet_NaN());
    std::size_t column = 0;
    for (Set& set : sets_) {
      if (set.rows != rows_) continue;
      const auto* const places = place_of_.data() + column;
      column += set.columns;
      if (std::all_of(places, places + set.columns, [](std::size_t p) { return p == kUnused; }))
        continue;
      const double* values = numbers(set, row_);
      if (values == nullptr) return false;
      for (std::size_t c = 0; c < set.columns; ++c)
        if (places[c] != kUnused) row[places[c]] = values[c];
    }
    return true;
  }

  [[nodiscard]] Step read_one(std::span<double> row) noexcept override {
    if (row_ == rows_) return stop(Errc::kEndOfStream, {});
    if (!read_row(row))
      return stop(Errc::kMalformed,
                  fmt::format("{}: row {}: cannot be read: the file is damaged or cut off",
                              file_name_, row_ + 1));
    health_.line = ++row_;
    const std::string fault = check_time(row);
    if (fault.empty()) return Step::kRow;
    return bad_row(fmt::format("{}: row {}: {}", file_name_, row_, fault));
  }

  std::string file_name_;
  Handle file_;
  std::vector<Set> sets_;
  std::uint64_t rows_{0};
  std::uint64_t row_{0};
};

}  // namespace

Outcome<std::unique_ptr<RecordedRows>> open_hdf5(const RowFileConfig& config) {
  const auto path = spooled(config.path);
  if (!path) return path.failure();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // what it would print is told by errors here
  Handle file{H5Fopen(path.value().c_str(), H5F_ACC_RDONLY, hdf5_access().id()), H5Fclose};
  if (!file.ok())
    return Failure{Errc::kMalformed,
                   fmt::format("{}: is an HDF5 file that is damaged or cut off", config.path)};
  auto out = std::make_unique<Hdf5Reader>(config, std::move(file));
  if (const auto ready = out->prepare(config); !ready) return ready.failure();
  return std::unique_ptr<RecordedRows>{std::move(out)};
}

}  // namespace dampline::drivers
