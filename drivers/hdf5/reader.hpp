// SPDX-License-Identifier: MIT
#pragma once
#include <memory>

#include "drivers/record/rows.hpp"

namespace dampline::drivers {

/// HDF5, also MATLAB's files of version 7.3, as a source of rows: each data set of numbers with the
/// most rows is a column, called by its path ("run/force_n"); of one with several columns they are
/// "NAME_1", "NAME_2", ... (a 1 x N set is one column). Other sets are left out. Read in pieces of
/// a fixed number of rows, in constant memory. Without libhdf5 at build: a failure that says so.
[[nodiscard]] Outcome<std::unique_ptr<RecordedRows>> open_hdf5(const RowFileConfig& config);

}  // namespace dampline::drivers
