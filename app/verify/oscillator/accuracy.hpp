// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/verify/oscillator/simulated.hpp"
#include "app/verify/wavelet/rows.hpp"
#include "published/oscillator/identifier.hpp"

namespace dampline::app {

/// All that the oscillators below have.
using AllTerms =
    TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Friction<>, ProgressiveFriction<>>;

enum class System { kLinear, kDuffing, kVanDerPol, kCoulomb, kLinearCoulomb };
inline constexpr std::array<System, 5> kSystems{System::kLinear, System::kDuffing,
                                                System::kVanDerPol, System::kCoulomb,
                                                System::kLinearCoulomb};

inline std::string name_of(System system) {
  constexpr std::array<const char*, 5> kNames{"linear", "Duffing", "Van der Pol", "Coulomb",
                                              "linear/Coulomb"};
  return kNames[static_cast<std::size_t>(system)];
}

/// What the estimator says at the end of a record.
struct Found {
  std::vector<double> value;
  std::vector<double> std;
  int blocks{0};
  std::int64_t excluded{0};
  bool ok{false};
};

template <class Terms>
Found identify_oscillator(const sim::AccelerometerRun& run,
                          const OscillatorIdentifierConfig& config = {}) {
  using Estimator = OscillatorIdentifier<Terms>;
  const auto identifier = std::make_unique<Estimator>(config);
  for (std::size_t n = 0; n < run.mass_mps2.size(); ++n) {
    identifier->update(static_cast<std::int64_t>(n), run.mass_mps2[n], run.base_mps2[n]);
  }
  identifier->finish();
  Found found;
  found.excluded = identifier->excluded().total();
  found.blocks = identifier->memory().blocks();
  const auto estimate = identifier->estimate();
  found.ok = estimate.ok();
  if (!found.ok) return found;
  const auto& e = estimate.value();
  found.value.assign(e.value.begin(), e.value.end());
  found.std.assign(e.std.begin(), e.std.end());
  return found;
}

struct Seeds {
  std::uint64_t first{2001};
  int count{24};
};

/// How oscillators are driven and seen.
struct OscillatorCondition {
  std::string name;
  double frequency_hz{3.0};
  double rms_g{0.25};
  double factor{1.0};  ///< on the figures demanded at 3 Hz and 0.25 g; 0: none demanded
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
