// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/explanation.hpp"
#include "app/identify/source.hpp"
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
  double corner_hz{100.0};                ///< of a Butterworth low pass of fourth order; 0: none
  std::array<double, 3> own_corner_hz{};  ///< of a channel whose corner is another
  double noise_mps2{0.02};                ///< white, rms
  int bits{12};                           ///< of 20 m/s^2 for the frame, 120 m/s^2 for wheelsets
  double jitter_s{0.0};                   ///< rms, of each channel by itself

  std::array<double, 3> late_s{};  ///< each channel's samples are taken so much later
  // Where they sit, and what else they see.
  double off_centre_m{0.0};       ///< of the frame's, which sees its pitch there
  double roll{0.0};               ///< of the wheelsets', over their vertical motion
  bool frame_rolls{false};        ///< the frame's sees that too, below 3 Hz
  double hunting_mps2{0.0};       ///< rms of what the frame's sees of a motion at 2.5 Hz
  double frame_mount_hz{0.0};     ///< resonance of what the frame's is mounted on; 0: none
  double wheelset_mount_hz{0.0};  ///< the same of wheelset 1
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

/// x'' + 2 D w x' + w^2 x = w^2 u.
inline void resonate(double hz, double damping, Signal& signal) {
  const double h = 1.0 / kFineHz;
  const double w = kTwoPi * hz;
  double x = 0.0, v = 0.0;
  for (double& u : signal) {
    v += h * (w * w * (u - x) - 2.0 * damping * w * v);
    x += h * v;
    u = x;
  }
}

/// What sensors see that sit elsewhere, of their own accelerations: frame, wheelset 1, wheelset 2.
/// The frame pitches with the wheelsets' difference, with a resonance at 8 Hz.
inline void misplace(const PlainTruck& truck, const PlainSensors& sensors, std::uint64_t seed,
                     std::array<Signal, 3>& seen) {
  const std::size_t count = seen[0].size();
  std::mt19937_64 random{seed + 1000};
  Signal more(count);
  const auto add = [&seen](std::size_t channel, const Signal& what) {
    for (std::size_t i = 0; i < what.size(); ++i) seen[channel][i] += what[i];
  };
  if (sensors.off_centre_m != 0.0) {
    for (std::size_t i = 0; i < count; ++i)
      more[i] = sensors.off_centre_m * (seen[1][i] - seen[2][i]) / kWheelbaseM;
    resonate(8.0, 0.2, more);
    add(0, more);
  }
  if (sensors.roll > 0.0) {
    const auto lag = static_cast<std::size_t>(kWheelbaseM / truck.speed_mps * kFineHz);
    const Signal rail = road(count + lag, truck.speed_mps, random);
    for (std::size_t i = 0; i < count; ++i) {
      seen[1][i] += sensors.roll * rail[i + lag];
      seen[2][i] += sensors.roll * rail[i];
      more[i] = 0.5 * sensors.roll * (rail[i] + rail[i + lag]);
    }
    resonate(3.0, 0.2, more);
    if (sensors.frame_rolls) add(0, more);
  }
  if (sensors.hunting_mps2 > 0.0) add(0, band(count, 2.5, 0.03, sensors.hunting_mps2, random));
  if (sensors.frame_mount_hz > 0.0) resonate(sensors.frame_mount_hz, 0.03, seen[0]);
  if (sensors.wheelset_mount_hz > 0.0) resonate(sensors.wheelset_mount_hz, 0.03, seen[1]);
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

/// Of frame, wheelset 1 and wheelset 2, as sampled, m/s^2; not a number: missing.
using PlainRows = std::array<std::vector<double>, 3>;

/// What is wrong with the sensors or with their transport. What is empty is sound.
struct PlainFault {
  /// A channel's sample is taken so much later, s.
  std::function<double(std::size_t channel, double time_s)> late_s;
  std::function<void(PlainRows& rows)> analogue;  ///< before the converter
  std::function<void(PlainRows& rows)> digital;   ///< behind it
};

/// What the sensors see, finely sampled, and the numbers that noise is drawn from.
struct PlainMotion {
  std::array<plain::Signal, 3> seen;
  std::mt19937_64 random;
  std::uint64_t seed;
};

inline PlainMotion plain_motion(const PlainTruck& truck, const PlainSensors& sensors,
                                double length_s, std::uint64_t seed) {
  using namespace plain;
  PlainMotion motion{{}, std::mt19937_64{seed}, seed};
  std::array<Signal, 3>& seen = motion.seen;
  const auto lag = static_cast<std::size_t>(kWheelbaseM / truck.speed_mps * kFineHz);
  const auto count = static_cast<std::size_t>(length_s * kFineHz);
  const Signal rail = road(count + lag, truck.speed_mps, motion.random);
  seen[1].assign(rail.begin() + static_cast<std::ptrdiff_t>(lag), rail.end());
  seen[2].assign(rail.begin(), rail.begin() + static_cast<std::ptrdiff_t>(count));
  seen[0] = frame(truck, seen[1], seen[2]);
  misplace(truck, sensors, seed, seen);
  for (std::size_t c = 0; c < seen.size(); ++c) {
    const double own_hz = sensors.own_corner_hz[c];
    const double corner_hz = own_hz > 0.0 ? own_hz : sensors.corner_hz;
    if (corner_hz > 0.0) low_pass(corner_hz, seen[c]);
  }
  return motion;
}

/// Of a record of this length. Draws from a copy of the motion's numbers.
inline PlainRows plain_rows(const PlainMotion& motion, const PlainSensors& sensors, double length_s,
                            const PlainFault& fault = {}) {
  std::mt19937_64 random = motion.random;
  std::normal_distribution<double> normal;
  const auto last = static_cast<double>(motion.seen[0].size() - 1);
  const auto samples = static_cast<std::size_t>(length_s * sensors.rate_hz);
  PlainRows rows;
  for (std::vector<double>& row : rows) row.resize(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double time_s = static_cast<double>(i) / sensors.rate_hz;
    for (std::size_t c = 0; c < 3; ++c) {
      const double late_s = sensors.late_s[c] + (fault.late_s ? fault.late_s(c, time_s) : 0.0);
      const double at = plain::kFineHz * (time_s + late_s + sensors.jitter_s * normal(random));
      const auto place = static_cast<std::size_t>(std::clamp(at, 0.0, last));
      rows[c][i] = motion.seen[c][place] + 0.1 + sensors.noise_mps2 * normal(random);
    }
  }
  if (fault.analogue) fault.analogue(rows);
  for (std::size_t c = 0; c < 3; ++c) {
    const double step = (c == 0 ? 20.0 : 120.0) / std::exp2(sensors.bits);
    for (double& value : rows[c]) value = step * std::round(value / step);
  }
  if (fault.digital) fault.digital(rows);
  return rows;
}

/// As CSV; the cell of what is missing is empty.
inline std::string plain_text(const PlainRows& rows, double rate_hz) {
  std::string text = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    text += fmt::format("{:.7f}", static_cast<double>(i) / rate_hz);
    for (const std::vector<double>& row : rows)
      text += std::isnan(row[i]) ? "," : fmt::format(",{:.6g}", row[i]);
    text += '\n';
  }
  return text;
}

/// A record as CSV.
inline std::string plain_record(const PlainTruck& truck, const PlainSensors& sensors,
                                double length_s, std::uint64_t seed) {
  const PlainMotion motion = plain_motion(truck, sensors, length_s, seed);
  return plain_text(plain_rows(motion, sensors, length_s), sensors.rate_hz);
}

/// Told of mass, rate and low pass.
inline app::Config plain_config(const PlainTruck& truck, const PlainSensors& sensors) {
  app::Config config;
  config.car.moving_mass_kg = truck.mass_kg;
  config.input.sample_rate_hz = sensors.rate_hz;
  config.input.anti_alias.corner_hz = sensors.corner_hz;
  return config;
}

/// What `identify` makes of such a record.
inline app::RunResult identified_from(const PlainTruck& truck, const PlainSensors& sensors,
                                      double length_s, std::uint64_t seed) {
  const TemporaryFile file{plain_record(truck, sensors, length_s, seed)};
  return app::identify_source(plain_config(truck, sensors), {file.path(), false},
                              app::SourceKind::kTruckRows, false)
      .result;
}

struct PlainExplained {
  app::Explanation explanation;
  app::RunResult result;
  [[nodiscard]] bool has_fault(const std::string& name) const {
    const auto& list = result.faults.list;
    return std::any_of(list.begin(), list.end(), [&](const auto& f) { return f.name == name; });
  }
  /// Of the suspension or of its sensors.
  [[nodiscard]] bool names_effect() const {
    const auto& steps = explanation.steps;
    return std::any_of(steps.begin(), steps.end(),
                       [](const auto& step) { return step.effect != "unknown"; });
  }
};

/// What `explain` makes of a file.
inline PlainExplained explained_from(const app::Config& config, const std::string& path) {
  app::Explained explained = app::explain_truck(config, {{path, false}, {}, false});
  app::RunResult result = explained.identified;
  app::Explanation explanation = app::conclude(explained, result);
  return {std::move(explanation), std::move(result)};
}
/// Of a record whose sensors are declared as they are.
inline PlainExplained explained_from(const PlainTruck& truck, const PlainSensors& sensors,
                                     double length_s, std::uint64_t seed) {
  const TemporaryFile file{plain_record(truck, sensors, length_s, seed)};
  return explained_from(plain_config(truck, sensors), file.path());
}

}  // namespace dampline::test
