// SPDX-License-Identifier: MIT
// What inspect() is put together from.
#pragma once
#include <array>

#include "app/config/columns.hpp"
#include "app/inspect/inspect.hpp"
#include "drivers/record/format.hpp"

namespace dampline::app {

/// By Channel.
inline constexpr std::array kTruckColumns{Column::kFrameAccel, Column::kWheelset1Accel,
                                          Column::kWheelset2Accel};
/// Of every configuration that is proposed for a truck.
inline constexpr const char* kMassLines =
    "[car]\nmoving_mass_kg = 37200.0 # state your own: every force scales with it\n";
inline constexpr const char* kInterfaceFormat = "a CAN interface";

/// Frames of a recording, a black box or an interface.
void inspect_frames(const InspectOptions& options, Inspection& found);

/// Rows of a table or of arrays.
void inspect_rows(const InspectOptions& options, Inspection& found);

/// Which of the accelerations stand on the frame and the wheelsets: by their names; or, where these
/// tell nothing and there are just three of one rate, by their rms: the frame moves least.
void find_truck(Inspection& found);

}  // namespace dampline::app
