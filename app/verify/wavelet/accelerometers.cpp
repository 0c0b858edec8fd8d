// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <cmath>

#include "app/verify/wavelet/oscillator_accuracy.hpp"
#include "app/verify/wavelet/properties.hpp"

namespace dampline::app {
namespace {

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
