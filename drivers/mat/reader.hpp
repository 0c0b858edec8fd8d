// SPDX-License-Identifier: MIT
#pragma once
#include <memory>

#include "drivers/record/rows.hpp"

namespace dampline::drivers {

/// MATLAB's files of version 5 to 7.2 (`save -v6`, `-v7`; Octave's too) as a source of rows: each
/// real array of numbers with the most rows is a column, called as its variable; of a structure the
/// fields are, one level deep ("data.time"). Of an array with several columns they are "NAME_1",
/// "NAME_2", ... (a 1 x N array is one column). Others are left out. The columns that are asked for
/// are held in memory, 8 bytes a number; a variable has 2 GiB at most by the format. Without
/// libmatio at build: a failure that says so.
[[nodiscard]] Outcome<std::unique_ptr<RecordedRows>> open_mat(const RowFileConfig& config);

}  // namespace dampline::drivers
