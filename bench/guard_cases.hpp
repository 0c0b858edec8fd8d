// SPDX-License-Identifier: MIT
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "dampline/guard/guard.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/faults.hpp"
#include "sim_hw/noise.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::bench {

/// A record to be made: a car, what is wrong with it, and what the guard is told.
struct GuardRecord {
  sim::SimulationConfig simulation;
  sim::RecordFaultConfig faults;
  GuardConfig guard;
  double length_s{300.0};
};

/// One row of the table: a fault, an effect or an input of random strength.
struct GuardCase {
  std::string name;
  std::vector<FaultKind> right;  ///< names that are right; empty: no fault at all
  std::function<void(GuardRecord& record, sim::Random& random)> make;
};

struct GuardCondition {
  const char* name;
  sim::Load load;
  double speed_kmh;
};
inline constexpr std::array<GuardCondition, 3> kGuardConditions{
    {{"laden 80", sim::Load::kLaden, 80.0},
     {"laden 60", sim::Load::kLaden, 60.0},
     {"empty 80", sim::Load::kEmpty, 80.0}}};

/// The condition's clean record, with everything declared as it is.
inline GuardRecord clean_record(const GuardCondition& condition, std::uint64_t seed) {
  GuardRecord record;
  record.simulation = sim::reference_run(condition.load, condition.speed_kmh, seed);
  record.guard.wheelbase_m = record.simulation.truck.wheelbase_m;
  record.guard.speed_mps = record.simulation.speed.speed_mps;
  record.guard.leading = Leading::kWheelset1;
  for (std::size_t c = 0; c < kChannels; ++c) {
    record.guard.step_mps2[c] = sim::count_scale_mps2(record.simulation.sensors.range_mps2[c]);
    record.guard.noise_mps2[c] = record.simulation.sensors.noise_mps2;
  }
  return record;
}

inline double between(sim::Random& random, double low, double high) {
  return low + (high - low) * random.uniform();
}
inline double either_sign(sim::Random& random, double low, double high) {
  return (random.uniform() < 0.5 ? -1.0 : 1.0) * between(random, low, high);
}
inline std::size_t any_channel(sim::Random& random) {
  return static_cast<std::size_t>(3.0 * random.uniform());
}
inline std::size_t any_wheelset(sim::Random& random) { return random.uniform() < 0.5 ? 1 : 2; }
inline double any_time(GuardRecord& record, sim::Random& random) {
  return record.faults.start_s = between(random, 60.0, 240.0);
}

/// The magnitude that this share of a channel's samples exceeds, from its first 60 s.
inline double exceeded(const GuardRecord& record, std::size_t channel, double share) {
  sim::Simulation simulation{record.simulation};
  std::vector<double> magnitude(60 * sim::kSampleRateHz);
  for (double& a : magnitude) a = std::abs(simulation.next().accel_mps2[channel]);
  const auto nth =
      static_cast<std::ptrdiff_t>((1.0 - share) * static_cast<double>(magnitude.size()));
  std::nth_element(magnitude.begin(), magnitude.begin() + nth, magnitude.end());
  return magnitude[static_cast<std::size_t>(nth)];
}
inline double rms_of(const GuardRecord& record, std::size_t channel) {
  return exceeded(record, channel, 0.3173);  // of a normal distribution
}

inline std::vector<GuardCase> lasting_cases() {
  using R = GuardRecord;
  using X = sim::Random;
  return {
      {"clipping at full scale",
       {FaultKind::kClipping},
       [](R& r, X& x) {
         const std::size_t c = any_channel(x);
         const double range = exceeded(r, c, between(x, 0.002, 0.08));
         r.simulation.sensors.range_mps2[c] = range;
         r.guard.step_mps2[c] = sim::count_scale_mps2(range);
       }},
      {"clipping below full scale",
       {FaultKind::kClipping},
       [](R& r, X& x) {
         const std::size_t c = any_channel(x);
         r.simulation.sensors.limit_mps2[c] = exceeded(r, c, between(x, 0.002, 0.08));
       }},
      {"stuck channel",
       {FaultKind::kStuckChannel},
       [](R& r, X& x) {
         const std::size_t c = any_channel(x);
         r.simulation.sensors.stuck_start_s[c] = any_time(r, x);
         r.simulation.sensors.stuck_end_s[c] = r.faults.start_s + between(x, 0.4, 30.0);
       }},
      {"spikes",
       {FaultKind::kSpikes},
       [](R& r, X& x) {
         const std::size_t c = any_channel(x);
         r.faults.spikes[c] = static_cast<int>(between(x, 5.0, 40.0));
         r.faults.spike_mps2 = between(x, 0.3, 0.8) * r.simulation.sensors.range_mps2[c];
       }},
      {"DC jump",
       {FaultKind::kDcJump},
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.dc_jump_mps2[any_channel(x)] = either_sign(x, 0.4, 2.0);
       }},
      {"resolution lost, 2-4 bits",
       {FaultKind::kResolutionLoss},
       [](R& r, X& x) {
         r.faults.lost_bits[any_channel(x)] = static_cast<int>(between(x, 2.0, 4.99));
       }},
      {"frame and wheelset swapped",
       {FaultKind::kSwappedChannels},
       [](R& r, X& x) {
         const std::size_t c = any_wheelset(x);
         r.simulation.sensors.range_mps2.fill(98.0665);
         r.guard.step_mps2.fill(sim::count_scale_mps2(98.0665));
         r.faults.source[0] = c;
         r.faults.source[c] = 0;
       }},
      {"wheelsets swapped",
       {FaultKind::kSwappedChannels},
       [](R& r, X&) {
         r.faults.source = {0, 2, 1};
       }},
      {"wrong polarity",
       {FaultKind::kWrongPolarity},
       [](R& r, X& x) { r.faults.inverted[any_channel(x)] = true; }},
      {"rate wrong by 1-2 %",
       {FaultKind::kWrongSampleRate},
       [](R& r, X& x) { r.guard.speed_mps *= 1.0 + either_sign(x, 0.01, 0.02); }},
      {"soft saturation of a wheelset",
       {FaultKind::kSoftSaturation},
       [](R& r, X& x) {
         const std::size_t c = any_wheelset(x);
         r.faults.saturation_mps2[c] = between(x, 3.0, 8.0) * rms_of(r, c);
       }},
      {"noise x3-6, all channels",
       {FaultKind::kExcessNoise},
       [](R& r, X& x) {
         const double factor = between(x, 3.0, 6.0);
         r.simulation.sensors.noise_mps2 *= factor;
       }},
      {"noise, one channel",
       {FaultKind::kExcessNoise},
       [](R& r, X& x) {
         const std::size_t c = any_channel(x);
         r.faults.noise_mps2[c] = between(x, 3.0, 6.0) * (c == 0 ? 0.02 : 0.03);
       }},
      {"noise burst",
       {FaultKind::kNoiseBurst, FaultKind::kExcessNoise},
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.end_s = r.faults.start_s + between(x, 5.0, 30.0);
         const std::size_t c = any_channel(x);
         r.faults.burst_mps2[c] = between(x, 8.0, 20.0) * (c == 0 ? 0.02 : 0.03);
       }},
      {"loose cable that reads 0 or full scale",
       {FaultKind::kStuckChannel, FaultKind::kSpikes, FaultKind::kNoiseBurst,
        FaultKind::kExcessNoise, FaultKind::kClipping, FaultKind::kDcJump},
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.end_s = r.faults.start_s + between(x, 20.0, 120.0);
         const std::size_t c = any_channel(x);
         r.faults.opens_hz[c] = between(x, 0.3, 5.0);
         if (x.uniform() < 0.5) r.faults.open_mps2 = -r.simulation.sensors.range_mps2[c];
       }},
  };
}

inline std::vector<GuardCase> timing_cases() {
  using R = GuardRecord;
  using X = sim::Random;
  const std::vector<FaultKind> timing{FaultKind::kLostSamples, FaultKind::kRepeatedSamples,
                                      FaultKind::kTimingStep};
  return {
      {"one sample lost, one channel", timing,
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.lost_samples[any_channel(x)] = 1;
       }},
      {"one sample repeated, one channel", timing,
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.repeated_samples[any_channel(x)] = 1;
       }},
      {"1-3 samples lost, all channels",
       {FaultKind::kLostSamples},
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.lost_everywhere = 1 + static_cast<int>(2.99 * x.uniform());
       }},
      {"samples lost, counted",
       {FaultKind::kLostSamples},
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.counted_lost = 1 + static_cast<int>(20.0 * x.uniform());
       }},
      {"samples repeated, all channels",
       {FaultKind::kRepeatedSamples},
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.repeated_everywhere = 1 + static_cast<int>(10.0 * x.uniform());
       }},
      {"timing step 1-8 ms", timing,
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.delay_step_s[any_channel(x)] = either_sign(x, 0.001, 0.008);
       }},
      {"jitter 0.1-0.4 ms, all channels",
       {FaultKind::kJitter},
       [](R& r, X& x) { r.faults.jitter_s.fill(between(x, 1e-4, 4e-4)); }},
      {"clock drift 30-150 ppm",
       {FaultKind::kClockDrift},
       [](R& r, X& x) { r.faults.clock_drift_ppm[any_channel(x)] = either_sign(x, 30.0, 150.0); }},
      {"gain step of a wheelset 3-10 %",
       {FaultKind::kGainChange},
       [](R& r, X& x) {
         any_time(r, x);
         r.faults.gain_step[any_wheelset(x)] = either_sign(x, 0.03, 0.10);
       }},
      {"gain drift of a wheelset 3-10 %",
       {FaultKind::kGainChange},
       [](R& r, X& x) {
         r.faults.start_s = 0.0;
         r.faults.end_s = 300.0;
         r.faults.gain_drift[any_wheelset(x)] = either_sign(x, 0.03, 0.10);
       }},
  };
}

/// What is no fault: the clean car, its effects, its drifts, what the track and the wheels do.
inline std::vector<GuardCase> sound_cases() {
  using R = GuardRecord;
  using X = sim::Random;
  std::vector<GuardCase> cases{{"clean", {}, [](R&, X&) {}}};
  for (const char* const name :
       {"viscous", "quadratic_damping", "asymmetric_coulomb", "progressive_friction", "stribeck",
        "presliding_hysteresis", "backlash", "bump_stop", "cubic_stiffness", "asymmetric_stiffness",
        "unmodelled_mode"}) {
    cases.push_back({name, {}, [name](R& r, X& x) {
                       static_cast<void>(sim::add_effect(r.simulation, name,
                                                         {{"strength", between(x, 0.3, 1.2)}}));
                     }});
  }
  cases.push_back({"friction, stiffness or mass step 8-30 %", {}, [](R& r, X& x) {
                     auto& drift = r.simulation.truck.drift;
                     drift.start_s = any_time(r, x);
                     const double factor = 1.0 + either_sign(x, 0.08, 0.30);
                     const std::size_t which = any_channel(x);
                     (which == 0   ? drift.friction_factor
                      : which == 1 ? drift.stiffness_factor
                                   : drift.mass_factor) = factor;
                     if (x.uniform() < 0.5) drift.end_s = drift.start_s + 60.0;
                   }});
  cases.push_back({"cant of a curve", {}, [](R& r, X& x) {
                     any_time(r, x);
                     r.faults.dc_jump_mps2.fill(either_sign(x, 0.3, 1.0));
                     r.faults.dc_jump_time_s = between(x, 1.0, 4.0);
                   }});
  cases.push_back({"wheels that differ by 1-10 %", {}, [](R& r, X& x) {
                     r.simulation.incoherent_power = between(x, 0.01, 0.1);
                   }});
  cases.push_back({"jitter 0.1-0.4 ms, stamped", {}, [](R& r, X& x) {
                     r.faults.jitter_s.fill(between(x, 1e-4, 4e-4));
                     r.faults.jitter_is_stamped = true;
                   }});
  cases.push_back({"rail joints", {}, [](R& r, X& x) {
                     r.simulation.impulses.joint_depth_m = between(x, 0.1e-3, 0.5e-3);
                   }});
  cases.push_back({"wheel flat", {}, [](R& r, X& x) {
                     r.simulation.impulses.flat_depth_m = between(x, 0.05e-3, 0.3e-3);
                   }});
  cases.push_back({"change of speed 3-12 %", {}, [](R& r, X& x) {
                     auto& speed = r.simulation.speed;
                     speed.change_time_s = any_time(r, x);
                     speed.changed_speed_mps = speed.speed_mps * (1.0 + either_sign(x, 0.03, 0.12));
                     speed.ramp_mps2 = between(x, 0.05, 0.3);
                     r.guard.speed_mps = 0.0;  // no odometer
                   }});
  cases.push_back({"braking by 20-60 %", {}, [](R& r, X& x) {
                     auto& speed = r.simulation.speed;
                     speed.change_time_s = any_time(r, x);
                     speed.changed_speed_mps = speed.speed_mps * (1.0 - between(x, 0.2, 0.6));
                     speed.ramp_mps2 = between(x, 0.3, 1.0);
                     r.guard.speed_mps = 0.0;
                   }});
  cases.push_back({"stop and go", {}, [](R& r, X& x) {
                     const double start_s = any_time(r, x);
                     r.simulation.speed.standstills[0] = {start_s, start_s + between(x, 5.0, 40.0)};
                     r.simulation.speed.ramp_mps2 = between(x, 0.3, 1.0);
                     if (x.uniform() < 0.5) r.guard.speed_mps = 0.0;
                   }});
  cases.push_back(
      {"without short waves", {}, [](R& r, X&) { r.simulation.track.short_wave_mps2 = 0.0; }});
  return cases;
}

inline std::vector<GuardCase> guard_cases() {
  std::vector<GuardCase> all = sound_cases();
  for (const auto& some : {lasting_cases(), timing_cases()}) {
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace dampline::bench
