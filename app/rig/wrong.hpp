// SPDX-License-Identifier: MIT
#pragma once
#include "app/rig/record.hpp"

namespace dampline::app::rig {

/// The record without values and times that no rig makes, each kind with a fault that names it:
///  - a value that stands alone, three samples at most, is replaced by what its neighbours say;
///  - up to twelve in a row are left out as values that are no number;
///  - a line whose time does not lie between its neighbours' is dropped where `skip_bad_lines`
///  says so.
///
/// A run of up to twelve samples is wrong where both its ends break with the straight line of their
/// neighbours outside, by twelve times what nine tenths of all samples do and by four times what
/// the sixteen nearest do. Velocity, force and acceleration may jump with the motion: there a
/// run must lie outside the usual range, or fall where the motion does not turn.
/// More than twelve runs of a force or an acceleration, each below twenty times its usual range,
/// are blows: they stay. Records of fewer than 200 rows are not judged. Throws RunError naming the
/// line of a wrong time that is not skipped.
[[nodiscard]] Record screened_record(Record record, bool skip_bad_lines);

}  // namespace dampline::app::rig
