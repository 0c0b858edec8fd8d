// SPDX-License-Identifier: MIT
#include "sim_hw/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dampline::sim {
namespace {

constexpr double kStepS = 1.0 / kStepRateHz;
constexpr std::int64_t kDecimation = kStepRateHz / kSampleRateHz;
constexpr std::uint64_t kOwnTrackSalt = 0x9e3779b97f4a7c15ULL;
constexpr double kTrackMarginM = 0.5;
constexpr std::uint64_t kTrailingSensors = 0x5bd1e995a7f3c2d1ULL;  // their noise is their own
constexpr std::uint64_t kExtraSensors = 0xc2b2ae3d27d4eb4fULL;

Truth instant_of(const TruckState& state) {
  return {state.deflection_m, state.velocity_mps, state.damping_force_n, state.restoring_force_n,
          state.frame_mps2};
}

double pivot_distance_m(const SimulationConfig& config) {
  return config.vehicle ? 2.0 * config.vehicle->half_pivot_distance_m : 0.0;
}

bool is_trailing(const SimulationConfig& config) {
  return config.vehicle && config.vehicle->instrumented == TruckPosition::kTrailing;
}

/// As the frame's.
SensorConfig extra_config(const SensorConfig& sensors) {
  SensorConfig out;
  out.range_mps2.fill(sensors.range_mps2[0]);
  out.noise_mps2 = sensors.noise_mps2;
  out.bias_mps2 = sensors.bias_mps2;
  out.drift_mps2 = sensors.drift_mps2;
  out.drift_time_s = sensors.drift_time_s;
  return out;
}

std::uint64_t sensor_seed(const SimulationConfig& config) {
  return is_trailing(config) ? config.seed ^ kTrailingSensors : config.seed;
}

}  // namespace

Simulation::Simulation(const SimulationConfig& config)
    : config_(config),
      instrumented_(is_trailing(config) ? 1 : 0),
      track_(config.track, config.truck.wheelbase_m + pivot_distance_m(config) + kTrackMarginM,
             config.seed),
      truck_(config.truck),
      shocks_(config.impulses, config.seed),
      anti_alias_(config.sensors.anti_alias_corner_hz, kStepRateHz),
      sensors_(config.sensors, sensor_seed(config)),
      history_(kHistory) {
  if (config.incoherent_power > 0.0) {
    for (const std::uint64_t salt : {kOwnTrackSalt, 2 * kOwnTrackSalt}) {
      own_tracks_.emplace_back(config.track,
                               config.truck.wheelbase_m + pivot_distance_m(config) + kTrackMarginM,
                               config.seed + salt);
    }
  }
  settle_steps_ = std::llround(config.settle_s * kSampleRateHz) * kDecimation;
  const auto& skew = config.sensors.time_skew_s;
  has_skew_ = std::ranges::any_of(skew, [](double s) { return s != 0.0; });
  const double earliest = -std::min(0.0, std::ranges::min(skew));
  if (has_skew_) look_ahead_ = static_cast<std::int64_t>(std::ceil(earliest * kStepRateHz)) + 2;
  if (config.vehicle) vehicle_.emplace(*config.vehicle, config.truck);
  if (config.extra_sensors)
    extra_sensors_.emplace(extra_config(config.sensors), sensor_seed(config) ^ kExtraSensors);
  now_ = excitations(-config.settle_s, 0.0, speed_at(config.speed, -config.settle_s));
  for (std::int64_t i = 0; i < settle_steps_ + look_ahead_; ++i) step();
}

Excitation Simulation::excitation(double position_m, const Speed& speed, bool first) const {
  const ImpulseEffects& impulses = config_.impulses;
  Excitation result;
  for (std::size_t i = 0; i < 2; ++i) {
    const double place = i == 0 ? position_m : position_m - config_.truck.wheelbase_m;
    TrackPoint point = track_.at(place);
    if (!own_tracks_.empty()) {
      const double own = std::sqrt(config_.incoherent_power);
      const double shared = std::sqrt(1.0 - config_.incoherent_power);
      const TrackPoint more = own_tracks_[i].at(place);
      point = {shared * point.slope + own * more.slope,
               shared * point.curvature_pm + own * more.curvature_pm};
    }
    const auto add = [&](const TrackPoint& more) {
      point.slope += more.slope;
      point.curvature_pm += more.curvature_pm;
    };
    if (impulses.joint_depth_m != 0.0) {
      add(dip(place, impulses.joint_depth_m, impulses.joint_length_m, impulses.joint_spacing_m));
    }
    if (i == 0 && first && impulses.flat_depth_m != 0.0) {
      add(dip(place, impulses.flat_depth_m, impulses.flat_length_m,
              impulses.wheel_circumference_m));
    }
    result.wheelset_mps2[i] =
        point.curvature_pm * speed.speed_mps * speed.speed_mps + point.slope * speed.accel_mps2;
    result.wheelset_mps[i] = point.slope * speed.speed_mps;
  }
  return result;
}

Simulation::Excitations Simulation::excitations(double time_s, double position_m,
                                                const Speed& speed) {
  track_.extend_to(position_m);
  for (Track& own : own_tracks_) own.extend_to(position_m);
  Excitations result;
  result[0] = excitation(position_m, speed, true);
  if (vehicle_) result[1] = excitation(position_m - pivot_distance_m(config_), speed, false);
  result[instrumented_].force_n = shocks_.force_n(time_s);
  return result;
}

const TruckState& Simulation::advance(const Excitations& middle, const Excitations& end,
                                      double time_s) noexcept {
  if (!vehicle_) {
    truck_.step(now_[0], middle[0], end[0], time_s, kStepS);
    return truck_.state();
  }
  vehicle_->step(now_, middle, end, kStepS);
  return vehicle_->state(config_.vehicle->instrumented);
}

void Simulation::step() {
  const double time_s = static_cast<double>(steps_ - settle_steps_) * kStepS;
  const Speed a = speed_at(config_.speed, time_s);
  const Speed m = speed_at(config_.speed, time_s + 0.5 * kStepS);
  const Speed b = speed_at(config_.speed, time_s + kStepS);
  // Simpson's rule, over half a step and over all of it
  const double half_way =
      position_m_ + kStepS / 24.0 * (5.0 * a.speed_mps + 8.0 * m.speed_mps - b.speed_mps);
  position_m_ += kStepS / 6.0 * (a.speed_mps + 4.0 * m.speed_mps + b.speed_mps);
  const Excitations middle = excitations(time_s + 0.5 * kStepS, half_way, m);
  const Excitations end = excitations(time_s + kStepS, position_m_, b);
  const TruckState& state = advance(middle, end, time_s);
  now_ = end;
  ++steps_;
  Moment& moment = history_[static_cast<std::size_t>(steps_) % kHistory];
  moment.instant = instant_of(state);
  moment.speed_mps = b.speed_mps;
  moment.position_m = is_trailing(config_) ? position_m_ - pivot_distance_m(config_) : position_m_;
  const Truth& t = moment.instant;
  const auto& wheelset = end[instrumented_].wheelset_mps2;
  const std::array<double, kExtras> extra = extras();
  moment.filtered = anti_alias_.update({t.frame_mps2, wheelset[0], wheelset[1], t.deflection_m,
                                        t.velocity_mps, t.damping_force_n, t.restoring_force_n,
                                        t.frame_mps2, extra[0], extra[1]});
}

std::array<double, kExtras> Simulation::extras() const noexcept {
  if (!vehicle_ || !extra_sensors_) return {};
  const auto own = static_cast<TruckPosition>(instrumented_);
  const auto other = static_cast<TruckPosition>(1 - instrumented_);
  return {vehicle_->state(own).frame_mps2 + vehicle_->end_mps2(own),
          vehicle_->state(other).frame_mps2};
}

void Simulation::sense_extras(const Signals& seen, SimulatedSample& sample) noexcept {
  if (!extra_sensors_) return;
  const auto counts = extra_sensors_->convert({seen[8], seen[9], 0.0}, sample.time_s);
  for (std::size_t e = 0; e < kExtras; ++e) {
    sample.extra_counts[e] = counts[e];
    sample.extra_mps2[e] = counts[e] * count_scale_mps2(config_.sensors.range_mps2[0]);
    if (counts[e] == kMaxCount || counts[e] == kMinCount)
      sample.saturated = static_cast<std::uint8_t>(sample.saturated | (1U << (kChannels + e)));
  }
}

const Simulation::Moment& Simulation::past(std::int64_t steps) const noexcept {
  return history_[static_cast<std::size_t>(steps_ - steps) % kHistory];
}

// Cubic Lagrange interpolation at 2400 Hz of signals that end near 100 Hz.
double Simulation::skewed(std::size_t channel) const noexcept {
  const double back =
      static_cast<double>(look_ahead_) + config_.sensors.time_skew_s[channel] * kStepRateHz;
  const double whole = std::floor(back);
  const double u = back - whole;
  const auto n = static_cast<std::int64_t>(whole);
  const auto x = [&](std::int64_t offset) { return past(n + offset).filtered[channel]; };
  return -u * (u - 1.0) * (u - 2.0) / 6.0 * x(-1) + (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0 * x(0) -
         (u + 1.0) * u * (u - 2.0) / 2.0 * x(1) + (u + 1.0) * u * (u - 1.0) / 6.0 * x(2);
}

SimulatedSample Simulation::next() {
  const Moment& moment = past(look_ahead_);
  const Signals& seen = moment.filtered;
  SimulatedSample sample;
  sample.tick = tick_;
  sample.time_s = static_cast<double>(tick_) / kSampleRateHz;
  std::array<double, kChannels> accel{seen[0], seen[1], seen[2]};
  if (has_skew_) {
    for (std::size_t c = 0; c < kChannels; ++c) accel[c] = skewed(c);
  }
  sample.counts = sensors_.convert(accel, sample.time_s);
  for (std::size_t c = 0; c < kChannels; ++c) {
    const int counts = sample.counts[c];
    sample.accel_mps2[c] = counts * count_scale_mps2(config_.sensors.range_mps2[c]);
    if (counts == kMaxCount || counts == kMinCount) {
      sample.saturated = static_cast<std::uint8_t>(sample.saturated | (1U << c));
    }
  }
  sense_extras(seen, sample);
  sample.truth = {seen[3], seen[4], seen[5], seen[6], seen[7]};
  sample.instant = moment.instant;
  sample.speed_mps = moment.speed_mps;
  sample.position_m = moment.position_m;
  ++tick_;
  for (std::int64_t i = 0; i < kDecimation; ++i) step();
  return sample;
}

double anti_alias_delay_s(const SensorConfig& config) noexcept {
  // sum of the damping terms of the analogue prototype over its corner
  const double sum =
      2.0 * (std::sin(std::numbers::pi / 8.0) + std::sin(3.0 * std::numbers::pi / 8.0));
  const double corner =
      2.0 * kStepRateHz * std::tan(std::numbers::pi * config.anti_alias_corner_hz / kStepRateHz);
  return sum / corner;
}

Sample to_sample(const SimulatedSample& sample) noexcept {
  Sample out{.tick = sample.tick,
             .time_ns = std::llround(sample.time_s * 1e9),
             .accel_mps2 = sample.accel_mps2,
             .saturated = sample.saturated};
  for (std::size_t e = 0; e < kExtras; ++e)
    out.extra_mps2[e] = static_cast<float>(sample.extra_mps2[e]);
  return out;
}

}  // namespace dampline::sim
