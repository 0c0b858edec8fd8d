// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "app/verify/phase/friction_oscillator.hpp"

namespace dampline::sim {

/// Stroboscopic sections of one oscillator over several regimes of its drive.
struct SectionSweep {
  std::vector<OscillatorDrive> regimes;
  int phases{8};           ///< flashes per period, from the drive's phase 0
  int periods{12};         ///< of each regime
  int skipped_periods{2};  ///< at the beginning of each regime, the oscillator runs on
  int steps_per_flash{125};
  /// Above 0: each regime begins afresh as often as `starts`, at a deflection and velocity drawn
  /// from
  /// +- this; otherwise it takes over the state of the regime before.
  double start_spread{0.0};
  int starts{1};
  double noise{0.0};  ///< sensors: standard deviation as a share of each channel's rms
  std::uint64_t seed{1};
};

struct StrobedPoint {
  PhasePoint point;  ///< with noise
  int regime{0};     ///< counts the starts of a regime as well
  int phase{0};
  double phase_rad{0.0};   ///< of the drive's sine
  double input_mps2{0.0};  ///< without noise
  bool sticks{false};
};

[[nodiscard]] std::vector<StrobedPoint> strobe(const OscillatorLaw& law, const SectionSweep& sweep);

/// Every combination of three means, three swings and three rates: the regimes in which a friction
/// of magnitude 1 moves.
[[nodiscard]] std::vector<OscillatorDrive> moving_regimes();
/// `count` regimes drawn from the same ranges.
[[nodiscard]] std::vector<OscillatorDrive> random_regimes(int count, std::uint64_t seed);

/// Steady amplitude of the deflection at the drive's rate, after `settle_periods`; 0 where it
/// sticks, infinite where it grows without bound.
[[nodiscard]] double steady_amplitude(const OscillatorLaw& law, const OscillatorDrive& drive,
                                      int settle_periods, int measured_periods,
                                      int steps_per_period);

}  // namespace dampline::sim
