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

#include "app/verify/oscillator/accuracy.hpp"

namespace {

using namespace dampline;
using namespace dampline::app;

/// False where a figure is not reached, or a record gives no estimate.
bool accuracy_row(const OscillatorCondition& condition, System system, const Seeds& seeds) {
  const OscillatorAccuracy found = accuracy_of(condition, system, seeds);
  bool reached = found.estimates == seeds.count;
  std::string text;
  for (const ParameterAccuracy& one : found.parameters) {
    reached = reached && one.met();
    text += fmt::format("{}{} {:.3f}{}{} [{:+.3f}; z {:.2f}]", text.empty() ? "" : ", ", one.name,
                        100.0 * one.rms_error,
                        one.demanded > 0.0 ? fmt::format(" <= {:.1f}", 100.0 * one.demanded) : "",
                        one.met() ? "" : " (!)", 100.0 * one.mean_error, one.rms_sigmas);
  }
  fmt::print("| {} | {} | {} | {:.3f} | {} of {}, {:.1f} blocks, {} windows excluded |\n",
             condition.name, name_of(system), text, found.rms_g, found.estimates, seeds.count,
             found.blocks, found.excluded);
  return reached;
}

bool accuracy_table(const std::string& title, const std::vector<OscillatorCondition>& conditions,
                    const Seeds& seeds) {
  fmt::print(
      "\n{}\n\n| condition | system | rms error in % <= demanded [mean; rms of error / stated "
      "deviation] | rms, g | records |\n|--|--|--|--|--|\n",
      title);
  bool reached = true;
  for (const OscillatorCondition& condition : conditions) {
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

void selection_row(const OscillatorCondition& condition, System system, const Seeds& seeds) {
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

void selection_table(const std::vector<OscillatorCondition>& conditions, const Seeds& seeds) {
  fmt::print(
      "\nA fit of six terms (c, k, k3, c3, F, fk) to records that contain two to four: "
      "|value / stated deviation|.\n\n| condition | system | least of true terms | largest "
      "of spurious terms | rms of spurious terms | spurious beyond 4 |\n|--|--|--|--|--|--|\n");
  for (const OscillatorCondition& condition : conditions) {
    for (const System system : kSystems) selection_row(condition, system, seeds);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Seeds seeds;
  if (argc > 1) seeds.count = std::max(1, std::atoi(argv[1]));
  if (argc > 2) seeds.first = static_cast<std::uint64_t>(std::atoll(argv[2]));
  const bool strong_reached =
      accuracy_table("12 bit, 300 Hz, 50 s, base 0.5 to 30 Hz:", strong_conditions(), seeds);
  const OscillatorCondition weak{
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
