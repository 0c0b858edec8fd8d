// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "drivers/outcome.hpp"

namespace dampline::drivers {

/// What a recording is written in.
enum class RecordFormat : std::uint8_t {
  kEmpty,
  kUnknown,  ///< neither text nor any of these
  // Frames.
  kCandump,        ///< candump -l or -L
  kCandumpScreen,  ///< what candump prints: with -t a, d, z, A or without times, with -x or not
  kAsc,            ///< Vector
  kTrc,            ///< PEAK
  kBlf,            ///< Vector
  kMdf4,           ///< ASAM, with frames of a CAN bus
  // Rows.
  kTable,     ///< text in columns, or text that is nothing else
  kNpy,       ///< NumPy, one array
  kNpz,       ///< NumPy, several
  kMat,       ///< MATLAB up to 7
  kHdf5,      ///< also MATLAB 7.3
  kMdf4Rows,  ///< ASAM, of measured signals
  // Known by name, but not read.
  kMdf3,
  kOtherZip,  ///< Excel, LibreOffice or an archive
  kOldExcel,
  kTdms,
  kPcap,
  kParquet,
  kXz,
  kBzip2,
};

/// The first 64 KiB of a file, decompressed. Of a pipe: until a line of frames is whole, or nothing
/// comes for a while; it can be opened again.
[[nodiscard]] Outcome<std::string> read_head(const std::string& path);

/// What the first bytes of a file, decompressed, say. 64 KiB are enough, a few lines do.
[[nodiscard]] RecordFormat format_of(std::string_view head) noexcept;
/// Reads so many; of MDF4 its description, too, since its beginning does not tell frames from
/// signals. Of a pipe it waits until the first line is whole, and can be opened again.
[[nodiscard]] Outcome<RecordFormat> detect_format(const std::string& path);

[[nodiscard]] bool holds_frames(RecordFormat format) noexcept;
/// Text in columns, or arrays.
[[nodiscard]] bool holds_rows(RecordFormat format) noexcept;

/// "a candump log", "a Vector BLF file", ...
[[nodiscard]] std::string_view name_of(RecordFormat format) noexcept;
/// What a person can do with a file that is not read: "decompress it with xz -d", ...; empty: it is
/// read.
[[nodiscard]] std::string_view way_out_of(RecordFormat format) noexcept;

}  // namespace dampline::drivers
