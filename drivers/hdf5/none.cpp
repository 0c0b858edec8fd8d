// SPDX-License-Identifier: MIT
// Built where libhdf5 is not there.
#include <fmt/format.h>

#include "drivers/hdf5/reader.hpp"
#include "drivers/record/column_file.hpp"

namespace dampline::drivers {

Outcome<std::unique_ptr<RecordedRows>> open_hdf5(const RowFileConfig& config) {
  return Failure{Errc::kMalformed,
                 fmt::format("{}: is an HDF5 file, which this program was built without; build it "
                             "with libhdf5-dev, or export the file as CSV",
                             config.path)};
}

bool writes_hdf5() noexcept { return false; }

Outcome<bool> write_hdf5(const std::string& /*path*/, const ColumnTable& /*table*/) {
  return Failure{Errc::kInvalidConfig,
                 "HDF5 files are what this program was built without; build it with libhdf5-dev"};
}

}  // namespace dampline::drivers
