// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <vector>

#include "app/verify/oscillator/oscillator.hpp"

namespace dampline::sim {

/// Two accelerometers, one on the mass and one on its base.
struct AccelerometerRunConfig {
  OscillatorConfig oscillator{};
  double duration_s{50.0};
  double sample_rate_hz{300.0};
  /// The base accelerates by white noise between these corners (second-order high pass,
  /// fourth-order low pass), with this rms.
  double base_rms_mps2{2.0};
  double lowest_hz{0.5};
  double highest_hz{30.0};
  double anti_alias_hz{100.0};  ///< fourth-order Butterworth on both channels; 0: none
  int bits{12};                 ///< over -+ full_scale_mps2; 0: not quantised
  double full_scale_mps2{2.0 * 9.80665};
  double noise_lsb{0.5};  ///< rms before quantisation
  double mass_bias_mps2{0.21};
  double base_bias_mps2{-0.13};
  std::uint64_t seed{1};
};

struct AccelerometerRun {
  std::vector<double> mass_mps2;  ///< what the sensors give
  std::vector<double> base_mps2;
  std::vector<double> deflection_m;  ///< the truth at the same instants
  std::vector<double> velocity_mps;
  double mass_rms_mps2{0.0};  ///< of the acceleration of the mass, before the sensor
  double stick_share{0.0};    ///< of the time
};

/// Integrates at 32 steps a sample and samples what the sensors see.
[[nodiscard]] AccelerometerRun run_accelerometers(const AccelerometerRunConfig& config);

/// The rms of the base at which the mass accelerates by `mass_rms_mps2`, found on one seed.
[[nodiscard]] double base_rms_for(AccelerometerRunConfig config, double mass_rms_mps2);

}  // namespace dampline::sim
