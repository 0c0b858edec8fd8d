// SPDX-License-Identifier: MIT
#pragma once
#include "app/rig/rig_source.hpp"

namespace dampline::app {

/// The record at uniform times. Times that only rounding keeps from a straight line are put onto
/// it; others are resampled at their median interval, gaps stay gaps. What is uniform as it is, but
/// for gaps of whole samples, comes back unread. Throws RunError naming the line where time stands
/// still.
[[nodiscard]] RigRecord uniform_record(RigRecord record);

}  // namespace dampline::app
