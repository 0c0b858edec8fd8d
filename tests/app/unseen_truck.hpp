// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <utility>

#include "tests/app/plain_truck.hpp"
#include "tests/explain/coverage.hpp"

/// Trucks of any kind: mass, spring, friction, speed, wheelbase, track, length and sensors' noise
/// by chance over what freight cars have, with one effect of random size. Track and sensors are
/// those of plain_truck; friction is an impulse that takes at most what its level allows.
namespace dampline::test {

struct UnseenTruck {
  PlainTruck truck;  ///< its name: of the effect, as explanations call it; "none"
  double wheelbase_m{1.8};
  double track{1.0};  ///< of the track's irregularity
  double length_s{300.0};
  double noise_mps2{0.02};
  double frame_gain{1.0};    ///< of its sensor
  bool told{false};          ///< of wheelbase and speed
  double size{0.0};          ///< of the effect, 0 to 1 ...
  double other{0.0};         ///< ... and what else it has
  Truths truths{};           ///< of level and spring, and of the effect where a name has one
  double deflection_m{0.0};  ///< rms
  double velocity_mps{0.0};  ///< rms
};

namespace unseen {

using plain::kFineHz;
using plain::Signal;
inline constexpr double kStepS = 1.0 / kFineHz;
inline constexpr double kStretchM = 5e-5;  ///< over which the force of a gap that is taken up rises

inline constexpr std::array<const char*, 14> kEffects{"none",
                                                      "viscous",
                                                      "asymmetric_coulomb",
                                                      "stribeck",
                                                      "presliding_hysteresis",
                                                      "backlash",
                                                      "bump_stop",
                                                      "cubic_stiffness",
                                                      "asymmetric_stiffness",
                                                      "progressive_friction",
                                                      "quadratic_damping",
                                                      "viscoelastic",
                                                      "asymmetric_viscous",
                                                      "none"};

struct Motion {
  double deflection_m, velocity_mps;
};
/// Force beside spring and friction, and the level of friction.
struct Law {
  std::function<double(const Motion&)> force = [](const Motion&) { return 0.0; };
  std::function<double(const Motion&)> level;
};

inline double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }

/// The frame's acceleration; `t` learns the rms of its motion.
inline Signal frame(UnseenTruck& t, const Signal& first, const Signal& second, const Law& law) {
  const double mass_kg = t.truck.mass_kg;
  Signal out(first.size());
  Motion now{0.0, 0.0};
  double deflections = 0.0, velocities = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double rails = first[i] + second[i];
    const double elastic_n = t.truck.spring_npm * now.deflection_m + law.force(now);
    const double free_mps = now.velocity_mps + kStepS * (-2.0 * elastic_n / mass_kg - rails);
    const double most_mps = 2.0 * law.level(now) / mass_kg * kStepS;
    const double next_mps = std::copysign(std::max(std::abs(free_mps) - most_mps, 0.0), free_mps);
    out[i] = 0.5 * ((next_mps - now.velocity_mps) / kStepS + rails);
    now.velocity_mps = next_mps;
    now.deflection_m += kStepS * next_mps;
    deflections += now.deflection_m * now.deflection_m;
    velocities += now.velocity_mps * now.velocity_mps;
  }
  t.deflection_m = std::sqrt(deflections / static_cast<double>(out.size()));
  t.velocity_mps = std::sqrt(velocities / static_cast<double>(out.size()));
  return out;
}

/// Damping of a size that the motion without it gives; `t` learns the truths.
inline void add_damping(UnseenTruck& t, Law& law) {
  const std::string_view effect = t.truck.name;
  const double viscous = (0.3 + 0.7 * t.size) * t.truck.coulomb_n / t.velocity_mps;
  if (effect == "viscous") {
    law.force = [=](const Motion& m) { return viscous * m.velocity_mps; };
    t.truths.emplace_back("viscous", viscous);
  } else if (effect == "quadratic_damping") {
    const double damping = viscous / t.velocity_mps;
    law.force = [=](const Motion& m) {
      return damping * m.velocity_mps * std::abs(m.velocity_mps);
    };
    t.truths.emplace_back("quadratic_damping", damping);
  } else if (effect == "viscoelastic") {
    const double spring_npm = (0.2 + 0.5 * t.size) * t.truck.spring_npm;
    const double time_s = 0.012 + 0.03 * t.other;
    law.force = [=, stretch_m = 0.0](const Motion& m) mutable {
      stretch_m += kStepS * (m.velocity_mps - stretch_m / time_s);
      return spring_npm * stretch_m;
    };
    t.truths.emplace_back("viscoelastic_stiffness", spring_npm);
    t.truths.emplace_back("viscoelastic_time", time_s);
  } else if (effect == "asymmetric_viscous") {
    const double difference = 0.2 + 0.3 * t.other;
    law.force = [=](const Motion& m) {
      return viscous * (1.0 + difference * sign(m.velocity_mps)) * m.velocity_mps;
    };
    t.truths.emplace_back("viscous_positive", viscous * (1.0 + difference));
    t.truths.emplace_back("viscous_negative", viscous * (1.0 - difference));
  }
}

/// Friction of another kind, likewise.
inline void change_friction(UnseenTruck& t, Law& law) {
  const std::string_view effect = t.truck.name;
  const double level_n = t.truck.coulomb_n;
  const double y_m = t.deflection_m;
  if (effect == "asymmetric_coulomb") {  // a constant force: nothing that is seen
    const double share = 0.12 + 0.28 * t.size;
    law.level = [=](const Motion& m) { return level_n * (1.0 + share * sign(m.velocity_mps)); };
  } else if (effect == "stribeck") {
    const double share = 0.2 + 0.3 * t.size;
    const double speed_mps = 0.005 + 0.015 * t.other;
    law.level = [=](const Motion& m) {
      return level_n * (1.0 + share * std::exp(-std::pow(m.velocity_mps / speed_mps, 2)));
    };
  } else if (effect == "presliding_hysteresis") {
    const double length_m = (0.04 + 0.16 * t.size) * y_m;
    law.level = [](const Motion&) { return 0.0; };
    law.force = [=, z = 0.0](const Motion& m) mutable {
      z += m.velocity_mps * kStepS / length_m * (1.0 - z * sign(m.velocity_mps));
      z = std::clamp(z, -1.0, 1.0);
      return level_n * z;
    };
    t.truths.emplace_back("presliding_hysteresis_distance", length_m);
  } else if (effect == "backlash") {
    const double gap_m = (0.2 + 0.5 * t.size) * y_m;
    law.level = [](const Motion&) { return 0.0; };
    law.force = [=, pin_m = 0.0, stretch_m = 0.0](const Motion& m) mutable {
      const double moved_m = pin_m + m.velocity_mps * kStepS;
      pin_m = std::clamp(moved_m, -0.5 * gap_m, 0.5 * gap_m);
      stretch_m = std::clamp(stretch_m + moved_m - pin_m, -kStretchM, kStretchM);
      if (std::abs(pin_m) < 0.5 * gap_m) stretch_m = 0.0;
      return level_n * stretch_m / kStretchM;
    };
    t.truths.emplace_back("backlash_force", level_n);
    t.truths.emplace_back("backlash_gap", gap_m + 0.5 * kStretchM);
  } else if (effect == "progressive_friction") {
    const double length_m = y_m / (0.2 + 0.4 * t.size);
    law.level = [=](const Motion& m) {
      return level_n * (1.0 + std::abs(m.deflection_m) / length_m);
    };
    t.truths.emplace_back("progressive_friction_length", length_m);
  }
}

/// A spring that bends, likewise.
inline void bend_spring(UnseenTruck& t, Law& law) {
  const std::string_view effect = t.truck.name;
  const double k = t.truck.spring_npm;
  const double y_m = t.deflection_m;
  if (effect == "bump_stop") {
    const double gap_m = (1.5 + 0.7 * t.size) * y_m;
    const double stop_npm = (1.0 + 3.0 * t.other) * k;
    law.force = [=](const Motion& m) {
      return stop_npm * std::max(std::abs(m.deflection_m) - gap_m, 0.0) * sign(m.deflection_m);
    };
    t.truths.emplace_back("bump_stop_gap", gap_m);
    t.truths.emplace_back("bump_stop_stiffness", stop_npm);
  } else if (effect == "cubic_stiffness") {
    const double cubic = (0.05 + 0.2 * t.size) * k / (y_m * y_m);
    law.force = [=](const Motion& m) { return cubic * std::pow(m.deflection_m, 3); };
    t.truths.emplace_back("cubic_stiffness", cubic);
  } else if (effect == "asymmetric_stiffness") {
    const double difference = (0.1 + 0.2 * t.size) * k;
    law.force = [=](const Motion& m) { return difference * std::abs(m.deflection_m); };
    t.truths.emplace_back("asymmetric_stiffness_difference", 2.0 * difference);
  }
}

/// Dry friction of one level, and nothing else.
inline Law plain_law(const UnseenTruck& t) {
  Law law;
  law.level = [level_n = t.truck.coulomb_n](const Motion&) { return level_n; };
  return law;
}

/// With the truck's effect.
inline Law law_of(UnseenTruck& t) {
  Law law = plain_law(t);
  add_damping(t, law);
  change_friction(t, law);
  bend_spring(t, law);
  return law;
}

}  // namespace unseen

/// `effect`: a place in unseen::kEffects; beyond them: by chance.
inline UnseenTruck unseen_truck(std::uint64_t seed,
                                std::size_t effect = std::numeric_limits<std::size_t>::max()) {
  std::mt19937_64 random{seed * 7919 + 13};
  const auto chance = [&] { return std::uniform_real_distribution<double>{}(random); };
  const auto even = [&](double low, double high) { return low + (high - low) * chance(); };
  const auto by_ratio = [&](double low, double high) {
    return low * std::pow(high / low, chance());
  };
  UnseenTruck t;
  t.truck.mass_kg = by_ratio(7500.0, 45000.0);
  t.truck.spring_npm = 0.5 * t.truck.mass_kg * std::pow(plain::kTwoPi * even(2.1, 3.4), 2);
  t.truck.coulomb_n = t.truck.mass_kg * 9.81 * even(0.013, 0.04);
  t.truck.speed_mps = even(12.0, 33.0);
  t.wheelbase_m = even(0.0, 1.0) < 0.6 ? 1.8 : 2.0;
  t.track = by_ratio(0.8, 2.0);
  t.length_s = even(180.0, 420.0);
  t.noise_mps2 = even(0.01, 0.03);
  t.told = even(0.0, 1.0) < 0.5;
  if (effect >= unseen::kEffects.size()) effect = static_cast<std::size_t>(even(0.0, 14.0));
  t.truck.name = unseen::kEffects[effect];
  t.size = even(0.0, 1.0);
  t.other = even(0.0, 1.0);
  t.truths = {{"coulomb", t.truck.coulomb_n}, {"stiffness", t.truck.spring_npm}};
  return t;
}

/// A record as CSV, 300 samples a second of 12 bits behind 100 Hz.
inline std::string unseen_record(UnseenTruck& t, std::uint64_t seed) {
  using namespace unseen;
  std::mt19937_64 random{seed};
  const auto lag = static_cast<std::size_t>(t.wheelbase_m / t.truck.speed_mps * kFineHz);
  const auto count = static_cast<std::size_t>(t.length_s * kFineHz);
  Signal rail = plain::road(count + lag, t.truck.speed_mps, random);
  for (double& each : rail) each *= t.track;
  std::array<Signal, 3> seen;
  seen[1].assign(rail.begin() + static_cast<std::ptrdiff_t>(lag), rail.end());
  seen[2].assign(rail.begin(), rail.begin() + static_cast<std::ptrdiff_t>(count));
  const auto start = [&](const Signal& s) {
    return Signal(s.begin(), s.begin() + static_cast<std::ptrdiff_t>(count / 4));
  };
  frame(t, start(seen[1]), start(seen[2]), plain_law(t));
  seen[0] = frame(t, seen[1], seen[2], law_of(t));
  for (Signal& each : seen) plain::low_pass(100.0, each);
  std::normal_distribution<double> normal;
  std::string text = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  const auto samples = static_cast<std::size_t>(t.length_s * 300.0) - 2;
  for (std::size_t i = 0; i < samples; ++i) {
    text += fmt::format("{:.6f}", static_cast<double>(i) / 300.0);
    for (std::size_t c = 0; c < 3; ++c) {
      const double step = (c == 0 ? 20.0 : 120.0) / 4096.0;
      const double gain = c == 0 ? t.frame_gain : 1.0;
      const double value = gain * seen[c][i * 256] + 0.07 + t.noise_mps2 * normal(random);
      text += fmt::format(",{:.6g}", step * std::round(value / step));
    }
    text += '\n';
  }
  return text;
}

/// What `explain` makes of it.
inline PlainExplained explained_from(UnseenTruck& t, std::uint64_t seed) {
  const TemporaryFile file{unseen_record(t, seed)};
  app::Config config = plain_config(t.truck, {});
  if (t.told) {
    config.car.wheelbase_m = t.wheelbase_m;
    config.input.speed_mps = t.truck.speed_mps;
  }
  return explained_from(config, file.path());
}

}  // namespace dampline::test
