// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// Of an array that is read as a table.
inline constexpr std::size_t kMostColumns = 1024;

/// Columns of doubles to be written, one at a time in memory.
struct ColumnTable {
  std::vector<std::string> names;
  std::uint64_t rows{0};
  /// Fills a whole column.
  std::function<void(std::size_t column, std::span<double> values)> fill;
};

/// Whether the program was built with their libraries, libmatio and libhdf5.
[[nodiscard]] bool writes_mat() noexcept;
[[nodiscard]] bool writes_hdf5() noexcept;

/// Writes each column as a variable of rows x 1 (MATLAB 5), or as a data set (HDF5), to a path that
/// can be written. Errors: the program was built without the library; the disk is full.
[[nodiscard]] Outcome<bool> write_mat(const std::string& path, const ColumnTable& table);
[[nodiscard]] Outcome<bool> write_hdf5(const std::string& path, const ColumnTable& table);

}  // namespace dampline::drivers
