// SPDX-License-Identifier: MIT
#include "sim_hw/track.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>

namespace dampline::sim {
namespace {

struct Step {
  double value;
  double rate_ps;
};

/// 0 before `start_s`, 1 after start_s + length_s, 6 u^5 - 15 u^4 + 10 u^3 between.
Step smooth_step(double time_s, double start_s, double length_s) noexcept {
  const double u = length_s > 0.0 ? (time_s - start_s) / length_s : (time_s < start_s ? 0.0 : 1.0);
  if (u <= 0.0) return {0.0, 0.0};
  if (u >= 1.0) return {1.0, 0.0};
  return {u * u * u * (10.0 + u * (6.0 * u - 15.0)),
          30.0 * u * u * (1.0 - u) * (1.0 - u) / length_s};
}

/// Share of the speed that the standstills leave.
Step running_share(const SpeedConfig& config, double speed_mps, double time_s) noexcept {
  const double length = speed_mps / config.ramp_mps2;
  Step share{1.0, 0.0};
  for (const Standstill& standstill : config.standstills) {
    if (!(standstill.end_s > standstill.start_s)) continue;
    const Step brake = smooth_step(time_s, standstill.start_s - length, length);
    const Step start = smooth_step(time_s, standstill.end_s, length);
    share.value = share.value - brake.value + start.value;
    share.rate_ps = share.rate_ps + start.rate_ps - brake.rate_ps;
  }
  return share;
}

}  // namespace

Speed speed_at(const SpeedConfig& config, double time_s) noexcept {
  Speed cruise{config.speed_mps, 0.0};
  if (config.change_time_s >= 0.0) {
    const double change = config.changed_speed_mps - config.speed_mps;
    const Step step =
        smooth_step(time_s, config.change_time_s, std::abs(change) / config.ramp_mps2);
    cruise.speed_mps += change * step.value;
    cruise.accel_mps2 = change * step.rate_ps;
  }
  const Step share = running_share(config, config.speed_mps, time_s);
  return {cruise.speed_mps * share.value,
          cruise.accel_mps2 * share.value + cruise.speed_mps * share.rate_ps};
}

namespace {

constexpr double kWarmUpM = 500.0;  // ten lengths of the longest correlation, 1 / Or
constexpr double kPi = std::numbers::pi;

SectionChain make_long_waves(const TrackConfig& config) {
  const double contact = 2.0 * kPi / config.contact_wavelength_m;
  const double square = contact * contact;
  const double rapid = config.corner_radpm;
  const double slow = config.long_wave_corner_radpm;
  const std::array<Section, 3> sections{
      Section{2.0 * std::sin(kPi / 8.0) * contact, square, square},
      Section{2.0 * std::sin(3.0 * kPi / 8.0) * contact, square, square},
      Section{rapid + slow, rapid * slow, rapid * std::sqrt(kPi * config.amplitude_m_rad)}};
  return {sections.data(), sections.size(), Track::kGridM};
}

/// Band pass of 4th order, s^2 B^2 over the transformed 2nd-order Butterworth polynomial: half
/// power at centre -+ half the width. The numerator is the second derivative, so the curvature is
/// band passed, and slope and profile exist.
SectionChain make_short_waves(const TrackConfig& config) {
  const double per_hz = 2.0 * kPi / config.nominal_speed_mps;
  const double width = config.short_wave_width_hz * per_hz;
  const double low = (config.short_wave_centre_hz - 0.5 * config.short_wave_width_hz) * per_hz;
  const std::complex<double> half_pole = 0.5 * width * std::polar(1.0, 0.75 * kPi);
  const std::complex<double> root = std::sqrt(half_pole * half_pole - low * (low + width));
  const auto section = [](std::complex<double> pole) {
    return Section{-2.0 * pole.real(), std::norm(pole), 1.0};
  };
  const std::array<Section, 2> sections{section(half_pole + root), section(half_pole - root)};
  return {sections.data(), sections.size(), Track::kGridM};
}

}  // namespace

Track::Track(const TrackConfig& config, double memory_m, std::uint64_t seed)
    : long_waves_(make_long_waves(config)),
      short_waves_(make_short_waves(config)),
      long_random_(seed, Stream::kTrack),
      short_random_(seed, Stream::kShortWave),
      ring_(std::bit_ceil(static_cast<std::size_t>(memory_m / kGridM) + 8U)) {
  const auto warm_up = static_cast<std::size_t>(kWarmUpM / kGridM);
  if (config.short_wave_mps2 > 0.0) {
    const double speed = config.nominal_speed_mps;
    const double rms = stationary_rms(short_waves_, warm_up).second_derivative * speed * speed;
    short_wave_gain_ = config.short_wave_mps2 / rms;
  }
  for (std::size_t i = 0; i < warm_up; ++i) add_point();
  origin_ = static_cast<double>(newest_);
}

void Track::add_point() {
  long_waves_.advance(long_random_.normal());
  TrackPoint point{long_waves_.first_derivative(), long_waves_.second_derivative()};
  if (short_wave_gain_ > 0.0) {
    short_waves_.advance(short_random_.normal());
    point.slope += short_wave_gain_ * short_waves_.first_derivative();
    point.curvature_pm += short_wave_gain_ * short_waves_.second_derivative();
  }
  ++newest_;
  ring_[newest_ & (ring_.size() - 1)] = point;
}

void Track::extend_to(double position_m) {
  const auto needed = static_cast<std::uint64_t>(position_m / kGridM + origin_) + 1;
  while (newest_ < needed) add_point();
}

TrackPoint Track::at(double position_m) const noexcept {
  const double place = position_m / kGridM + origin_;
  const double whole = std::floor(place);
  const double u = place - whole;
  const auto index = static_cast<std::uint64_t>(whole);
  const std::size_t mask = ring_.size() - 1;
  const TrackPoint& a = ring_[index & mask];
  const TrackPoint& b = ring_[(index + 1) & mask];
  const double rise = b.slope - a.slope;
  const double ca = a.curvature_pm * kGridM;
  const double cb = b.curvature_pm * kGridM;
  const double second = 3.0 * rise - 2.0 * ca - cb;
  const double third = ca + cb - 2.0 * rise;
  return {a.slope + u * (ca + u * (second + u * third)),
          (ca + u * (2.0 * second + u * 3.0 * third)) / kGridM};
}

}  // namespace dampline::sim
