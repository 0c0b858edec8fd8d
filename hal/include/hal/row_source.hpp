// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "dampline/result.hpp"

namespace dampline::hal {

/// Monotone counters; a source never resets them.
struct RowHealth {
  std::uint64_t rows{0};       ///< delivered
  std::uint64_t malformed{0};  ///< lines that were not a row, skipped on request
  std::uint64_t ignored{0};    ///< comments and blank lines
  std::uint64_t line{0};       ///< of the row delivered last, from 1
  bool truncated{false};       ///< the last line had no end; it was not used
};

/// Where rows of named columns come from: a recorded table.
/// Contract, run by tests/contract over every implementation:
///  - read() fills whole rows of width() numbers each, one behind the other, as many as fit, and
///    returns how many rows; 0 rows is success, not an error
///  - a cell that is empty, or a column that the record lacks, is NaN
///  - after kEndOfStream every later read() is kEndOfStream
///  - after kMalformed every later read() is kMalformed; rows before it were delivered
class RowSource {
 public:
  RowSource() = default;
  RowSource(const RowSource&) = delete;
  RowSource& operator=(const RowSource&) = delete;
  virtual ~RowSource() = default;
  [[nodiscard]] Result<std::size_t> read(std::span<double> out) noexcept { return do_read(out); }
  [[nodiscard]] std::size_t width() const noexcept { return do_width(); }
  [[nodiscard]] RowHealth health() const noexcept { return do_health(); }

 private:
  virtual Result<std::size_t> do_read(std::span<double> out) noexcept = 0;
  [[nodiscard]] virtual std::size_t do_width() const noexcept = 0;
  [[nodiscard]] virtual RowHealth do_health() const noexcept = 0;
};

}  // namespace dampline::hal
