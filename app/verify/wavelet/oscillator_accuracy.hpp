// SPDX-License-Identifier: MIT
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "app/verify/oscillator/accelerometer_run.hpp"
#include "app/verify/wavelet/oscillator_case.hpp"

namespace dampline::app {

struct Seeds {
  std::uint64_t first{2001};
  int count{24};
};

/// How oscillators are driven and seen.
struct OscillatorCondition {
  std::string name;
  double frequency_hz{3.0};
  double rms_g{0.25};
  double factor{1.0};  ///< on the figures demanded (Truth::demanded); 0: none demanded
  double stiffness_factor{1.0};
  std::function<void(sim::AccelerometerRunConfig&)> change{[](auto&) {}};
};

/// The run of one oscillator, its base driven so hard that the mass accelerates by `rms_g`.
[[nodiscard]] sim::AccelerometerRunConfig make_config(const OscillatorCondition& condition,
                                                      System system);

/// Errors of one parameter over the seeds, relative to the truth.
struct ParameterAccuracy {
  std::string name;
  double demanded{0.0};  ///< of the rms error; 0: nothing
  double rms_error{0.0};
  double mean_error{0.0};
  double rms_sigmas{0.0};  ///< error over stated deviation

  /// False as well for what is not a number.
  [[nodiscard]] bool met() const noexcept { return demanded == 0.0 || rms_error <= demanded; }
};

struct OscillatorAccuracy {
  std::vector<ParameterAccuracy> parameters;
  double rms_g{0.0};   ///< of the mass, mean of the seeds
  double blocks{0.0};  ///< used per seed
  std::int64_t excluded{0};
  int estimates{0};  ///< seeds that gave an estimate
};

[[nodiscard]] OscillatorAccuracy accuracy_of(const OscillatorCondition& condition, System system,
                                             const Seeds& seeds);

/// At 3 Hz, and at 2 and 6 Hz with twice the figures demanded.
[[nodiscard]] std::vector<OscillatorCondition> strong_conditions();

}  // namespace dampline::app
