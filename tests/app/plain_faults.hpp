// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "dampline/faults.hpp"
#include "tests/app/plain_truck.hpp"

/// Faults of sensors and of their transport, of random strength, on a plain truck.
namespace dampline::test {

/// A record to be made: what is wrong with it, and what the program is told.
struct FaultyRecord {
  const PlainMotion& motion;
  PlainSensors sensors;
  PlainFault fault;
  app::Config config;
  std::mt19937_64 random;

  [[nodiscard]] double between(double low, double high) {
    return std::uniform_real_distribution<double>{low, high}(random);
  }
  [[nodiscard]] double either_sign(double low, double high) {
    return (between(-1.0, 1.0) < 0.0 ? -1.0 : 1.0) * between(low, high);
  }
  [[nodiscard]] std::size_t any_channel() { return static_cast<std::size_t>(between(0.0, 3.0)); }
  [[nodiscard]] std::size_t any_wheelset() { return static_cast<std::size_t>(between(1.0, 3.0)); }
};

struct PlainFaultCase {
  const char* name;
  /// Any of them names it; empty: it is corrected, refused or in the deviations without a name.
  std::vector<FaultKind> right;
  bool needs_all{false};  ///< nothing tells it where the mass alone is declared
  std::function<void(FaultyRecord&)> make;
};

namespace plain {

inline constexpr double kRateHz = 300.0;
inline constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
inline double full_scale_mps2(std::size_t channel) { return channel == 0 ? 10.0 : 60.0; }

/// The magnitude that this share of a row's values exceeds.
inline double exceeded(std::vector<double> row, double share) {
  for (double& value : row) value = std::abs(value);
  const auto at =
      row.begin() + static_cast<std::ptrdiff_t>((1.0 - share) * static_cast<double>(row.size()));
  std::nth_element(row.begin(), at, row.end());
  return *at;
}

/// Each value of one channel from one time to another.
template <class Change>
auto within(std::size_t channel, double from_s, double to_s, Change change) {
  return [=](PlainRows& rows) mutable {
    std::vector<double>& row = rows[channel];
    const auto from = static_cast<std::size_t>(from_s * kRateHz);
    const auto to = std::min(row.size(), static_cast<std::size_t>(to_s * kRateHz));
    for (std::size_t i = from; i < to; ++i) change(row, i);
  };
}
inline constexpr double kForEver = 1e9;

inline auto noise(std::uint64_t seed, double rms) {
  return [random = std::mt19937_64{seed}, normal = std::normal_distribution<double>{0.0, rms}](
             std::vector<double>& row, std::size_t i) mutable { row[i] += normal(random); };
}
inline auto gain(double at_start, double at_end, double length_s) {
  return [=](std::vector<double>& row, std::size_t i) {
    row[i] *= 1.0 + at_start + (at_end - at_start) * static_cast<double>(i) / (length_s * kRateHz);
  };
}
/// From one time on; of one channel, or of all (3).
inline auto later_from(std::size_t channel, double from_s, double late_s) {
  return [=](std::size_t c, double time_s) {
    return time_s >= from_s && (channel == 3 || channel == c) ? late_s : 0.0;
  };
}
inline auto limit(std::size_t channel, double most) {
  return [=](PlainRows& rows) {
    for (double& value : rows[channel]) value = std::clamp(value, -most, most);
  };
}
/// So large a share of values is missing, of each channel by itself or of all at once.
inline auto lose(std::uint64_t seed, double share, bool together) {
  return [=](PlainRows& rows) {
    std::mt19937_64 random{seed};
    std::uniform_real_distribution<double> even;
    for (std::size_t i = 0; i < rows[0].size(); ++i) {
      const bool all = even(random) < share;
      for (std::vector<double>& row : rows)
        if (together ? all : even(random) < share) row[i] = kNothing;
    }
  };
}
inline auto scaled(double factor, std::size_t first, std::size_t last) {
  return [=](PlainRows& rows) {
    for (std::size_t c = first; c <= last; ++c)
      for (double& value : rows[c]) value *= factor;
  };
}

}  // namespace plain

/// What the values of a channel suffer. Records last `length_s`.
inline std::vector<PlainFaultCase> plain_value_faults(double length_s) {
  using namespace plain;
  using K = FaultKind;
  using R = FaultyRecord;
  const auto any_time = [length_s](R& r) { return r.between(0.2 * length_s, 0.8 * length_s); };
  return {
      {"clipping below full scale",
       {K::kClipping},
       false,
       [](R& r) {
         const std::size_t c = r.any_channel();
         r.fault.analogue = [c, share = r.between(0.002, 0.08)](PlainRows& rows) {
           limit(c, exceeded(rows[c], share))(rows);
         };
       }},
      {"clipping at full scale",
       {K::kClipping},
       false,
       [](R& r) {
         const std::size_t c = r.any_channel();
         const double most = exceeded(r.motion.seen[c], r.between(0.002, 0.08));
         r.fault.analogue = limit(c, most);
         if (r.config.input.range_mps2[c]) r.config.input.range_mps2[c] = most;
       }},
      {"stuck channel",
       {K::kStuckChannel},
       false,
       [any_time](R& r) {
         const double from_s = any_time(r);
         r.fault.digital =
             within(r.any_channel(), from_s, from_s + r.between(0.4, 30.0),
                    [](std::vector<double>& row, std::size_t i) { row[i] = row[i - 1]; });
       }},
      {"spikes",
       {K::kSpikes},
       false,
       [](R& r) {
         const std::size_t c = r.any_channel();
         r.fault.digital = [c, size = r.between(0.3, 0.8) * full_scale_mps2(c), random = r.random,
                            many = r.between(5.0, 40.0)](PlainRows& rows) mutable {
           std::uniform_int_distribution<std::size_t> place{0, rows[c].size() - 1};
           for (double i = 0.0; i < many; i += 1.0) rows[c][place(random)] = size;
         };
       }},
      {"DC jump",
       {K::kDcJump},
       false,
       [any_time](R& r) {
         r.fault.analogue =
             within(r.any_channel(), any_time(r), kForEver,
                    [jump = r.either_sign(0.4, 2.0)](auto& row, std::size_t i) { row[i] += jump; });
       }},
      {"resolution lost, 2-4 bits",
       {},
       false,
       [](R& r) {
         const std::size_t c = r.any_channel();
         const double step =
             full_scale_mps2(c) / 2048.0 * std::exp2(std::floor(r.between(2.0, 5.0)));
         r.fault.digital = within(c, 0.0, kForEver, [step](auto& row, std::size_t i) {
           row[i] = step * std::floor(row[i] / step);
         });
       }},
      {"frame and wheelset swapped",
       {K::kSwappedChannels},
       false,
       [](R& r) {
         r.fault.analogue = [c = r.any_wheelset()](PlainRows& rows) { rows[0].swap(rows[c]); };
       }},
      {"wheelsets swapped",
       {K::kSwappedChannels},
       true,
       [](R& r) { r.fault.analogue = [](PlainRows& rows) { rows[1].swap(rows[2]); }; }},
      {"wrong polarity",
       {K::kWrongPolarity},
       false,
       [](R& r) {
         const std::size_t c = r.any_channel();
         r.fault.analogue = scaled(-1.0, c, c);
       }},
      {"soft saturation of a wheelset",
       {K::kSoftSaturation},
       false,
       [](R& r) {
         r.fault.analogue = [c = r.any_wheelset(), times = r.between(3.0, 8.0)](PlainRows& rows) {
           const double full = times * exceeded(rows[c], 0.3173);
           for (double& value : rows[c]) value = full * std::tanh(value / full);
         };
       }},
      {"noise x3-6, all channels",
       {K::kExcessNoise},
       true,
       [](R& r) { r.sensors.noise_mps2 *= r.between(3.0, 6.0); }},
      {"noise, one channel",
       {K::kExcessNoise},
       true,
       [](R& r) {
         const double rms = 0.02 * r.between(3.0, 6.0);
         r.fault.analogue = within(r.any_channel(), 0.0, kForEver, noise(r.random(), rms));
       }},
      {"noise burst",
       {K::kNoiseBurst, K::kExcessNoise},
       false,
       [any_time](R& r) {
         const double from_s = any_time(r);
         const double rms = 0.02 * r.between(8.0, 20.0);
         r.fault.analogue =
             within(r.any_channel(), from_s, from_s + r.between(5.0, 30.0), noise(r.random(), rms));
       }},
      {"loose cable that reads 0 or full scale",
       {K::kStuckChannel, K::kSpikes, K::kNoiseBurst, K::kExcessNoise, K::kClipping, K::kDcJump},
       false,
       [any_time](R& r) {
         const double from_s = any_time(r);
         const std::size_t c = r.any_channel();
         const double open = r.between(0.0, 1.0) < 0.5 ? 0.0 : -full_scale_mps2(c);
         r.fault.digital =
             within(c, from_s, from_s + r.between(20.0, 120.0),
                    [open, random = r.random, hz = r.between(0.3, 5.0), is_open = false](
                        std::vector<double>& row, std::size_t i) mutable {
                      std::uniform_real_distribution<double> even;
                      if (even(random) < hz / kRateHz) is_open = !is_open;
                      if (is_open) row[i] = open;
                    });
       }},
      {"gain step of a wheelset 3-10 %",
       {K::kGainChange},
       false,
       [any_time, length_s](R& r) {
         const double step = r.either_sign(0.03, 0.10);
         r.fault.analogue =
             within(r.any_wheelset(), any_time(r), kForEver, gain(step, step, length_s));
       }},
      {"gain drift of a wheelset 3-10 %",
       {K::kGainChange},
       false,
       [length_s](R& r) {
         r.fault.analogue = within(r.any_wheelset(), 0.0, kForEver,
                                   gain(0.0, r.either_sign(0.03, 0.10), length_s));
       }},
      {"gain step of the frame 3-10 %",
       {K::kGainChange},
       false,
       [any_time, length_s](R& r) {
         const double step = r.either_sign(0.03, 0.10);
         r.fault.analogue = within(0, any_time(r), kForEver, gain(step, step, length_s));
       }},
      {"wheelset 2 a copy of wheelset 1",
       {K::kIdenticalChannels},
       false,
       [](R& r) { r.fault.digital = [](PlainRows& rows) { rows[2] = rows[1]; }; }},
      {"frame in g", {}, false, [](R& r) { r.fault.digital = scaled(1.0 / 9.80665, 0, 0); }},
      {"all in g", {}, false, [](R& r) { r.fault.digital = scaled(1.0 / 9.80665, 0, 2); }},
      {"1 % lost, of each channel",
       {},
       false,
       [](R& r) { r.fault.digital = lose(r.random(), 0.01, false); }},
      {"1 % lost, of all", {}, false, [](R& r) { r.fault.digital = lose(r.random(), 0.01, true); }},
      {"5 % lost, of each channel",
       {},
       false,
       [](R& r) { r.fault.digital = lose(r.random(), 0.05, false); }},
  };
}

/// What their times suffer, and the filters before the converter.
inline std::vector<PlainFaultCase> plain_timing_faults(double length_s) {
  using namespace plain;
  using K = FaultKind;
  using R = FaultyRecord;
  const std::vector<K> timing{K::kLostSamples, K::kRepeatedSamples, K::kTimingStep};
  const auto any_time = [length_s](R& r) { return r.between(0.2 * length_s, 0.8 * length_s); };
  constexpr double kSampleS = 1.0 / kRateHz;
  return {
      {"rate wrong by 1-2 %",
       {K::kWrongSampleRate},
       true,
       [](R& r) { *r.config.input.speed_mps *= 1.0 + r.either_sign(0.01, 0.02); }},
      {"one sample lost, one channel", timing, false,
       [any_time](R& r) { r.fault.late_s = later_from(r.any_channel(), any_time(r), kSampleS); }},
      {"one sample repeated, one channel", timing, false,
       [any_time](R& r) { r.fault.late_s = later_from(r.any_channel(), any_time(r), -kSampleS); }},
      {"1-3 samples lost, all channels",
       {K::kLostSamples},
       true,
       [any_time](R& r) {
         r.fault.late_s = later_from(3, any_time(r), std::floor(r.between(1.0, 4.0)) * kSampleS);
       }},
      {"timing step 1-8 ms", timing, false,
       [any_time](R& r) {
         r.fault.late_s = later_from(r.any_channel(), any_time(r), r.either_sign(1e-3, 8e-3));
       }},
      {"jitter 0.1-0.4 ms",
       {K::kJitter},
       false,
       [](R& r) { r.sensors.jitter_s = r.between(1e-4, 4e-4); }},
      {"clock drift 30-150 ppm",
       {K::kClockDrift},
       false,
       [](R& r) {
         r.fault.late_s = [channel = r.any_channel(), rate = 1e-6 * r.either_sign(30.0, 150.0)](
                              std::size_t c, double time_s) {
           return c == channel ? rate * time_s : 0.0;
         };
       }},
      {"frame 0.5-3 ms late",
       {},
       false,
       [](R& r) { r.sensors.late_s[0] = r.either_sign(0.5e-3, 3e-3); }},
      {"one wheelset 0.5-3 ms late",
       {},
       false,
       [](R& r) { r.sensors.late_s[r.any_wheelset()] = r.either_sign(0.5e-3, 3e-3); }},
      {"one after the other, 1.1 ms",
       {},
       false,
       [](R& r) {
         r.sensors.late_s = {0.0, 1.1e-3, 2.2e-3};
       }},
      {"a low pass higher than declared",
       {K::kWrongLowPass},
       false,
       [](R& r) { r.config.input.anti_alias.corner_hz = r.between(60.0, 80.0); }},
      {"frame behind 45-80 Hz",
       {K::kWrongLowPass},
       false,
       [](R& r) { r.sensors.own_corner_hz[0] = r.between(45.0, 80.0); }},
      {"one wheelset behind 45-80 Hz",
       {K::kWrongLowPass},
       false,
       [](R& r) { r.sensors.own_corner_hz[r.any_wheelset()] = r.between(45.0, 80.0); }},
      {"both wheelsets behind 45-80 Hz",
       {K::kWrongLowPass},
       false,
       [](R& r) {
         const double corner_hz = r.between(45.0, 80.0);
         r.sensors.own_corner_hz = {0.0, corner_hz, corner_hz};
       }},
  };
}

/// What `explain` makes of a truck's motion with such a fault.
inline PlainExplained explained_with(const PlainTruck& truck, const PlainMotion& motion,
                                     const PlainFaultCase& fault, std::uint64_t seed,
                                     double length_s, bool all_declared) {
  FaultyRecord record{motion, {}, {}, plain_config(truck, {}), std::mt19937_64{seed}};
  if (all_declared) {
    record.config.car.wheelbase_m = plain::kWheelbaseM;
    record.config.input.speed_mps = truck.speed_mps;
    record.config.input.leading = "wheelset1";
    record.config.input.noise_mps2.fill(record.sensors.noise_mps2);
    for (std::size_t c = 0; c < 3; ++c)
      record.config.input.range_mps2[c] = plain::full_scale_mps2(c);
  }
  fault.make(record);
  std::optional<PlainMotion> own;
  if (record.sensors.own_corner_hz != PlainSensors{}.own_corner_hz)
    own = plain_motion(truck, record.sensors, length_s + 0.1, motion.seed);
  const PlainRows rows = plain_rows(own ? *own : motion, record.sensors, length_s, record.fault);
  const TemporaryFile file{plain_text(rows, record.sensors.rate_hz)};
  return explained_from(record.config, file.path());
}

}  // namespace dampline::test
