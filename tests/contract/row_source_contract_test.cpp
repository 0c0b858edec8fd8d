// SPDX-License-Identifier: MIT
// The contract of hal::RowSource, over every implementation.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <vector>

#include "drivers/csv/reader.hpp"
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

template <class Implementation>
class RowSourceContract : public ::testing::Test {
 protected:
  hal::RowSource& source() { return implementation_.source(); }

 private:
  Implementation implementation_;
};

using RowImplementations = ::testing::Types<FakeRecord, Csv>;
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
