// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "drivers/bytes/file_range.hpp"
#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// One file of a zip archive.
struct ZipMember {
  std::string name;
  bool deflated{false};
  std::uint64_t begin{0};         ///< of its data in the archive
  std::uint64_t packed_bytes{0};  ///< as they lie there
};

/// The members of an archive, by its central directory (PKWARE's APPNOTE, also its 64-bit forms),
/// at most 1024 of them; those that are neither stored nor deflated are left out. `name` is what
/// errors call the archive.
[[nodiscard]] Outcome<std::vector<ZipMember>> zip_members(const RandomFile& file,
                                                          const std::string& name);

}  // namespace dampline::drivers
