// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>

namespace dampline::hal {

/// What happened beside the frames. Numbers are part of the black box's format: only add.
enum class EventKind : std::uint8_t {
  kRunStart = 1,           ///< value: wall clock minus run time, ns
  kRunEnd = 2,             ///< value: frames given to the identification
  kLinkDown = 3,           ///< the interface went down
  kLinkUp = 4,             ///< frames can come again
  kInterfaceRemoved = 5,   ///< the interface is gone
  kInterfaceBack = 6,      ///< it exists again; a new socket
  kBusOff = 7,             ///< the controller left the bus
  kBusRestarted = 8,       ///< and came back
  kBusError = 9,           ///< value: error classes of linux/can/error.h
  kFramesDropped = 10,     ///< value: frames that the kernel had to drop since the last such event
  kClockStep = 11,         ///< value: by how much the wall clock jumped, ns
  kSignalLost = 12,        ///< no complete sample any more; value: 0
  kSignalBack = 13,        ///< value: how long there was none, ns
  kRecordsLost = 14,       ///< value: records that could not be written to the black box
  kRecordingStopped = 15,  ///< value: errno
  kRecordingResumed = 16,  ///< value: records lost in between
  kFileRotated = 17,       ///< value: sequence of the new file's first record
  kPulse = 18,             ///< pulse per second; line says which
  kMarkerOn = 19,          ///< a measurement starts
  kMarkerOff = 20,         ///< it stops
  kWheelPulse = 21,        ///< a wheel-revolution pulse
  kImpossibleEdge = 22,    ///< two edges of one direction in a row; value: +1 rising, -1 falling
  kEdgesLost = 23,         ///< value: edges that the kernel had to drop
  kPublishFailed = 24,     ///< live.json could not be written; value: errno
  kPublishResumed = 25,    ///< value: how often it could not be written in between
  kAlarmRaised = 26,       ///< line: which of [alarm], in its order; value: what was seen, rounded
  kAlarmCleared = 27,      ///< the same
};

/// One event. Plain: it is handed between threads and stored as it is.
struct Event {
  std::int64_t time_ns{0};  ///< by the clock that stamps the frames
  EventKind kind{EventKind::kRunStart};
  std::uint8_t line{0};  ///< which GPIO line of the configuration, or which interface
  std::int64_t value{0};
};

}  // namespace dampline::hal
