// SPDX-License-Identifier: MIT
// Oscillators identified from two accelerometers alone: rms errors over fresh seeds against the
// figures demanded, and the stated deviations against the scatter. `oscillators [SEEDS
// [FIRST_SEED]]`; about a minute for 24 seeds. Exit code 1 where a figure is not reached.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "bench/oscillator_case.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

struct Seeds {
  std::uint64_t first{2001};
  int count{24};
};

struct Condition {
  std::string name;
  double frequency_hz{3.0};
  double rms_g{0.25};
  double factor{1.0};  ///< on the figures demanded; 0: none demanded
  double stiffness_factor{1.0};
  std::function<void(sim::AccelerometerRunConfig&)> change{[](auto&) {}};
};

sim::AccelerometerRunConfig make_config(const Condition& condition, System system) {
  const double rms_mps2 = condition.rms_g * kGravityMps2;
  sim::AccelerometerRunConfig config;
  config.oscillator = oscillator(system, condition.frequency_hz, rms_mps2);
  condition.change(config);
  config.seed = 99;
  config.base_rms_mps2 = sim::base_rms_for(config, rms_mps2);
  return config;
}

/// Relative errors of one parameter.
struct Errors {
  double square{0.0};
  double sum{0.0};
  double sigmas_square{0.0};
  void add(double truth, double value, double std) {
    const double error = (value - truth) / std::abs(truth);
    square += error * error;
    sum += error;
    sigmas_square += (value - truth) * (value - truth) / (std * std);
  }
};

/// False where a figure is not reached, or a record gives no estimate.
bool accuracy_row(const Condition& condition, System system, const Seeds& seeds) {
  sim::AccelerometerRunConfig config = make_config(condition, system);
  const std::vector<Truth> truth = truths(system, config.oscillator);
  std::vector<Errors> errors(truth.size());
  double rms = 0.0;
  int counted = 0;
  int blocks = 0;
  std::int64_t excluded = 0;
  for (int i = 0; i < seeds.count; ++i) {
    config.seed = seeds.first + static_cast<std::uint64_t>(i);
    const auto run = sim::run_accelerometers(config);
    const Found found = identify_oscillator(system, run);
    rms += run.mass_rms_mps2 / kGravityMps2 / seeds.count;
    excluded += found.excluded;
    if (!found.ok) continue;
    ++counted;
    blocks += found.blocks;
    for (std::size_t p = 0; p < truth.size(); ++p) {
      errors[p].add(truth[p].value, found.value[p], found.std[p]);
    }
  }
  const double n = std::max(counted, 1);
  bool reached = counted == seeds.count;
  std::string text;
  for (std::size_t p = 0; p < truth.size(); ++p) {
    const double factor = truth[p].name == "k" ? condition.stiffness_factor : condition.factor;
    const double demanded = factor * truth[p].demanded;
    const double error = std::sqrt(errors[p].square / n);
    const bool missed = factor > 0.0 && error > demanded;
    reached = reached && !missed;
    text += fmt::format(
        "{}{} {:.3f}{} [{:+.3f}; z {:.2f}]", p > 0 ? ", " : "", truth[p].name, 100.0 * error,
        factor > 0.0 ? fmt::format(" <= {:.1f}{}", 100.0 * demanded, missed ? " (!)" : "") : "",
        100.0 * errors[p].sum / n, std::sqrt(errors[p].sigmas_square / n));
  }
  fmt::print("| {} | {} | {} | {:.3f} | {} of {}, {:.1f} blocks, {} windows excluded |\n",
             condition.name, name_of(system), text, rms, counted, seeds.count, blocks / n,
             excluded);
  return reached;
}

bool accuracy_table(const std::string& title, const std::vector<Condition>& conditions,
                    const Seeds& seeds) {
  fmt::print(
      "\n{}\n\n| condition | system | rms error in % <= demanded [mean; rms of error / stated "
      "deviation] | rms, g | records |\n|--|--|--|--|--|\n",
      title);
  bool reached = true;
  for (const Condition& condition : conditions) {
    for (const System system : kSystems) {
      reached = accuracy_row(condition, system, seeds) && reached;
    }
  }
  return reached;
}

/// Which of AllTerms a system has.
std::vector<bool> present(System system) {
  return {true,
          true,
          system == System::kDuffing,
          system == System::kVanDerPol,
          system == System::kCoulomb || system == System::kLinearCoulomb,
          system == System::kLinearCoulomb};
}

void selection_row(const Condition& condition, System system, const Seeds& seeds) {
  sim::AccelerometerRunConfig config = make_config(condition, system);
  const std::vector<bool> is_true = present(system);
  double least_true = 1e300;
  double largest_spurious = 0.0;
  double spurious_square = 0.0;
  int spurious = 0;
  int beyond = 0;
  for (int i = 0; i < seeds.count; ++i) {
    config.seed = seeds.first + static_cast<std::uint64_t>(i);
    const Found found = identify_oscillator<AllTerms>(sim::run_accelerometers(config));
    for (std::size_t p = 0; p < found.value.size(); ++p) {
      const double t = std::abs(found.value[p] / found.std[p]);
      if (is_true[p]) {
        least_true = std::min(least_true, t);
        continue;
      }
      largest_spurious = std::max(largest_spurious, t);
      spurious_square += t * t;
      beyond += t > 4.0 ? 1 : 0;
      ++spurious;
    }
  }
  fmt::print("| {} | {} | {:.0f} | {:.1f} | {:.2f} | {} of {} |\n", condition.name, name_of(system),
             least_true, largest_spurious, std::sqrt(spurious_square / std::max(spurious, 1)),
             beyond, spurious);
}

void selection_table(const std::vector<Condition>& conditions, const Seeds& seeds) {
  fmt::print(
      "\nA fit of six terms (c, k, k3, c3, F, fk) to records that contain two to four: "
      "|value / stated deviation|.\n\n| condition | system | least of true terms | largest "
      "of spurious terms | rms of spurious terms | spurious beyond 4 |\n|--|--|--|--|--|--|\n");
  for (const Condition& condition : conditions) {
    for (const System system : kSystems) selection_row(condition, system, seeds);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Seeds seeds;
  if (argc > 1) seeds.count = std::max(1, std::atoi(argv[1]));
  if (argc > 2) seeds.first = static_cast<std::uint64_t>(std::atoll(argv[2]));
  const bool strong_reached = accuracy_table(
      "12 bit, 300 Hz, 50 s, base 0.5 to 30 Hz:",
      {{.name = "3 Hz"},
       {.name = "2 Hz", .frequency_hz = 2.0, .factor = 2.0, .stiffness_factor = 2.0},
       {.name = "6 Hz", .frequency_hz = 6.0, .factor = 2.0, .stiffness_factor = 2.0}},
      seeds);
  const Condition weak{
      .name = "3 Hz, 0.03 g", .rms_g = 0.03, .factor = 3.0, .stiffness_factor = 2.0};
  const bool weak_reached =
      accuracy_table("The same, weak or in a wider band:",
                     {weak,
                      {.name = "3 Hz, base 0.25 to 60 Hz",
                       .factor = 0.0,
                       .stiffness_factor = 0.0,
                       .change =
                           [](sim::AccelerometerRunConfig& c) {
                             c.lowest_hz = 0.25;
                             c.highest_hz = 60.0;
                           }},
                      {.name = "3 Hz, no anti-alias filter",
                       .factor = 0.0,
                       .stiffness_factor = 0.0,
                       .change = [](sim::AccelerometerRunConfig& c) { c.anti_alias_hz = 0.0; }}},
                     seeds);
  selection_table({{.name = "3 Hz"}, weak}, seeds);
  return strong_reached && weak_reached ? EXIT_SUCCESS : EXIT_FAILURE;
}
