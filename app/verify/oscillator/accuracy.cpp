// SPDX-License-Identifier: MIT
#include "app/verify/oscillator/accuracy.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "app/verify/wavelet/properties.hpp"

namespace dampline::app {
namespace {

/// Sums over seeds, of one parameter.
struct Sums {
  double square{0.0};
  double error{0.0};
  double sigmas_square{0.0};
  void add(double truth, double value, double std) {
    const double relative = (value - truth) / std::abs(truth);
    square += relative * relative;
    error += relative;
    sigmas_square += (value - truth) * (value - truth) / (std * std);
  }
};

constexpr double kPercent = 100.0;

void add_checks(const OscillatorCondition& condition, System system, const Seeds& seeds,
                std::vector<Check>& out) {
  for (const ParameterAccuracy& one : accuracy_of(condition, system, seeds).parameters) {
    out.push_back({.what = fmt::format("{}: rms error of {}", name_of(system), one.name),
                   .unit = "%",
                   .found = kPercent * one.rms_error,
                   .at_most = kPercent * one.demanded});
  }
}

}  // namespace

sim::AccelerometerRunConfig make_config(const OscillatorCondition& condition, System system) {
  constexpr std::uint64_t kLevelSeed = 99;
  const double rms_mps2 = condition.rms_g * kGravityMps2;
  sim::AccelerometerRunConfig config;
  config.oscillator = oscillator(system, condition.frequency_hz, rms_mps2);
  condition.change(config);
  config.seed = kLevelSeed;
  config.base_rms_mps2 = sim::base_rms_for(config, rms_mps2);
  return config;
}

OscillatorAccuracy accuracy_of(const OscillatorCondition& condition, System system,
                               const Seeds& seeds) {
  sim::AccelerometerRunConfig config = make_config(condition, system);
  const std::vector<Truth> truth = truths(system, config.oscillator);
  std::vector<Sums> sums(truth.size());
  OscillatorAccuracy out;
  for (int i = 0; i < seeds.count; ++i) {
    config.seed = seeds.first + static_cast<std::uint64_t>(i);
    const auto run = sim::run_accelerometers(config);
    const Found found = identify_oscillator(system, run);
    out.rms_g += run.mass_rms_mps2 / kGravityMps2 / seeds.count;
    out.blocks += static_cast<double>(found.blocks) / seeds.count;
    out.excluded += found.excluded;
    if (!found.ok) continue;
    ++out.estimates;
    for (std::size_t p = 0; p < truth.size(); ++p)
      sums[p].add(truth[p].value, found.value[p], found.std[p]);
  }
  // A seed without an estimate is no error that could be averaged away.
  const double n = out.estimates == seeds.count ? static_cast<double>(seeds.count)
                                                : std::numeric_limits<double>::quiet_NaN();
  for (std::size_t p = 0; p < truth.size(); ++p) {
    const double factor = truth[p].name == "k" ? condition.stiffness_factor : condition.factor;
    out.parameters.push_back({.name = truth[p].name,
                              .demanded = factor * truth[p].demanded,
                              .rms_error = std::sqrt(sums[p].square / n),
                              .mean_error = sums[p].error / n,
                              .rms_sigmas = std::sqrt(sums[p].sigmas_square / n)});
  }
  return out;
}

std::vector<OscillatorCondition> strong_conditions() {
  return {{.name = "3 Hz"},
          {.name = "2 Hz", .frequency_hz = 2.0, .factor = 2.0, .stiffness_factor = 2.0},
          {.name = "6 Hz", .frequency_hz = 6.0, .factor = 2.0, .stiffness_factor = 2.0}};
}

std::vector<CheckGroup> accelerometers_alone(int seeds) {
  std::vector<CheckGroup> out;
  for (const OscillatorCondition& condition : strong_conditions()) {
    CheckGroup group{
        .tables = {"accelerometers"},
        .title = fmt::format("oscillators of {} from two accelerometers alone", condition.name),
        .notes = {fmt::format("{} seeds, 50 s each, 300 Hz, 12 bit over -+ 2 g, 0.25 g rms; noise "
                              "0.5 codes rms, a bias on each channel, anti-alias filter 100 Hz.",
                              seeds),
                  "Per unit mass: acceleration of the mass = -(c x' + k x + k3 x^3 + c3 x^2 x' + "
                  "(F + fk |x|) "
                  "sign x'), x against the base."}};
    for (const System system : kSystems)
      add_checks(condition, system, {.count = seeds}, group.checks);
    out.push_back(group);
  }
  return out;
}

}  // namespace dampline::app
