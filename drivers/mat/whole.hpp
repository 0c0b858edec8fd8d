// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "drivers/bytes/file_range.hpp"

namespace dampline::drivers {

/// Whether the elements of a MAT file of version 5 fit into it, and what is deflated inflates to
/// its checksum: libmatio gives numbers for what is missing. Empty: it is whole; else what is
/// wrong, with the byte of the element.
[[nodiscard]] std::string fault_of_mat(const RandomFile& file);

}  // namespace dampline::drivers
