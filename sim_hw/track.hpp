// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim_hw/noise.hpp"

namespace dampline::sim {

/// None where end_s <= start_s. Brakes before it and starts after it.
struct Standstill {
  double start_s{0.0};
  double end_s{0.0};
};
inline constexpr std::size_t kMostStandstills = 4;

/// The speed over the record. Changes are smooth (a quintic step) with this mean acceleration.
struct SpeedConfig {
  double speed_mps{80.0 / 3.6};
  double ramp_mps2{0.8};  ///< mean, of braking, starting and changes
  std::array<Standstill, kMostStandstills>
      standstills{};           ///< apart by braking and starting at least
  double change_time_s{-1.0};  ///< begins to change its speed here; negative: never
  double changed_speed_mps{60.0 / 3.6};
};

struct Speed {
  double speed_mps{0.0};
  double accel_mps2{0.0};
};

[[nodiscard]] Speed speed_at(const SpeedConfig& config, double time_s) noexcept;

/// Vertical irregularity of the track after ORE B176: one-sided density over wave number Om,
///   S(Om) = A Oc^2 / ((Om^2 + Or^2) (Om^2 + Oc^2)),  variance = integral of S from 0 to infinity.
struct TrackConfig {
  double amplitude_m_rad{4.032e-7};       ///< A: low 4.032e-7, high 1.08e-6
  double corner_radpm{0.8246};            ///< Oc
  double long_wave_corner_radpm{0.0206};  ///< Or
  /// S falls as Om^-4, so the curvature of the bare profile has no bounded variance, and B176 says
  /// nothing of wavelengths far below a metre; what is there is the short-wave band below. The
  /// profile ends with a 4th-order Butterworth low pass in space, -3 dB at this wavelength (89 Hz
  /// at 80 km/h).
  double contact_wavelength_m{0.25};
  /// Short waves (corrugation): a band of 60 +- 15 Hz at the nominal speed, a fixed band of
  /// wavelengths. Rms of the wheelset acceleration that it adds at the nominal speed.
  double short_wave_mps2{0.0};
  double short_wave_centre_hz{60.0};
  double short_wave_width_hz{30.0};
  double nominal_speed_mps{80.0 / 3.6};  ///< sets the wavelengths and the level of the short waves
};
inline constexpr double kTrackAmplitudeLow = 4.032e-7;
inline constexpr double kTrackAmplitudeHigh = 1.08e-6;

/// Slope (-) and curvature (1/m) of the profile at one place.
struct TrackPoint {
  double slope{0.0};
  double curvature_pm{0.0};
};

/// A track without end, made as it is run over; keeps only the last `memory_m` metres.
class Track {
 public:
  static constexpr double kGridM = 0.01;
  Track(const TrackConfig& config, double memory_m, std::uint64_t seed);
  /// Makes the track up to `position_m`. Never goes back.
  void extend_to(double position_m);
  /// At a position within `memory_m` behind the last extend_to(). The slope is a cubic Hermite
  /// interpolation between grid points and the curvature is its exact derivative.
  [[nodiscard]] TrackPoint at(double position_m) const noexcept;

 private:
  void add_point();
  SectionChain long_waves_;
  SectionChain short_waves_;
  double short_wave_gain_{0.0};
  Random long_random_;
  Random short_random_;
  std::vector<TrackPoint> ring_;  // a power of two
  std::uint64_t newest_{0};       // grid index of the newest point
  double origin_{0.0};            // grid index of position 0
};

}  // namespace dampline::sim
