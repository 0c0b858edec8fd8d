// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/sample/can_frame.hpp"
#include "hal/event.hpp"

namespace dampline::app {

/// What goes from the acquisition to the writer: a frame or an event, in the order in which they
/// happened.
struct RecordItem {
  bool is_event{false};
  CanFrame frame{};
  hal::Event event{};
};

}  // namespace dampline::app
