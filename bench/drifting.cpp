// SPDX-License-Identifier: MIT
// What the test for parameters that change makes of records of 300 s with steps and drifts of
// friction, stiffness and mass, and of sound ones, as a table in Markdown:
// `drifting [RECORDS_PER_CASE_AND_CAR [FIRST_SEED [CASE]]]`.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/guard_cases.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

struct DriftCase {
  std::string name;
  std::optional<DriftingParameter> parameter;
  std::function<double(GuardRecord& record, sim::Random& random)> make;  ///< true relative change
};

double& factor_of(sim::DriftEffects& drift, DriftingParameter parameter) {
  if (parameter == DriftingParameter::kFriction) return drift.friction_factor;
  return parameter == DriftingParameter::kStiffness ? drift.stiffness_factor : drift.mass_factor;
}

void add_case(DriftingParameter parameter, bool step, double least, std::vector<DriftCase>& cases) {
  cases.push_back(
      {fmt::format("{} {} {:.0f}-30 %", name_of(parameter), step ? "step" : "drift", 100.0 * least),
       parameter, [=](GuardRecord& record, sim::Random& random) {
         sim::DriftEffects& drift = record.simulation.truck.drift;
         drift.start_s = step ? between(random, 60.0, 240.0) : 0.0;
         drift.end_s = step ? 0.0 : record.length_s;
         const double change = either_sign(random, least, 0.30);
         factor_of(drift, parameter) = 1.0 + change;
         return change;
       }});
}

std::vector<DriftCase> all_cases() {
  std::vector<DriftCase> cases;
  for (const bool step : {true, false}) {
    add_case(DriftingParameter::kFriction, step, step ? 0.10 : 0.15, cases);
    add_case(DriftingParameter::kStiffness, step, step ? 0.08 : 0.15, cases);
    add_case(DriftingParameter::kMass, step, step ? 0.08 : 0.15, cases);
  }
  for (const GuardCase& sound : sound_cases()) {
    if (sound.name.starts_with("friction, stiffness")) continue;
    cases.push_back({sound.name, {}, [make = sound.make](GuardRecord& record, sim::Random& random) {
                       make(record, random);
                       return 0.0;
                     }});
  }
  return cases;
}

ParameterDrift judge(const GuardRecord& record) {
  EstimatorConfig config;
  config.moving_mass_kg = record.simulation.truck.moving_mass_kg;
  const auto identifier = std::make_unique<Estimator>(config);
  sim::Simulation simulation{record.simulation};
  const auto samples = static_cast<int>(record.length_s * sim::kSampleRateHz);
  for (int i = 0; i < samples; ++i) identifier->update(sim::to_sample(simulation.next()));
  identifier->finish();
  const auto statistics = std::make_unique<Statistics>();
  identifier->export_statistics(*statistics);
  return find_parameter_drift(*statistics, Estimator::kBlockS);
}

void run_case(const DriftCase& c, int each, std::uint64_t first_seed, bool verbose) {
  int right = 0;
  int other = 0;
  int missed = 0;
  double largest_error = 0.0;
  for (std::size_t place = 0; place < kGuardConditions.size(); ++place) {
    for (int i = 0; i < each; ++i) {
      const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
      GuardRecord record = clean_record(kGuardConditions[place], seed);
      sim::Random random{seed * 7919 + place, sim::Stream::kFaults};
      const double truth = c.make(record, random);
      const ParameterDrift drift = judge(record);
      const bool is_right =
          c.parameter ? drift.found && drift.parameter == *c.parameter : !drift.found;
      if (is_right) ++right;
      if (is_right && c.parameter) {
        largest_error = std::max(largest_error, std::abs(drift.change.value - truth));
      }
      if (c.parameter && !drift.found) ++missed;
      if (!is_right && drift.found) ++other;
      if (verbose || !is_right) {
        fmt::print(
            stderr,
            "{} {} seed {}: true {:+.3f}; found {} {} {} at {:.0f} s {:+.3f} +- {:.3f}, gain "
            "{:.3f}, steps {:.1f} {:.1f}\n",
            c.name, kGuardConditions[place].name, seed, truth, drift.found,
            name_of(drift.parameter), drift.step ? "step" : "drift", drift.time_s,
            drift.change.value, drift.change.std, drift.gain, drift.friction_significance,
            drift.stiffness_significance);
      }
    }
  }
  fmt::print("| {} | {}/{} | {} | {} | {} |\n", c.name, right, 3 * each, missed, other,
             c.parameter ? fmt::format("{:.1f} %", 100.0 * largest_error) : "");
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int each = argc > 1 ? std::atoi(argv[1]) : 3;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  const std::string only = argc > 3 ? argv[3] : "";
  fmt::print(
      "| record | right | missed | another parameter, or a false alarm | largest error of the "
      "change |\n|--|--|--|--|--|\n");
  for (const DriftCase& c : all_cases()) {
    if (c.name.find(only) == std::string::npos) continue;
    run_case(c, each, seed, !only.empty() && each == 1);
  }
  return 0;
}
