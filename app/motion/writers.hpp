// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <string>

#include "app/motion/series.hpp"

namespace dampline::app {

enum class MotionFormat : std::uint8_t { kCsv, kNpy, kMat, kHdf5 };

/// By the file's suffix; "-" is CSV. Throws UsageError naming the formats that there are.
[[nodiscard]] MotionFormat motion_format(const std::string& file);

/// time_s, deflection_m and velocity_mps of every row: as CSV with the summary in comments before
/// the header, as NumPy's structured array with these names, or as variables or data sets of a MAT
/// or HDF5 file, where the program has their libraries. The file appears whole. Throws RunError,
/// UsageError where it exists and is not to be replaced.
void write_motion(MotionSeries& series, const std::string& file, MotionFormat format, bool replace);

/// As lines for a terminal, and as JSON.
[[nodiscard]] std::string motion_text(const MotionSummary& summary);
[[nodiscard]] std::string motion_json(const MotionSummary& summary);

}  // namespace dampline::app
