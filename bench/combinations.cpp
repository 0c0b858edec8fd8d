// SPDX-License-Identifier: MIT
// Faults alone, with an effect, with another fault and with a parameter that changes, through the
// decision of `explain`, as a table in Markdown:
// `combinations [RECORDS_PER_CASE_AND_CAR [FIRST_SEED [INCOHERENT_POWER [KIND [FAULT]]]]]`, KIND
// one of alone, effect, fault, drift. A record of 300 s takes about a second.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "app/identify/truck_result.hpp"
#include "bench/guard_cases.hpp"
#include "dampline/effect/judgement.hpp"
#include "dampline/identifier.hpp"

namespace dampline::bench {

/// What comes with a fault.
enum class Combination : std::uint8_t { kAlone, kEffect, kFault, kDrift };
inline constexpr std::array<Combination, 4> kCombinations{Combination::kAlone, Combination::kEffect,
                                                          Combination::kFault, Combination::kDrift};
inline const char* name_of(Combination kind) {
  constexpr std::array<const char*, 4> kNames{"alone", "effect", "fault", "drift"};
  return kNames[static_cast<std::size_t>(kind)];
}

struct CombinedRecord {
  GuardRecord base;
  std::vector<FaultKind> right;  ///< names of the first fault
  std::vector<FaultKind> also;   ///< of the second, if there is one
  std::string effect;            ///< that is planted, or "time_drift"
  std::string text;
  [[nodiscard]] bool has_second() const { return !also.empty() || !effect.empty(); }
};

inline std::vector<GuardCase> fault_cases() {
  std::vector<GuardCase> all = lasting_cases();
  const std::vector<GuardCase> timing = timing_cases();
  all.insert(all.end(), timing.begin(), timing.end());
  return all;
}

inline void add_effect(CombinedRecord& record, sim::Random& random) {
  constexpr std::array<const char*, 9> kPlanted{
      "viscous",   "quadratic_damping", "progressive_friction",  "stribeck",       "backlash",
      "bump_stop", "cubic_stiffness",   "presliding_hysteresis", "unmodelled_mode"};
  record.effect = kPlanted[static_cast<std::size_t>(9.0 * random.uniform())];
  static_cast<void>(sim::add_effect(record.base.simulation, record.effect,
                                    {{"strength", between(random, 0.5, 1.2)}}));
  record.text += " + " + record.effect;
}

/// Another fault, of another name; what both set is set by the second.
inline void add_fault(CombinedRecord& record, sim::Random& random) {
  const std::vector<GuardCase> faults = fault_cases();
  const GuardCase* second = nullptr;
  while (second == nullptr || second->right.front() == record.right.front()) {
    second =
        &faults[static_cast<std::size_t>(static_cast<double>(faults.size()) * random.uniform())];
  }
  second->make(record.base, random);
  record.also = second->right;
  record.text += " + " + second->name;
}

inline void add_drift(CombinedRecord& record, sim::Random& random) {
  sim::DriftEffects& drift = record.base.simulation.truck.drift;
  drift.start_s = between(random, 60.0, 240.0);
  const double factor = 1.0 + either_sign(random, 0.10, 0.30);
  const std::size_t which = any_channel(random);
  (which == 0   ? drift.friction_factor
   : which == 1 ? drift.stiffness_factor
                : drift.mass_factor) = factor;
  record.effect = "time_drift";
  record.text += fmt::format(" + parameter {} x {:.2f}", which, factor);
}

inline CombinedRecord combine(Combination kind, const GuardCase& fault,
                              const GuardCondition& condition, std::uint64_t seed,
                              sim::Random& random) {
  CombinedRecord record{clean_record(condition, seed), fault.right, {}, "", fault.name};
  if (kind == Combination::kEffect) add_effect(record, random);
  if (kind == Combination::kDrift) add_drift(record, random);
  fault.make(record.base, random);
  if (kind == Combination::kFault) add_fault(record, random);
  return record;
}

/// What `explain` says of a record.
struct Decision {
  std::vector<std::string> faults;
  std::string effect;  ///< the first that is named; "time_drift" for a parameter that changed
  bool withheld{false};
  app::DataFaults data;
};

inline app::Config config_of(const GuardRecord& record) {
  app::Config config;
  config.car.moving_mass_kg = record.simulation.truck.moving_mass_kg;
  if (record.guard.wheelbase_m > 0.0) config.car.wheelbase_m = record.guard.wheelbase_m;
  if (record.guard.speed_mps > 0.0) config.input.speed_mps = record.guard.speed_mps;
  config.input.leading = "wheelset1";
  for (std::size_t c = 0; c < kChannels; ++c)
    config.input.noise_mps2[c] = record.guard.noise_mps2[c];
  return config;
}

inline Decision decide(const GuardRecord& record) {
  constexpr Parts kParts{
      .frames = false, .densities = false, .phase = false, .alarms = false, .effects = true};
  const app::Config config = config_of(record);
  IdentifierConfig core;
  core.estimator.moving_mass_kg = config.car.moving_mass_kg;
  core.estimator.screen.step_mps2 = record.guard.step_mps2;
  core.guard = record.guard;
  core.guard.leading = Leading::kWheelset1;
  core.judgement_delay_s = config.guards.wait_s;
  const auto run = std::make_unique<BasicIdentifier<kParts>>(core);
  sim::FaultyRecord source{record.simulation, record.faults};
  const auto samples = static_cast<std::int64_t>(record.length_s * sim::kSampleRateHz);
  for (std::int64_t n = 0; n < samples; ++n) run->push(sim::to_sample(source.next()));
  run->finish();
  const auto statistics = std::make_unique<Statistics>();
  run->statistics(*statistics);
  const effect::Circumstances circumstances = effect::circumstances_of(
      run->faults(), find_parameter_drift(*statistics, Estimator::kBlockS));
  app::TruckRecord truck;
  truck.sample_rate_hz = core.estimator.sample_rate_hz;
  truck.newest_tick = samples;
  app::RunResult result;
  app::describe_faults_of_all(run->guard(), circumstances.faults, circumstances.drift, truck,
                              core.estimator.sample_rate_hz, result);
  const auto explainer = std::make_unique<effect::Explainer>();
  effect::Judgement judgement;
  effect::judge(run->effects().sums(), {.moving_mass_kg = core.estimator.moving_mass_kg},
                circumstances, *explainer, judgement);
  Decision out;
  out.data = result.faults;
  for (const app::FaultFinding& fault : result.faults.list) out.faults.push_back(fault.name);
  out.withheld = judgement.withheld;
  if (judgement.drifts) {
    out.effect = "time_drift";
  } else if (judgement.explanation.step_count > 0) {
    out.effect = effect::name_of(judgement.explanation.step[0].chosen.effect);
  }
  return out;
}

inline bool has_any(const std::vector<std::string>& names, const std::vector<FaultKind>& kinds) {
  return std::any_of(kinds.begin(), kinds.end(), [&](FaultKind kind) {
    return std::find(names.begin(), names.end(), dampline::name_of(kind)) != names.end();
  });
}

}  // namespace dampline::bench

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
