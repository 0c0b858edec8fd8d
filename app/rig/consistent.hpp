// SPDX-License-Identifier: MIT
#pragma once
#include "app/rig/record.hpp"

namespace dampline::app::rig {

/// The record as its columns bear one another out, each change with a note:
///  - a force that feeds the motion instead of resisting it is turned: its sign is the other
///  party's.
///    A spring or a mass of the right sign whose force is only late is left as it is;
///  - a velocity column that follows the deflection's rate at a scale that no unit makes is left
///  out.
[[nodiscard]] Record consistent_record(Record record);

}  // namespace dampline::app::rig
