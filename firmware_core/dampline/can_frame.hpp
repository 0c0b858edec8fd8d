// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

namespace dampline {

/// Who stamped a frame's time.
enum class TimeSource : std::uint8_t { kUnknown, kSoftware, kHardware };

/// One CAN or CAN FD frame as a source delivers it: what the identifier is fed with where a bus, or
/// a log of one, is the source. Plain data of 88 bytes; nothing is checked here. What no channel
/// wants (another identifier, remote and error frames, too few bytes) is counted and ignored by who
/// decodes.
struct CanFrame {
  std::int64_t time_ns{0};          ///< when it was received, by the source's clock
  std::uint32_t id{0};              ///< 11 or 29 bits, no flag bits; of an error frame its classes
  std::uint8_t length{0};           ///< payload bytes, 0...64
  std::uint8_t interface_index{0};  ///< which of the source's interfaces it came from
  bool extended{false};             ///< 29-bit identifier
  bool remote{false};               ///< remote request: carries no data
  bool error{false};                ///< error frame: carries no sample
  bool fd{false};                   ///< CAN FD
  std::uint8_t fd_flags{0};  ///< of CAN FD, as the kernel has them: 1 bit rate, 2 error state
  TimeSource time_source{TimeSource::kUnknown};
  std::array<std::uint8_t, 64> data{};
};

}  // namespace dampline
