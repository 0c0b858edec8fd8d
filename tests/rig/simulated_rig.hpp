// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <random>
#include <vector>

#include "dampline/rig/motion.hpp"

namespace dampline::test {

struct Tone {
  double force_n;
  double frequency_hz;
  double phase_rad;
};

/// m x'' + c x' + k x + F sign x' + offset = f(t), f - offset a sum of tones. Solved piecewise in
/// closed form: between reversals and sticking phases the equation is linear, and the instants in
/// between are found by bisection. Nothing here is shared with the identification.
class SimulatedRig {
 public:
  struct Truth {
    double mass_kg{50.0};
    double viscous_nspm{120.0};
    double stiffness_npm{2.0e4};
    double coulomb_n{30.0};
    double offset_n{-4.0};
  };
  struct Sensors {
    double deflection_noise_m{0.0};
    double deflection_step_m{0.0};  ///< 0: not rounded
    double force_noise_n{0.0};
    double force_step_n{0.0};
  };

  SimulatedRig(const Truth& truth, std::vector<Tone> tones);

  [[nodiscard]] std::vector<rig::Sample> record(double rate_hz, double length_s,
                                                const Sensors& sensors, std::uint64_t seed);

 private:
  struct State {
    double time_s{0.0};
    double deflection_m{0.0};
    double velocity_mps{0.0};
    int direction{0};  ///< of sliding; 0: sticks
  };

  [[nodiscard]] double drive_n(double time_s) const;
  [[nodiscard]] State forced(double time_s) const;
  [[nodiscard]] State slide(const State& from, double time_s) const;
  [[nodiscard]] State advance(const State& from, double time_s) const;
  [[nodiscard]] bool changes(const State& from, const State& to) const;
  [[nodiscard]] State turn(const State& at) const;
  State step(State state, double time_s) const;

  Truth truth_;
  std::vector<Tone> tones_;
};

/// Adds noise and rounding.
[[nodiscard]] std::vector<rig::Sample> measure(std::vector<rig::Sample> record,
                                               const SimulatedRig::Sensors& sensors,
                                               std::uint64_t seed);

}  // namespace dampline::test
