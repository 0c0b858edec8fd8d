// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "dampline/motion/butterworth.hpp"
#include "dampline/sample.hpp"
#include "sim_hw/effects/impulses.hpp"
#include "sim_hw/sensors.hpp"
#include "sim_hw/track.hpp"
#include "sim_hw/truck.hpp"
#include "sim_hw/vehicle.hpp"

namespace dampline::sim {

inline constexpr int kStepRateHz = 2400;
inline constexpr int kSampleRateHz = 300;

/// A run. The defaults are a laden car at 80 km/h on good track.
struct SimulationConfig {
  std::uint64_t seed{1};
  TruckConfig truck{};
  TrackConfig track{};
  SpeedConfig speed{};
  SensorConfig sensors{};
  ImpulseEffects impulses{};
  /// Share of a wheelset's power that the other wheelset never sees: contact off the centre of the
  /// rail, wheels that are not round.
  double incoherent_power{0.0};
  /// Two more accelerometers, as the frame's and with noise of their own: on the frame over
  /// wheelset 1, and on the other truck's frame. They need a vehicle.
  bool extra_sensors{false};
  double settle_s{10.0};  ///< runs before time 0, so that the record begins in full motion
  /// The truck as one of two under a common body; needs Vehicle::supports(truck). A flat is then
  /// on the car's first wheelset, a shock hits the instrumented truck.
  std::optional<VehicleConfig> vehicle{};
};

/// What really happened; for tests and plots only.
struct Truth {
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double damping_force_n{0.0};
  double restoring_force_n{0.0};
  double frame_mps2{0.0};
};

struct SimulatedSample {
  std::int64_t tick{0};  ///< 0 is time 0
  double time_s{0.0};    ///< tick / 300, the sampling instant
  std::array<std::int16_t, kChannels> counts{};
  std::array<double, kChannels> accel_mps2{};        ///< counts times count_scale_mps2(range)
  std::array<std::int16_t, kExtras> extra_counts{};  ///< by Extra
  std::array<double, kExtras> extra_mps2{};
  std::uint8_t saturated{0};  ///< bit c: channel c stands at a full-scale code; then the extras
  Truth truth{};    ///< through the anti-alias filter of the channels, so at the same delay
  Truth instant{};  ///< at time_s itself, unfiltered
  double speed_mps{0.0};
  double position_m{0.0};  ///< of wheelset 1 of the instrumented truck
};

/// Track, truck and sensors, sample by sample, for as long as wanted in constant memory.
class Simulation {
 public:
  explicit Simulation(const SimulationConfig& config);
  [[nodiscard]] SimulatedSample next();

 private:
  static constexpr std::size_t kSignals = 10;  // three accelerations, Truth, extras
  using Signals = std::array<double, kSignals>;
  struct Moment {
    Signals filtered{};
    Truth instant{};
    double speed_mps{0.0};
    double position_m{0.0};
  };
  static constexpr std::size_t kHistory = 128;  // 53 ms of steps
  using Excitations = Vehicle::Excitations;     // without a vehicle the second is not used
  [[nodiscard]] Excitations excitations(double time_s, double position_m, const Speed& speed);
  [[nodiscard]] Excitation excitation(double position_m, const Speed& speed, bool first) const;
  [[nodiscard]] const TruckState& advance(const Excitations& middle, const Excitations& end,
                                          double time_s) noexcept;
  void step();
  [[nodiscard]] std::array<double, kExtras> extras() const noexcept;
  void sense_extras(const Signals& seen, SimulatedSample& sample) noexcept;
  [[nodiscard]] double skewed(std::size_t channel) const noexcept;
  [[nodiscard]] const Moment& past(std::int64_t steps) const noexcept;

  SimulationConfig config_;
  std::size_t instrumented_;  // index of the truck with the sensors
  Track track_;
  std::vector<Track> own_tracks_;  // one per wheelset, where they differ
  Truck truck_;
  std::optional<Vehicle> vehicle_;
  Shocks shocks_;
  ButterworthLowPass<kSignals> anti_alias_;
  Sensors sensors_;
  std::optional<Sensors> extra_sensors_;
  std::vector<Moment> history_;
  std::int64_t steps_{0};  // done, settling included
  std::int64_t settle_steps_{0};
  std::int64_t look_ahead_{0};  // steps, for channels that are early
  bool has_skew_{false};
  double position_m_{0.0};  // of the first wheelset of all
  Excitations now_{};
  std::int64_t tick_{0};
};

/// Group delay of the anti-alias filter at low frequencies: how much `truth` lags `instant`.
[[nodiscard]] double anti_alias_delay_s(const SensorConfig& config) noexcept;

[[nodiscard]] Sample to_sample(const SimulatedSample& sample) noexcept;

enum class Load : std::uint8_t { kLaden, kEmpty };

[[nodiscard]] inline TruckConfig truck_of(Load load) {
  return load == Load::kLaden ? laden_truck() : empty_truck();
}

/// A run at constant speed with the corrugation of the method study (60 +- 15 Hz at this speed).
/// With short_wave_mps2 = 2 the rms of y, v and z_b'' are those the study states: 0.3 to 0.8 mm,
/// 11 to 18 mm/s, 0.21 to 0.29 m/s^2; with 0, velocities are a third lower.
[[nodiscard]] inline SimulationConfig reference_run(Load load, double speed_kmh, std::uint64_t seed,
                                                    double short_wave_mps2 = 2.0) {
  SimulationConfig config;
  config.seed = seed;
  config.truck = truck_of(load);
  config.speed.speed_mps = speed_kmh / 3.6;
  config.track.nominal_speed_mps = config.speed.speed_mps;
  config.track.short_wave_mps2 = short_wave_mps2;
  return config;
}

}  // namespace dampline::sim
