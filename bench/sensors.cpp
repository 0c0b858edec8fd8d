// SPDX-License-Identifier: MIT
// What sensors cost: level and stiffness of clean trucks, by a simulation of its own, behind
// coarse, noisy, jittering, slow and unfiltered sensors, with the share of truths within two stated
// deviations. `sensors [RECORDS_PER_ROW_AND_TRUCK [FIRST_SEED [ROW]]]`; a record of 300 s takes
// four seconds.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tests/app/plain_truck.hpp"
#include "tests/explain/coverage.hpp"

namespace {

using namespace dampline;
using dampline::test::Coverage;
using dampline::test::PlainSensors;
using dampline::test::PlainTruck;

constexpr double kLengthS = 300.0;

struct Case {
  const char* name{""};
  PlainSensors sensors;
};
constexpr std::array kCases{
    Case{"300 Hz, 12 bits, 0.02 m/s^2, low pass 100 Hz", {}},
    Case{"10 bits", {.bits = 10}},
    Case{"9 bits", {.bits = 9}},
    Case{"8 bits", {.bits = 8}},
    Case{"7 bits", {.bits = 7}},
    Case{"noise 0.05 m/s^2", {.noise_mps2 = 0.05}},
    Case{"noise 0.1 m/s^2", {.noise_mps2 = 0.1}},
    Case{"noise 0.2 m/s^2", {.noise_mps2 = 0.2}},
    Case{"jitter 0.1 ms", {.jitter_s = 1e-4}},
    Case{"jitter 0.2 ms", {.jitter_s = 2e-4}},
    Case{"jitter 0.4 ms", {.jitter_s = 4e-4}},
    Case{"low pass 60 Hz", {.corner_hz = 60.0}},
    Case{"low pass 70 Hz", {.corner_hz = 70.0}},
    Case{"low pass 80 Hz", {.corner_hz = 80.0}},
    Case{"low pass 120 Hz", {.corner_hz = 120.0}},
    Case{"150 Hz, low pass 60 Hz", {.rate_hz = 150.0, .corner_hz = 60.0}},
    Case{"200 Hz, low pass 60 Hz", {.rate_hz = 200.0, .corner_hz = 60.0}},
    Case{"200 Hz, low pass 80 Hz", {.rate_hz = 200.0, .corner_hz = 80.0}},
    Case{"400 Hz, low pass 160 Hz", {.rate_hz = 400.0, .corner_hz = 160.0}},
    Case{"600 Hz, low pass 240 Hz", {.rate_hz = 600.0, .corner_hz = 240.0}},
    Case{"1000 Hz, low pass 400 Hz", {.rate_hz = 1000.0, .corner_hz = 400.0}},
    Case{"2400 Hz, low pass 960 Hz", {.rate_hz = 2400.0, .corner_hz = 960.0}},
    Case{"1000 Hz, no low pass", {.rate_hz = 1000.0, .corner_hz = 0.0}},
};

/// Of one parameter, percent of the truth.
struct Errors {
  Coverage coverage;
  double worst{0.0};
  double stated{0.0};
  void add(const Estimate& found, double truth) {
    coverage.add(found, truth);
    worst = std::max(worst, std::abs(found.value / truth - 1.0));
    stated += found.std / truth;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("{:+.2f} | {:.2f} | {:.2f} | {} of {} | {:.2f}",
                       100.0 * coverage.mean_error(), 100.0 * worst,
                       100.0 * stated / static_cast<double>(coverage.records), coverage.within,
                       coverage.records, coverage.rms());
  }
};

void print_row(const Case& c, int records, std::uint64_t seed) {
  Errors level, spring;
  int trusted = 0;
  for (const PlainTruck& truck : test::kPlainTrucks) {
    for (int i = 0; i < records; ++i) {
      const app::RunResult result =
          test::identified_from(truck, c.sensors, kLengthS, seed + static_cast<std::uint64_t>(i));
      trusted += result.trust == app::Trust::kTrusted ? 1 : 0;
      for (const app::Parameter& p : result.parameters) {
        if (p.name == "coulomb") level.add({p.value, p.std}, truck.coulomb_n);
        if (p.name == "stiffness") spring.add({p.value, p.std}, truck.spring_npm);
      }
    }
  }
  if (level.coverage.records == 0) return;
  fmt::print("| {} | {} | {} | {} |\n", c.name, level.text(), spring.text(), trusted);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 10;
  const std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 7001;
  const std::string only = argc > 3 ? argv[3] : "";
  fmt::print(
      "| sensors | Fc: mean error, % | worst, % | stated, % | within two | rms z "
      "| k: mean error, % | worst, % | stated, % | within two | rms z | trusted |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Case& c : kCases)
    if (only.empty() || c.name == only) print_row(c, records, seed);
  return 0;
}
