// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "app/identify/identify_source.hpp"
#include "tests/drivers/temporary_file.hpp"

/// A truck on rough track and what sensors of any kind make of it, by a simulation of its own:
/// noise through filters as the track, friction that holds or slides by an exact rule at 77 kHz,
/// sensors with any rate, low pass, noise, resolution and jitter.
namespace dampline::test {

struct PlainTruck {
  const char* name;
  double mass_kg;
  double spring_npm;
  double coulomb_n;
  double speed_mps;
};
inline constexpr std::array kPlainTrucks{PlainTruck{"laden 80", 37200.0, 5.26e6, 8356.0, 22.2},
                                         PlainTruck{"laden 60", 37200.0, 5.26e6, 8356.0, 16.7},
                                         PlainTruck{"empty 80", 9700.0, 2.0e6, 3290.0, 22.2}};

struct PlainSensors {
  double rate_hz{300.0};
  double corner_hz{100.0};  ///< of a Butterworth low pass of fourth order; 0: none
  double noise_mps2{0.02};  ///< white, rms
  int bits{12};             ///< of 20 m/s^2 for the frame, 120 m/s^2 for wheelsets
  double jitter_s{0.0};     ///< rms, of each channel by itself
};

namespace plain {

inline constexpr double kFineHz = 76800.0;
inline constexpr double kWheelbaseM = 1.8;
inline constexpr double kTwoPi = 6.283185307179586;

using Signal = std::vector<double>;

/// White noise through x'' + 2 zeta w x' + w^2 x; the velocity, scaled to this rms.
inline Signal band(std::size_t count, double hz, double zeta, double rms, std::mt19937_64& random) {
  const double h = 1.0 / kFineHz;
  const double w = kTwoPi * hz;
  std::normal_distribution<double> normal;
  Signal out(count);
  double x = 0.0, v = 0.0, squares = 0.0;
  for (double& each : out) {
    v += h * (normal(random) - 2.0 * zeta * w * v - w * w * x);
    x += h * v;
    each = v;
    squares += v * v;
  }
  const double factor = rms / std::sqrt(squares / static_cast<double>(count));
  for (double& each : out) each *= factor;
  return out;
}

/// Acceleration of a wheelset: the track of ORE B176 with low irregularity, contact patch and
/// wheel's elasticity as two poles at 75 Hz, and 2 m/s^2 rms of short waves around 58 Hz.
inline Signal road(std::size_t count, double speed_mps, std::mt19937_64& random) {
  const double h = 1.0 / kFineHz;
  const double fast = 0.8246 * speed_mps;
  const double slow = 0.0206 * speed_mps;
  const double gain = fast * std::sqrt(0.5 * kTwoPi * 4.032e-7 * speed_mps);
  const double pole = kTwoPi * 75.0;
  Signal out = band(count, 58.0, 0.2, 2.0, random);
  std::normal_distribution<double> normal{0.0, std::sqrt(kFineHz)};
  double one = 0.0, two = 0.0, z = 0.0, velocity = 0.0;
  for (double& each : out) {
    one += h * pole * (normal(random) - one);
    two += h * pole * (one - two);
    const double accel = gain * two - (fast + slow) * velocity - fast * slow * z;
    velocity += h * accel;
    z += h * velocity;
    each += accel;
  }
  return out;
}

/// The frame's acceleration: M z'' = -k y - F, y'' = 2 z'' - z_1'' - z_2'', with friction that
/// holds up to its level.
inline Signal frame(const PlainTruck& truck, const Signal& first, const Signal& second) {
  const double h = 1.0 / kFineHz;
  Signal out(first.size());
  double y = 0.0, v = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double rails = first[i] + second[i];
    const double holding_n = -truck.spring_npm * y - 0.5 * truck.mass_kg * rails;
    const bool holds = v == 0.0 && std::abs(holding_n) <= truck.coulomb_n;
    const double force_n = std::copysign(truck.coulomb_n, v != 0.0 ? v : holding_n);
    out[i] = holds ? 0.5 * rails : (-truck.spring_npm * y - force_n) / truck.mass_kg;
    if (holds) continue;
    const double next = v + h * (2.0 * out[i] - rails);
    v = next * v < 0.0 ? 0.0 : next;
    y += h * v;
  }
  return out;
}

inline void low_pass(double corner_hz, Signal& signal) {
  const double k = std::tan(0.5 * kTwoPi * corner_hz / kFineHz);
  for (const double damping : {1.847759065, 0.7653668647}) {
    const double norm = 1.0 / (1.0 + damping * k + k * k);
    const double a1 = 2.0 * (k * k - 1.0) * norm;
    const double a2 = (1.0 - damping * k + k * k) * norm;
    double s1 = 0.0, s2 = 0.0;
    for (double& x : signal) {
      const double in = k * k * norm * x;
      const double out = in + s1;
      s1 = 2.0 * in - a1 * out + s2;
      s2 = in - a2 * out;
      x = out;
    }
  }
}

}  // namespace plain

/// A record as CSV.
inline std::string plain_record(const PlainTruck& truck, const PlainSensors& sensors,
                                double length_s, std::uint64_t seed) {
  using namespace plain;
  std::mt19937_64 random{seed};
  const auto lag = static_cast<std::size_t>(kWheelbaseM / truck.speed_mps * kFineHz);
  const auto count = static_cast<std::size_t>(length_s * kFineHz);
  const Signal rail = road(count + lag, truck.speed_mps, random);
  std::array<Signal, 3> seen;
  seen[1].assign(rail.begin() + static_cast<std::ptrdiff_t>(lag), rail.end());
  seen[2].assign(rail.begin(), rail.begin() + static_cast<std::ptrdiff_t>(count));
  seen[0] = frame(truck, seen[1], seen[2]);
  if (sensors.corner_hz > 0.0)
    for (Signal& each : seen) low_pass(sensors.corner_hz, each);
  std::normal_distribution<double> normal;
  std::string text = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  const auto samples = static_cast<std::size_t>(length_s * sensors.rate_hz);
  for (std::size_t i = 0; i < samples; ++i) {
    const double time_s = static_cast<double>(i) / sensors.rate_hz;
    text += fmt::format("{:.7f}", time_s);
    for (std::size_t c = 0; c < 3; ++c) {
      const double at = kFineHz * (time_s + sensors.jitter_s * normal(random));
      const auto place =
          static_cast<std::size_t>(std::clamp(at, 0.0, static_cast<double>(count - 1)));
      const double step = (c == 0 ? 20.0 : 120.0) / std::exp2(sensors.bits);
      const double value = seen[c][place] + 0.1 + sensors.noise_mps2 * normal(random);
      text += fmt::format(",{:.6g}", step * std::round(value / step));
    }
    text += '\n';
  }
  return text;
}

/// What `identify` makes of such a record when it is told of mass, rate and low pass.
inline app::RunResult identified_from(const PlainTruck& truck, const PlainSensors& sensors,
                                      double length_s, std::uint64_t seed) {
  const TemporaryFile file{plain_record(truck, sensors, length_s, seed)};
  app::Config config;
  config.car.moving_mass_kg = truck.mass_kg;
  config.input.sample_rate_hz = sensors.rate_hz;
  config.input.anti_alias.corner_hz = sensors.corner_hz;
  return app::identify_source(config, {file.path(), false}, app::SourceKind::kTruckRows, false)
      .result;
}

}  // namespace dampline::test
