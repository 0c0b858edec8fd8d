// SPDX-License-Identifier: MIT
// Built where libhdf5 is not there.
#include <fmt/format.h>

#include "drivers/hdf5/reader.hpp"

namespace dampline::drivers {

Outcome<std::unique_ptr<RecordedRows>> open_hdf5(const RowFileConfig& config) {
  return Failure{Errc::kMalformed,
                 fmt::format("{}: is an HDF5 file, which this program was built without; build it "
                             "with libhdf5-dev, or export the file as CSV",
                             config.path)};
}

}  // namespace dampline::drivers
