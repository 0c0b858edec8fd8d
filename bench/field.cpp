// SPDX-License-Identifier: MIT
// What `explain` says of trucks, by a simulation of its own, whose sensors or their transport are
// at fault: the fault's name, an effect of the suspension in its stead or beside it, a parameter
// that is said to change, and the error of a level that is stated. Each record once with all
// declared (wheelbase, speed, order, ranges, noise) and once with the mass alone.
// `field [RECORDS_PER_ROW_AND_TRUCK [FIRST_SEED [ROW]]]`; a record of 200 s takes two seconds
// twice.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/app/plain_faults.hpp"
#include "tests/explain/coverage.hpp"

namespace {

using namespace dampline;
using dampline::test::PlainExplained;
using dampline::test::PlainFaultCase;
using dampline::test::PlainMotion;
using dampline::test::PlainTruck;

constexpr double kLengthS = 200.0;

/// A number is stated where it is trusted or where only the model is incomplete.
bool is_stated(app::Trust trust) {
  return trust == app::Trust::kTrusted || trust == app::Trust::kModelIncomplete;
}

struct Tally {
  int records{0}, named{0}, refused{0}, physics{0}, beside{0}, changes{0};
  double worst{0.0};  ///< error of a level that is stated, of the truth
  test::Coverage level;

  void add(const PlainFaultCase& fault, const PlainTruck& truck, const PlainExplained& found,
           const std::string& text) {
    const bool is_named = std::any_of(fault.right.begin(), fault.right.end(), [&](FaultKind kind) {
      return found.has_fault(name_of(kind));
    });
    const auto& steps = found.explanation.steps;
    const bool effect = std::any_of(steps.begin(), steps.end(), [](const app::Step& step) {
      return step.effect != "unknown" && step.effect != "time_skew" && step.effect != "gain_error";
    });
    const bool any_fault = !found.result.faults.list.empty();
    const bool stated = is_stated(found.result.trust);
    const app::Parameter* const found_level = find_parameter(found.result.parameters, "coulomb");
    double error = 0.0;
    if (stated && found_level != nullptr) {
      level.add({found_level->value, found_level->std}, truck.coulomb_n);
      error = std::abs(found_level->value / truck.coulomb_n - 1.0);
      worst = std::max(worst, error);
    }
    ++records;
    named += is_named ? 1 : 0;
    refused += !is_named && !stated ? 1 : 0;
    physics += effect && !any_fault ? 1 : 0;
    beside += effect && any_fault ? 1 : 0;
    changes += found.result.faults.drift ? 1 : 0;
    const bool dull = (is_named || fault.right.empty() || !stated) && !effect &&
                      !found.result.faults.drift && error < 0.02;
    if (!dull) report(found, error, text);
  }
  void refuse() {
    ++records;
    ++refused;
  }

 private:
  /// On standard error, what a reader would look up.
  static void report(const PlainExplained& found, double error, const std::string& text) {
    std::string line = text;
    for (const app::FaultFinding& f : found.result.faults.list)
      line += fmt::format(" [{} {} {:.4g} {}]", f.name, f.channel, f.size, f.unit);
    for (const app::Step& step : found.explanation.steps) line += " +" + step.effect;
    if (found.result.faults.drift) line += " changed: " + found.result.faults.drift->parameter;
    fmt::print(stderr, "{}; {}, trust {}, Fc off by {:.1f} %\n", line, found.explanation.verdict,
               static_cast<int>(found.result.trust), 100.0 * error);
  }
};

/// The same motions bear every fault.
class Rows {
 public:
  Rows(int records, std::uint64_t seed) : records_{records}, seed_{seed} {}

  void print(const std::vector<PlainFaultCase>& cases, const std::string& only) {
    std::vector<std::array<Tally, 2>> tallies(cases.size());
    for (const PlainTruck& truck : test::kPlainTrucks) {
      for (int i = 0; i < records_; ++i) {
        const std::uint64_t seed = seed_ + static_cast<std::uint64_t>(i);
        const PlainMotion motion = test::plain_motion(truck, {}, kLengthS + 0.1, seed);
        for (std::size_t n = 0; n < cases.size(); ++n) {
          if (!only.empty() && only != cases[n].name) continue;
          for (const bool all : {true, false}) {
            if (cases[n].needs_all && !all) continue;
            const std::string text = fmt::format("{}, {} {} {}", cases[n].name, truck.name, seed,
                                                 all ? "all declared" : "mass alone");
            try {
              tallies[n][all ? 0 : 1].add(
                  cases[n], truck,
                  test::explained_with(truck, motion, cases[n], seed * 7919 + n, kLengthS, all),
                  text);
            } catch (const app::RunError& error) {
              tallies[n][all ? 0 : 1].refuse();
              fmt::print(stderr, "{}: {}\n", text, error.what());
            }
          }
        }
      }
    }
    for (std::size_t n = 0; n < cases.size(); ++n)
      for (const bool all : {true, false}) print(cases[n], all, tallies[n][all ? 0 : 1]);
  }

 private:
  static void print(const PlainFaultCase& fault, bool all, const Tally& t) {
    if (t.records == 0) return;
    const std::string level = t.level.records == 0
                                  ? " | | "
                                  : fmt::format("{} | {:.2f} | {} of {}", t.level.records,
                                                100.0 * t.worst, t.level.within, t.level.records);
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", fault.name, all ? "all" : "mass",
               fault.right.empty() ? "" : fmt::format("{} of {}", t.named, t.records), t.refused,
               t.physics, t.beside, t.changes, level);
  }
  int records_;
  std::uint64_t seed_;
};

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 3;
  const std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 9301;
  const std::string only = argc > 3 ? argv[3] : "";
  fmt::print(
      "| fault | declared | named | refused without its name | an effect in its stead "
      "| an effect beside it | a parameter changes | Fc stated | worst, % | within two |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n");
  Rows rows{records, seed};
  rows.print(test::plain_value_faults(kLengthS), only);
  rows.print(test::plain_timing_faults(kLengthS), only);
  return 0;
}
