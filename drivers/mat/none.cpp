// SPDX-License-Identifier: MIT
// Built where libmatio is not there.
#include <fmt/format.h>

#include "drivers/mat/reader.hpp"
#include "drivers/record/column_file.hpp"

namespace dampline::drivers {

Outcome<std::unique_ptr<RecordedRows>> open_mat(const RowFileConfig& config) {
  return Failure{Errc::kMalformed,
                 fmt::format("{}: is a MAT file, which this program was built without; build it "
                             "with libmatio-dev, or export the file as CSV",
                             config.path)};
}

bool writes_mat() noexcept { return false; }

Outcome<bool> write_mat(const std::string& /*path*/, const ColumnTable& /*table*/) {
  return Failure{Errc::kInvalidConfig,
                 "MAT files are what this program was built without; build it with libmatio-dev"};
}

}  // namespace dampline::drivers
