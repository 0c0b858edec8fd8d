// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// The three accelerometers of a truck: on its sprung frame and on its two wheelsets.
enum class Channel : std::uint8_t { kFrame = 0, kWheelset1 = 1, kWheelset2 = 2 };
inline constexpr std::size_t kChannels = 3;

/// The three accelerations of one sampling instant, by which the deflection's second derivative is
/// y'' = 2 z_b'' - (z_1'' + z_2''). Plain data: what the identifier is fed with where frames are
/// decoded elsewhere. Instants that lack a channel are not delivered: they appear as a jump of
/// `tick`. Time is the sensor's own or the frame's, never that of processing.
struct Sample {
  std::int64_t tick{0};     ///< sample number; consecutive samples differ by 1, a gap by more
  std::int64_t time_ns{0};  ///< time of the frame channel's sample
  std::array<double, kChannels> accel_mps2{};  ///< indexed by Channel, up is positive
  std::uint8_t saturated{0};                   ///< bit c set: channel c stood at full scale
  bool spoilt{false};                          ///< not what the car did; nothing is made of it
};

}  // namespace dampline
