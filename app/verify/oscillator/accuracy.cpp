// SPDX-License-Identifier: MIT
#include "app/verify/oscillator/accuracy.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "app/verify/wavelet/properties.hpp"

namespace dampline::app {
namespace {

/// Damping ratio 0.1. The other terms are such that they matter alike at every frequency and level:
/// at a deflection x0 = a_rms / w^2 the cubic spring adds a tenth to the stiffness and the friction
/// that grows with deflection is 0.15 k; constant friction is a fifth (or, beside that, an eighth)
/// of the rms acceleration; the Van der Pol damper turns from driving to damping at 0.58 x0.
sim::OscillatorConfig oscillator(System system, double frequency_hz, double rms_mps2) {
  const double w = 2.0 * std::numbers::pi * frequency_hz;
  const double x0 = rms_mps2 / (w * w);
  sim::OscillatorConfig config;
  config.viscous_ps = 0.2 * w;
  config.stiffness_ps2 = w * w;
  switch (system) {
    case System::kLinear:
      break;
    case System::kDuffing:
      config.cubic_stiffness_pm2s2 = 0.1 * w * w / (x0 * x0);
      break;
    case System::kVanDerPol:
      config.viscous_ps = -0.1 * w;
      config.quadratic_viscous_pm2s = 0.3 * w / (x0 * x0);
      break;
    case System::kCoulomb:
      config.coulomb_mps2 = 0.2 * rms_mps2;
      break;
    case System::kLinearCoulomb:
      config.coulomb_mps2 = 0.125 * rms_mps2;
      config.coulomb_slope_ps2 = 0.15 * w * w;
      break;
  }
  return config;
}

struct Truth {
  std::string name;
  double value;
  double demanded;  ///< relative rms error at 3 Hz and 0.25 g
};

std::vector<Truth> truths(System system, const sim::OscillatorConfig& c) {
  const double viscous = system == System::kLinear || system == System::kDuffing ? 0.002 : 0.01;
  std::vector<Truth> out{{"c", c.viscous_ps, viscous}, {"k", c.stiffness_ps2, 0.001}};
  if (system == System::kDuffing) out.push_back({"k3", c.cubic_stiffness_pm2s2, 0.003});
  if (system == System::kVanDerPol) out.push_back({"c3", c.quadratic_viscous_pm2s, 0.003});
  if (system == System::kCoulomb) out.push_back({"F", c.coulomb_mps2, 0.003});
  if (system == System::kLinearCoulomb) {
    out.push_back({"F", c.coulomb_mps2, 0.01});
    out.push_back({"fk", c.coulomb_slope_ps2, 0.005});
  }
  return out;
}

/// By a model of the system's own terms.
Found identify_own(System system, const sim::AccelerometerRun& run) {
  switch (system) {
    case System::kLinear:
      return identify_oscillator<LinearTerms>(run);
    case System::kDuffing:
      return identify_oscillator<DuffingTerms>(run);
    case System::kVanDerPol:
      return identify_oscillator<VanDerPolTerms>(run);
    case System::kCoulomb:
      return identify_oscillator<CoulombTerms<ExactSign>>(run);
    case System::kLinearCoulomb:
      return identify_oscillator<LinearCoulombTerms<ExactSign>>(run);
  }
  return {};
}

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
  const double rms_mps2 = condition.rms_g * kStandardGravityMps2;
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
    const Found found = identify_own(system, run);
    out.rms_g += run.mass_rms_mps2 / kStandardGravityMps2 / seeds.count;
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
