// SPDX-License-Identifier: MIT
#pragma once
#include <memory>

#include "app/verify/oscillator/simulated.hpp"
#include "published/oscillator/identifier.hpp"
#include "published/wavelet/terms.hpp"

namespace dampline {

using LinearTerms = TermList<Viscous, Spring>;
using DuffingTerms = TermList<Viscous, Spring, CubicSpring>;
using VanDerPolTerms = TermList<Viscous, Spring, VanDerPolDamper>;
using CoulombTerms = TermList<Viscous, Spring, Friction<>>;
using LinearCoulombTerms = TermList<Viscous, Spring, Friction<>, ProgressiveFriction<>>;
using AllTerms =
    TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Friction<>, ProgressiveFriction<>>;

/// 3 Hz, a tenth of critical damping; with the base below some 0.25 g rms of the mass.
inline constexpr sim::OscillatorConfig kLinearOscillator{.viscous_ps = 3.770,
                                                         .stiffness_ps2 = 355.3};
inline constexpr double kCubic = 0.1 * 355.3 / (0.0069 * 0.0069);
inline constexpr double kQuadraticViscous = 5.65 / (0.0069 * 0.0069);

inline sim::AccelerometerRun simulate(const sim::OscillatorConfig& oscillator, double base_rms_mps2,
                                      std::uint64_t seed, double duration_s = 50.0) {
  sim::AccelerometerRunConfig config;
  config.oscillator = oscillator;
  config.base_rms_mps2 = base_rms_mps2;
  config.seed = seed;
  config.duration_s = duration_s;
  return sim::run_accelerometers(config);
}

/// Samples first...last - 1 of a run, numbered as in the run.
template <class Identifier>
void feed(Identifier& identifier, const sim::AccelerometerRun& run, std::size_t first,
          std::size_t last) {
  for (std::size_t n = first; n < last; ++n) {
    identifier.update(static_cast<std::int64_t>(n), run.mass_mps2[n], run.base_mps2[n]);
  }
}

template <class Terms>
std::unique_ptr<OscillatorIdentifier<Terms>> identify(
    const sim::AccelerometerRun& run, const OscillatorIdentifierConfig& config = {}) {
  auto identifier = std::make_unique<OscillatorIdentifier<Terms>>(config);
  feed(*identifier, run, 0, run.mass_mps2.size());
  identifier->finish();
  return identifier;
}

}  // namespace dampline
