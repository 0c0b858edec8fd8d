// SPDX-License-Identifier: MIT
// The contract of hal::RowSource, over every implementation.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/csv/reader.hpp"
#include "drivers/record/column_file.hpp"
#include "drivers/record/rows.hpp"
#include "hal/row_source.hpp"

namespace dampline {
namespace {

constexpr std::size_t kRows = 100;

/// Rows (i, 2 i, NaN) in memory.
class FakeRows final : public hal::RowSource {
 private:
  Result<std::size_t> do_read(std::span<double> out) noexcept override {
    if (next_ == kRows && out.size() >= 3) return Errc::kEndOfStream;
    std::size_t rows = 0;
    for (; (rows + 1) * 3 <= out.size() && next_ < kRows; ++rows, ++next_) {
      out[rows * 3] = static_cast<double>(next_);
      out[rows * 3 + 1] = 2.0 * static_cast<double>(next_);
      out[rows * 3 + 2] = std::numeric_limits<double>::quiet_NaN();
    }
    return rows;
  }
  [[nodiscard]] std::size_t do_width() const noexcept override { return 3; }
  [[nodiscard]] hal::RowHealth do_health() const noexcept override {
    hal::RowHealth health;
    health.rows = next_;
    return health;
  }
  std::size_t next_{0};
};

class FakeRecord {
 public:
  hal::RowSource& source() { return source_; }

 private:
  FakeRows source_;
};

class Csv {
 public:
  Csv()
      : path_{std::filesystem::temp_directory_path() /
              fmt::format("dampline_contract_{}.csv", ::getpid())} {
    {
      std::ofstream out{path_};
      out << "time_s,force_n,deflection_m\n";
      for (std::size_t i = 0; i < kRows; ++i) out << fmt::format("{},,{}\n", i, 2 * i);
    }
    source_ =
        std::move(drivers::CsvReader::open(
                      {.path = path_.string(), .required = {"time_s", "deflection_m", "force_n"}})
                      .value());
  }
  ~Csv() { std::filesystem::remove(path_); }
  Csv(const Csv&) = delete;
  Csv& operator=(const Csv&) = delete;
  hal::RowSource& source() { return *source_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<drivers::CsvReader> source_;
};

/// A file that a Format writes, opened by its content.
template <class Format>
class RecordedTable {
 public:
  RecordedTable()
      : path_{std::filesystem::temp_directory_path() /
              fmt::format("dampline_contract_{}.table", ::getpid())} {
    Format::write(path_.string());
    auto opened = drivers::open_rows(
        {.path = path_.string(), .required = {"time_s", "deflection_m", "force_n"}});
    EXPECT_TRUE(opened.ok()) << opened.error_text();
    source_ = std::move(opened.value());
  }
  ~RecordedTable() { std::filesystem::remove(path_); }
  RecordedTable(const RecordedTable&) = delete;
  RecordedTable& operator=(const RecordedTable&) = delete;
  hal::RowSource& source() { return *source_; }

 private:
  std::filesystem::path path_;
  std::unique_ptr<drivers::RecordedRows> source_;
};

double contract_cell(std::size_t column, std::size_t row) {
  return column == 2 ? std::numeric_limits<double>::quiet_NaN()
                     : static_cast<double>((column + 1) * row);
}

struct Npy {
  static void write(const std::string& path) {
    std::ofstream out{path, std::ios::binary};
    std::string head = fmt::format(
        "{{'descr': [('time_s', '<f8'), ('deflection_m', '<f8'), ('force_n', '<f8')], "
        "'fortran_order': False, 'shape': ({},), }}",
        kRows);
    head.resize(128 - 11, ' ');
    out << std::string{"\x93NUMPY\x01\x00\x76\x00", 10} << head << '\n';
    for (std::size_t i = 0; i < 3 * kRows; ++i) {
      const double cell = contract_cell(i % 3, i / 3);
      out.write(reinterpret_cast<const char*>(&cell), sizeof cell);
    }
  }
};

template <drivers::Outcome<bool> (*kWrite)(const std::string&, const drivers::ColumnTable&)>
struct Columns {
  static void write(const std::string& path) {
    drivers::ColumnTable table{{"time_s", "deflection_m", "force_n"}, kRows, {}};
    table.fill = [](std::size_t column, std::span<double> values) {
      for (std::size_t i = 0; i < values.size(); ++i) values[i] = contract_cell(column, i);
    };
    ASSERT_TRUE(kWrite(path, table).ok());
  }
};

/// By tests/mdf4.py; its last column may be invalid.
struct MdfSignals {
  static void write(const std::string& path) {
    const std::string command = fmt::format(
        "/usr/bin/python3 -c \"import sys; sys.path.insert(0, '{}/tests'); import mdf4; "
        "mdf4.write_signals('{}', ['t', 'deflection_m', 'force_n'], [(i, 2 * i, float('nan')) for "
        "i in range({})])\"",
        DAMPLINE_SOURCE_DIR, path, kRows);
    ASSERT_EQ(std::system(command.c_str()), 0);  // NOLINT(cert-env33-c) the writer is a program
  }
};

template <class Implementation>
class RowSourceContract : public ::testing::Test {
 protected:
  hal::RowSource& source() { return implementation_.source(); }

 private:
  Implementation implementation_;
};

using RowImplementations =
    ::testing::Types<FakeRecord, Csv, RecordedTable<Npy>, RecordedTable<MdfSignals>
#if DAMPLINE_HAS_HDF5
                     ,
                     RecordedTable<Columns<drivers::write_hdf5>>
#endif
#if DAMPLINE_HAS_MATIO
                     ,
                     RecordedTable<Columns<drivers::write_mat>>
#endif
                     >;
TYPED_TEST_SUITE(RowSourceContract, RowImplementations);

TYPED_TEST(RowSourceContract, FillsWholeRowsOneBehindTheOther) {
  hal::RowSource& source = this->source();
  ASSERT_EQ(source.width(), 3U);
  std::array<double, 3 * 8 + 2> out{};
  std::size_t rows = 0;
  for (auto count = source.read(out); count.ok(); count = source.read(out)) {
    EXPECT_LE(count.value(), 8U);
    for (std::size_t i = 0; i < count.value(); ++i, ++rows) {
      EXPECT_EQ(out[3 * i], static_cast<double>(rows));
      EXPECT_EQ(out[3 * i + 1], 2.0 * static_cast<double>(rows));
      EXPECT_TRUE(std::isnan(out[3 * i + 2]));
    }
  }
  EXPECT_EQ(rows, kRows);
  EXPECT_EQ(source.health().rows, kRows);
}

TYPED_TEST(RowSourceContract, StaysAtItsEnd) {
  std::vector<double> out(3 * 2 * kRows);
  EXPECT_EQ(this->source().read(out).value(), kRows);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(this->source().read(out).error(), Errc::kEndOfStream);
}

TYPED_TEST(RowSourceContract, ReadsNothingIntoTooLittleSpaceAndLosesNothingByIt) {
  std::array<double, 2> little{};
  EXPECT_EQ(this->source().read(little).value(), 0U);
  std::vector<double> out(3 * kRows);
  EXPECT_EQ(this->source().read(out).value(), kRows);
}

}  // namespace
}  // namespace dampline
