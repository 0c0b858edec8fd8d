// SPDX-License-Identifier: MIT
// What the estimate for small parts (SmallIdentifier) loses beside the full one: both over the same
// simulated records, whose parameters are known. `small_parts [SEEDS [FIRST_SEED]]`.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "bench/accuracy_case.hpp"
#include "dampline/identifier.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

constexpr std::array<double, 3> kLengthsS{20.0, 60.0, 300.0};

/// One estimator's errors over all records at one length.
struct Errors48 {
  Spread coulomb, stiffness, false_viscous, curve, coulomb_std, stiffness_std;
  int within{0};
  void add(const Errors& e) {
    coulomb.add(e.coulomb);
    stiffness.add(e.stiffness);
    false_viscous.add(e.false_viscous);
    curve.add(e.curve);
    coulomb_std.add(e.snapshot.coulomb_n.std / e.snapshot.coulomb_n.value);
    stiffness_std.add(e.snapshot.stiffness_npm.std / e.snapshot.stiffness_npm.value);
    within += std::abs(e.coulomb_sigmas) <= 2.0 ? 1 : 0;
    within += std::abs(e.stiffness_sigmas) <= 2.0 ? 1 : 0;
  }
  [[nodiscard]] std::string row(double length_s, const char* name) const {
    return fmt::format(
        "| {:.0f} s | {} | {} | {} | {} | {} | {:.3f} | {:.3f} | {:.1f} % |\n", length_s, name,
        coulomb.percent(3), stiffness.percent(3), false_viscous.percent(3), curve.percent(3),
        100.0 * coulomb_std.sum / coulomb_std.count,
        100.0 * stiffness_std.sum / stiffness_std.count, 50.0 * within / coulomb.count);
  }
};

struct Both {
  Errors48 full, small;
  Spread coulomb_apart, stiffness_apart, curve_apart;
  void add(const Errors& f, const Errors& s) {
    full.add(f);
    small.add(s);
    coulomb_apart.add(s.coulomb - f.coulomb);
    stiffness_apart.add(s.stiffness - f.stiffness);
    for (std::size_t i = 0; i < kCurveSegments; ++i)
      if (f.snapshot.curve[i].samples > 100)
        curve_apart.add(s.snapshot.curve[i].force_n / f.snapshot.curve[i].force_n - 1.0);
  }
};
using Table = std::array<Both, kLengthsS.size()>;

void run(const AccuracyCase& c, std::uint64_t seed, Table& table) {
  sim::SimulationConfig config = c.simulation;
  config.seed = seed;
  sim::Simulation simulation{config};
  IdentifierConfig identifier;
  identifier.estimator.moving_mass_kg = config.truck.moving_mass_kg;
  const auto full = std::make_unique<BasicIdentifier<kEstimateParts>>(identifier);
  const auto small = std::make_unique<SmallIdentifier>(identifier);
  Visits visits;
  std::int64_t tick = 0;
  for (std::size_t l = 0; l < kLengthsS.size(); ++l) {
    for (; tick < static_cast<std::int64_t>(kLengthsS[l] * sim::kSampleRateHz); ++tick) {
      const sim::SimulatedSample s = simulation.next();
      visits.add(s.truth.velocity_mps);
      full->push(sim::to_sample(s));
      small->push(sim::to_sample(s));
    }
    table[l].add(errors_of(full->snapshot(), c, visits), errors_of(small->snapshot(), c, visits));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::max(1, std::atoi(argv[1])) : 12;
  const std::uint64_t first = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 1001;
  Table table;
  for (const AccuracyCase& c : standard_cases())
    for (int i = 0; i < seeds; ++i) run(c, first + static_cast<std::uint64_t>(i), table);
  fmt::print("State: SmallIdentifier {} bytes, with the full estimate {}.\n\n",
             sizeof(SmallIdentifier), sizeof(BasicIdentifier<kEstimateParts>));
  fmt::print(
      "Errors in %, mean / largest over {} records; level and stiffness within two stated "
      "deviations: 90 to 99 % wanted.\n\n",
      4 * seeds);
  fmt::print(
      "| after | estimate | Fc | stiffness | false viscous | curve | stated deviation of Fc, "
      "mean | of stiffness | within two |\n|--|--|--|--|--|--|--|--|--|\n");
  for (std::size_t l = 0; l < kLengthsS.size(); ++l)
    fmt::print("{}{}", table[l].full.row(kLengthsS[l], "full"),
               table[l].small.row(kLengthsS[l], "small"));
  fmt::print(
      "\nThe small one's difference from the full one in %, mean / largest:\n\n"
      "| after | Fc | stiffness | nodes of the curve |\n|--|--|--|--|\n");
  for (std::size_t l = 0; l < kLengthsS.size(); ++l)
    fmt::print("| {:.0f} s | {} | {} | {} |\n", kLengthsS[l], table[l].coulomb_apart.percent(3),
               table[l].stiffness_apart.percent(3), table[l].curve_apart.percent(3));
  return EXIT_SUCCESS;
}
