// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace dampline {

/// A motion in closed form: the force that goes with it is exact for any restoring force.
struct PrescribedMotion {
  struct Tone {
    double amplitude_m;
    double omega_radps;
    double phase_rad;
  };
  std::vector<Tone> tones;

  /// The n-th derivative of the deflection.
  [[nodiscard]] double derivative(int n, double time_s) const {
    double sum = 0.0;
    for (const Tone& tone : tones) {
      sum += tone.amplitude_m * std::pow(tone.omega_radps, n) *
             std::sin(tone.omega_radps * time_s + tone.phase_rad + n * std::numbers::pi / 2.0);
    }
    return sum;
  }
  [[nodiscard]] double x(double time_s) const { return derivative(0, time_s); }
  [[nodiscard]] double v(double time_s) const { return derivative(1, time_s); }
  [[nodiscard]] double a(double time_s) const { return derivative(2, time_s); }
};

inline PrescribedMotion two_tones() { return {{{1.0, 1.0, 0.2}, {0.6, 1.7, 1.1}}}; }
inline PrescribedMotion other_tones() { return {{{0.8, 1.3, 0.9}, {0.5, 0.6, 2.0}}}; }

}  // namespace dampline
