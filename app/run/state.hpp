// SPDX-License-Identifier: MIT
#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "dampline/estimate/statistics.hpp"

namespace dampline::app {

/// state.dls, the sufficient statistics of a run. Every number is little-endian:
///
///   8 bytes  "DAMPLINE"
///   u32      version, now 1
///   u32 x 3  scales, columns of a row, segments of the curve: sizes that both sides must share
///   u64      basis hash: only states with the same one may be added
///   u64      bytes of the payload
///   payload  the fields of Statistics in the order of their declaration, used entries only;
///            factors as packed upper triangles, row after row
///   u32      CRC-32C of everything before it
[[nodiscard]] std::string encode_state(const Statistics& statistics);

/// Throws RunError naming `origin` when the bytes are no state, are cut off or changed, or are of
/// another version or other sizes; `out` is then not touched.
void decode_state(std::string_view bytes, const std::string& origin, Statistics& out);

/// The same from a file.
void load_state(const std::filesystem::path& file, Statistics& out);

/// Adds the state `from`, which errors call `origin`. Throws RunError, and changes nothing, when
/// the two were made with another basis: rate, windows, curve nodes, velocity corner.
void merge_state(Statistics& into, const Statistics& from, const std::string& origin);

}  // namespace dampline::app
