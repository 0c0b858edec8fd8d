// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace dampline {

/// By which an acceleration in g is multiplied (the 3rd CGPM, 1901).
inline constexpr double kStandardGravityMps2 = 9.80665;

/// The three accelerometers of a truck: on its sprung frame and on its two wheelsets.
enum class Channel : std::uint8_t { kFrame = 0, kWheelset1 = 1, kWheelset2 = 2 };
inline constexpr std::size_t kChannels = 3;

/// Accelerometers that may stand beside the three: on the frame over wheelset 1, which shows its
/// pitch, and on the other truck's frame or the body over its pivot, whose mass pushes on this end
/// too.
enum class Extra : std::uint8_t { kFrameEnd = 0, kFarFrame = 1 };
inline constexpr std::size_t kExtras = 2;

/// The three accelerations of one sampling instant, by which the deflection's second derivative is
/// y'' = 2 z_b'' - (z_1'' + z_2''). Plain data: what the identifier is fed with where frames are
/// decoded elsewhere. A channel that has no value is no number (NaN); instants that nobody delivers
/// appear as a jump of `tick`. Time is the sensor's own or the frame's, never that of processing.
struct Sample {
  std::int64_t tick{0};     ///< sample number; consecutive samples differ by 1, a gap by more
  std::int64_t time_ns{0};  ///< time of the frame channel's sample
  std::array<double, kChannels> accel_mps2{};  ///< indexed by Channel, up is positive
  std::uint8_t saturated{0};  ///< bit c set: channel c stood at full scale; then the extras
  bool spoilt{false};         ///< not what the car did; nothing is made of it
  bool lost{false};           ///< a channel or more of this instant never came
  std::uint8_t bridged{0};    ///< bit c set: channel c had no value and was put in; then the extras
  std::array<float, kExtras> extra_mps2{};  ///< indexed by Extra; 0 where there is none
  /// By which the wheelsets' own stamps are later than time_ns, where channels have their own.
  std::array<std::int16_t, 2> wheelset_after_us{};
};

static_assert(sizeof(Sample) == 56, "samples are held by the thousand");

[[nodiscard]] inline bool is_bridged(const Sample& sample, std::size_t channel) noexcept {
  return (std::uint32_t{sample.bridged} >> channel & 1U) != 0;
}

/// a theta'' of a frame with an accelerometer over wheelset 1.
[[nodiscard]] inline double end_turn_mps2(const Sample& sample) noexcept {
  return double{sample.extra_mps2[static_cast<std::size_t>(Extra::kFrameEnd)]} -
         sample.accel_mps2[0];
}
/// d'' of d = a theta - (z_1 - z_2) / 2, the frame's turn on its springs.
[[nodiscard]] inline double turn_mps2(const Sample& sample) noexcept {
  return end_turn_mps2(sample) - 0.5 * (sample.accel_mps2[1] - sample.accel_mps2[2]);
}
/// z_b'' and what the far truck's share of the body's mass adds to it.
[[nodiscard]] inline double pushed_mps2(const Sample& sample, double far_share) noexcept {
  return sample.accel_mps2[0] +
         far_share * double{sample.extra_mps2[static_cast<std::size_t>(Extra::kFarFrame)]};
}

}  // namespace dampline
