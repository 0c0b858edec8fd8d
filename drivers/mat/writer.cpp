// SPDX-License-Identifier: MIT
#include <matio.h>

#include <array>
#include <memory>

#include "drivers/record/column_file.hpp"

namespace dampline::drivers {
namespace {

constexpr std::uint64_t kMostRows = 250'000'000;  // a variable has less than 2 GiB

}  // namespace

bool writes_mat() noexcept { return true; }

Outcome<bool> write_mat(const std::string& path, const ColumnTable& table) {
  if (table.rows > kMostRows)
    return Failure{Errc::kInvalidConfig, "a MAT file holds at most 250,000,000 rows"};
  const std::unique_ptr<mat_t, int (*)(mat_t*)> file{
      Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5), Mat_Close};
  const Failure cannot{Errc::kIo, "the MAT file cannot be written"};
  if (!file) return cannot;
  std::vector<double> values(static_cast<std::size_t>(table.rows));
  for (std::size_t c = 0; c < table.names.size(); ++c) {
    table.fill(c, values);
    std::array<std::size_t, 2> sizes{values.size(), 1};
    const std::unique_ptr<matvar_t, void (*)(matvar_t*)> variable{
        Mat_VarCreate(table.names[c].c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes.data(),
                      values.data(), MAT_F_DONT_COPY_DATA),
        Mat_VarFree};
    if (!variable || Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) != 0)
      return cannot;
  }
  return true;
}

}  // namespace dampline::drivers
