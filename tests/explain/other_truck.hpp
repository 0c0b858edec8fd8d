// SPDX-License-Identifier: MIT
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

/// Trucks whose force is known, by another simulation than the program's own: impulses of
/// set-valued friction instead of a smooth sign, laws written anew, tones instead of a shaped
/// track, records as another program would write them.
namespace dampline::test {

inline constexpr double kRateHz = 300.0;
inline constexpr std::size_t kFine = 64;  // steps per sample
inline constexpr double kStepS = 1.0 / (kRateHz * kFine);
inline constexpr double kMassKg = 37200.0;
inline constexpr double kSpringNpm = 5.0e6;
inline constexpr double kCoulombN = 8100.0;
inline constexpr double kSpeedMps = 21.0;
inline constexpr double kWheelbaseM = 1.8;

/// A wheelset's acceleration at every fine step: tones under the spectrum of an ordinary track,
/// and a band of short waves.
inline std::vector<double> road(std::size_t steps, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::uniform_real_distribution<double> uniform;
  std::vector<double> out(steps, 0.0);
  const auto add = [&](double hz, double amplitude_mps2) {
    const std::complex<double> turn = std::polar(1.0, 2.0 * M_PI * hz * kStepS);
    std::complex<double> at = std::polar(amplitude_mps2, 2.0 * M_PI * uniform(random));
    for (double& a : out) {
      a += at.real();
      at = {at.real() * turn.real() - at.imag() * turn.imag(),
            at.real() * turn.imag() + at.imag() * turn.real()};
    }
  };
  for (double hz = 0.4; hz < 40.0; hz *= 1.09) {
    const double from = 2.0 * M_PI * hz / kSpeedMps;
    const double density = 4.032e-7 * 0.8246 * 0.8246 /
                           ((from * from + 0.0206 * 0.0206) * (from * from + 0.8246 * 0.8246));
    const double height_m = std::sqrt(2.0 * density * 0.09 * from);
    add(hz * (1.0 + 0.04 * uniform(random)), height_m * std::pow(2.0 * M_PI * hz, 2));
  }
  for (int i = 0; i < 25; ++i) add(46.0 + 28.0 * uniform(random), 0.55);
  return out;
}

/// Two poles of a low-pass of fourth order at 100 Hz, as sensors have it.
class LowPass {
 public:
  explicit LowPass(double quality) {
    const double k = std::tan(M_PI * 100.0 * kStepS);
    const double norm = 1.0 / (1.0 + k / quality + k * k);
    gain_ = k * k * norm;
    a1_ = 2.0 * (k * k - 1.0) * norm;
    a2_ = (1.0 - k / quality + k * k) * norm;
  }
  double next(double x) {
    const double y = gain_ * x + s1_;
    s1_ = 2.0 * gain_ * x - a1_ * y + s2_;
    s2_ = gain_ * x - a2_ * y;
    return y;
  }

 private:
  double gain_, a1_, a2_;
  double s1_{0.0}, s2_{0.0};
};

struct State {
  double time_s{0.0};
  double deflection_m{0.0};
  double velocity_mps{0.0};
  double frame_mps2{0.0};
};

/// What is planted: the force beside spring and friction, and the level of the friction.
struct Plant {
  std::function<double(const State&)> force = [](const State&) { return 0.0; };
  std::function<double(const State&)> level = [](const State&) { return kCoulombN; };
  std::array<double, 3> gain{1.0, 1.0, 1.0};
  std::size_t frame_late{0};       // fine steps
  double moving_mass_kg{kMassKg};  // with what rides on the frame
};

inline double sign(double x) { return x < 0.0 ? -1.0 : 1.0; }

/// A record as CSV; `mean_m`, where it is asked for: of the deflection.
inline std::string record_of(const Plant& plant, std::uint64_t seed, double length_s = 120.0,
                             std::uint64_t road_seed = 7, double* mean_m = nullptr) {
  const std::vector<double> input =
      road(static_cast<std::size_t>(length_s * kRateHz) * kFine, road_seed);
  const auto delay = static_cast<std::size_t>(kWheelbaseM / kSpeedMps / kStepS);
  std::mt19937_64 random{seed};
  std::normal_distribution<double> noise{0.0, 0.02};
  std::array<std::array<LowPass, 2>, 3> sensors{{{LowPass{0.5412}, LowPass{1.3066}},
                                                 {LowPass{0.5412}, LowPass{1.3066}},
                                                 {LowPass{0.5412}, LowPass{1.3066}}}};
  std::string text = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  State state;
  double sum_m = 0.0;
  std::vector<double> late(plant.frame_late + 1, 0.0);
  for (std::size_t i = 0; i < input.size(); ++i) {
    const double one = input[i];
    const double two = i < delay ? 0.0 : input[i - delay];
    state.time_s = static_cast<double>(i) * kStepS;
    sum_m += state.deflection_m;
    // The friction's impulse stops the motion or takes all that its level allows.
    const double elastic_n = kSpringNpm * state.deflection_m + plant.force(state);
    const double without = state.velocity_mps + kStepS * (-2.0 * elastic_n / kMassKg - one - two);
    const double most = 2.0 * plant.level(state) / kMassKg * kStepS;
    const double velocity = sign(without) * std::max(std::abs(without) - most, 0.0);
    state.frame_mps2 = 0.5 * ((velocity - state.velocity_mps) / kStepS + one + two);
    state.velocity_mps = velocity;
    state.deflection_m += kStepS * velocity;
    late[i % late.size()] = state.frame_mps2;
    const std::array<double, 3> seen{late[(i + 1) % late.size()], one, two};
    std::array<double, 3> out{};
    for (std::size_t c = 0; c < 3; ++c)
      out[c] = sensors[c][1].next(sensors[c][0].next(plant.gain[c] * seen[c]));
    if (i % kFine != 0) continue;
    text += fmt::format("{:.6f}", state.time_s);
    for (const double a : out) text += fmt::format(",{:.3f}", a + 0.1 + noise(random));
    text += '\n';
  }
  if (mean_m != nullptr) *mean_m = sum_m / static_cast<double>(input.size());
  return text;
}

inline Plant force(std::function<double(const State&)> law) {
  Plant out;
  out.force = std::move(law);
  return out;
}
inline Plant level(std::function<double(const State&)> law) {
  Plant out;
  out.level = std::move(law);
  return out;
}

/// Friction that builds up over a distance; softer towards its end than Dahl's with an exponent
/// above 1.
inline Plant presliding(double length_m, double exponent = 1.5) {
  Plant out = level([](const State&) { return 0.0; });
  out.force = [length_m, exponent, z = 0.0](const State& s) mutable {
    const double left = std::max(1.0 - z * sign(s.velocity_mps), 0.0);
    z += s.velocity_mps * kStepS * (exponent == 1.0 ? left : std::pow(left, exponent)) / length_m;
    z = std::clamp(z, -1.0, 1.0);
    return kCoulombN * z;
  };
  return out;
}

/// Over which the force of a gap that is taken up rises.
inline constexpr double kStretchM = 5e-5;

/// A friction element behind a pin in a slot.
inline Plant backlash(double gap_m) {
  Plant out = level([](const State&) { return 0.0; });
  out.force = [gap_m, pin_m = 0.0, stretch_m = 0.0](const State& s) mutable {
    const double moved = pin_m + s.velocity_mps * kStepS;
    pin_m = std::clamp(moved, -0.5 * gap_m, 0.5 * gap_m);
    stretch_m = std::clamp(stretch_m + moved - pin_m, -kStretchM, kStretchM);
    if (std::abs(pin_m) < 0.5 * gap_m) stretch_m = 0.0;
    return kCoulombN * stretch_m / kStretchM;
  };
  return out;
}

/// A spring behind a dashpot beside the suspension (Maxwell).
inline Plant viscoelastic(double stiffness_npm, double time_s) {
  return force([stiffness_npm, time_s, stretch_m = 0.0](const State& s) mutable {
    stretch_m += kStepS * (s.velocity_mps - stretch_m / time_s);
    return stiffness_npm * stretch_m;
  });
}

/// A mass on a spring on the frame; its force on the frame comes through the suspension's balance.
inline Plant mode(double share, double hz) {
  Plant out = force([share, w = 2.0 * M_PI * hz, x = 0.0, u = 0.0](const State& s) mutable {
    // x: the mass's motion relative to the frame.
    u += kStepS * (-w * w * x - 2.0 * 0.03 * w * u - s.frame_mps2);
    x += kStepS * u;
    return -share * kMassKg * (w * w * x + 2.0 * 0.03 * w * u);
  });
  out.moving_mass_kg += share * kMassKg;
  return out;
}

/// A body that rests on another truck, too: the part of its mass that goes with the other frame,
/// how far that one is behind over the same rail (negative: ahead), its friction over this one's.
struct Coupling {
  double mass_kg{0.0};
  double delay_s{0.0};
  double level_share{1.0};
};
inline Plant coupled(const Coupling& to, double length_s = 120.0, std::uint64_t road_seed = 7) {
  const auto delay = static_cast<std::ptrdiff_t>(std::lround(to.delay_s / kStepS));
  const auto most = static_cast<std::size_t>(std::abs(delay));
  auto input = road(static_cast<std::size_t>(length_s * kRateHz) * kFine + most, road_seed);
  return force([=, rail = std::move(input), y_m = 0.0, v_mps = 0.0](const State& s) mutable {
    const auto at = [&](std::ptrdiff_t i) {
      const bool is_there = i >= 0 && i < static_cast<std::ptrdiff_t>(rail.size());
      return is_there ? rail[static_cast<std::size_t>(i)] : 0.0;
    };
    const auto now = static_cast<std::ptrdiff_t>(std::lround(s.time_s / kStepS)) - delay;
    const double wheels_mps2 =
        at(now) + at(now - static_cast<std::ptrdiff_t>(kWheelbaseM / kSpeedMps / kStepS));
    const double pushed_n = kSpringNpm * y_m + to.mass_kg * s.frame_mps2;
    const double without = v_mps + kStepS * (-2.0 * pushed_n / kMassKg - wheels_mps2);
    const double held = 2.0 * to.level_share * kCoulombN / kMassKg * kStepS;
    const double next = sign(without) * std::max(std::abs(without) - held, 0.0);
    const double frame_mps2 = 0.5 * ((next - v_mps) / kStepS + wheels_mps2);
    v_mps = next;
    y_m += kStepS * next;
    return to.mass_kg * frame_mps2;
  });
}

}  // namespace dampline::test
