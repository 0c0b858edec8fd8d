// SPDX-License-Identifier: MIT
// Faults alone, with an effect, with another fault and with a parameter that changes, through the
// decision of `explain`, as a table in Markdown:
// `combinations [RECORDS_PER_CASE_AND_CAR [FIRST_SEED [INCOHERENT_POWER [KIND [FAULT]]]]]`, KIND
// one of alone, effect, fault, drift. A record of 300 s takes about a second.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/combination_case.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

struct Tally {
  int records{0};
  int named{0};
  int any{0};    // the fault or the second one
  int both{0};   // the second fault, the effect or the drift was named, too
  int wrong{0};  // something physical that is not there
  int quiet{0};  // the fault is missed and nothing at all is named
  void add(const Tally& other) {
    records += other.records;
    named += other.named;
    any += other.any;
    both += other.both;
    wrong += other.wrong;
    quiet += other.quiet;
  }
};

std::string percent(int part, int all) {
  return fmt::format("{} of {} ({:.1f} %)", part, all, all == 0 ? 0.0 : 100.0 * part / all);
}

void print(const std::string& kind, const std::string& name, const Tally& t) {
  fmt::print("| {} | {} | {} | {} | {} | {} | {} |\n", kind, name, percent(t.named, t.records),
             percent(t.any, t.records), t.both, t.wrong, t.quiet);
  std::fflush(stdout);
}

void judge(const CombinedRecord& record, const Decision& verdict, const std::string& title,
           Tally& tally) {
  const bool named = has_any(verdict.faults, record.right);
  const bool other =
      record.also.empty() ? verdict.effect == record.effect : has_any(verdict.faults, record.also);
  const bool wrong = !verdict.effect.empty() && verdict.effect != record.effect;
  ++tally.records;
  if (named) ++tally.named;
  if (named || (other && !record.also.empty())) ++tally.any;
  if (named && other && record.has_second()) ++tally.both;
  if (wrong) ++tally.wrong;
  if (!named && verdict.faults.empty() && verdict.effect.empty()) ++tally.quiet;
  if (named && !wrong) return;
  std::string names;
  for (const std::string& fault : verdict.faults) names += " " + fault;
  fmt::print(stderr, "{}: planted {}; faults:{}; effect: {} {}\n", title, record.text, names,
             verdict.effect.empty() ? "-" : verdict.effect, verdict.withheld ? "(withheld)" : "");
}

Tally run_case(Combination kind, const GuardCase& fault, int each, std::uint64_t first_seed,
               double incoherent) {
  Tally tally;
  for (std::size_t place = 0; place < kGuardConditions.size(); ++place) {
    for (int i = 0; i < each; ++i) {
      const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
      sim::Random random{seed * 104729 + place + 17 * static_cast<std::uint64_t>(kind) +
                             7919 * fault.name.size() +
                             31 * static_cast<std::uint64_t>(fault.name[0]),
                         sim::Stream::kFaults};
      CombinedRecord record = combine(kind, fault, kGuardConditions[place], seed, random);
      record.base.simulation.incoherent_power = incoherent;
      const std::string title =
          fmt::format("{} {} seed {}", fault.name, kGuardConditions[place].name, seed);
      judge(record, decide(record.base), title, tally);
    }
  }
  return tally;
}

}  // namespace

int main(int argc, char** argv) {
  const int each = argc > 1 ? std::atoi(argv[1]) : 1;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  const double incoherent = argc > 3 ? std::atof(argv[3]) : 0.0;
  const std::string only_kind = argc > 4 ? argv[4] : "";
  const std::string only = argc > 5 ? argv[5] : "";
  fmt::print(
      "| with | fault | fault named | that or the second fault | the other, too | wrong effect | "
      "nothing named |\n|--|--|--|--|--|--|--|\n");
  for (const Combination kind : kCombinations) {
    if (!only_kind.empty() && only_kind != name_of(kind)) continue;
    Tally all;
    for (const GuardCase& fault : fault_cases()) {
      if (fault.name.find(only) == std::string::npos) continue;
      const Tally tally = run_case(kind, fault, each, seed, incoherent);
      print(name_of(kind), fault.name, tally);
      all.add(tally);
    }
    print(name_of(kind), "**all**", all);
  }
  return EXIT_SUCCESS;
}
