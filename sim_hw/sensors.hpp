// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>

#include "dampline/sample.hpp"
#include "sim_hw/noise.hpp"

namespace dampline::sim {

inline constexpr int kMaxCount = 2047;
inline constexpr int kMinCount = -2048;

/// Three 12-bit accelerometers. Arrays are indexed by dampline::Channel.
struct SensorConfig {
  std::array<double, kChannels> range_mps2{49.03325, 98.0665, 98.0665};  ///< 5 g, 10 g, 10 g
  double anti_alias_corner_hz{100.0};  ///< 4th-order Butterworth, all channels alike
  double noise_mps2{0.02};             ///< white, rms per sample
  double bias_mps2{0.1};               ///< constant, one standard deviation over seeds
  double drift_mps2{0.05};             ///< slow change of the bias, rms
  double drift_time_s{60.0};           ///< time constant of the drift, twice critically damped
  std::array<double, kChannels> gain_error{};     ///< 0.05 reads 5 % too much
  std::array<double, kChannels> time_skew_s{};    ///< positive: shows the past
  std::array<double, kChannels> tilt_rad{};       ///< cross-axis: reads cos a_z + sin a_lateral
  double lateral_mps2{0.6};                       ///< rms of the lateral acceleration (2 Hz)
  std::array<double, kChannels> limit_mps2{};     ///< clips before the converter; 0: does not
  std::array<double, kChannels> stuck_start_s{};  ///< holds its value from here ...
  std::array<double, kChannels> stuck_end_s{};    ///< ... to here; no fault where end <= start
};

/// m/s^2 per count.
[[nodiscard]] constexpr double count_scale_mps2(double range_mps2) noexcept {
  return range_mps2 / 2048.0;
}

/// The part of a sensor behind the anti-alias filter: gain, tilt, bias, drift, noise, converter.
class Sensors {
 public:
  Sensors(const SensorConfig& config, std::uint64_t seed);
  /// One sampling instant of accelerations that the anti-alias filter has passed.
  [[nodiscard]] std::array<std::int16_t, kChannels> convert(
      const std::array<double, kChannels>& accel_mps2, double time_s) noexcept;

 private:
  [[nodiscard]] std::int16_t convert_one(std::size_t channel, double accel_mps2,
                                         double time_s) noexcept;
  SensorConfig config_;
  Random random_;
  Random lateral_random_;
  std::array<double, kChannels> bias_mps2_{};
  std::array<SectionChain, kChannels> drift_;
  double drift_gain_;
  SectionChain lateral_;
  double lateral_gain_{0.0};
  bool tilted_;
  std::array<std::int16_t, kChannels> last_{};
};

}  // namespace dampline::sim
