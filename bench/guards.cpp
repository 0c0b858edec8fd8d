// SPDX-License-Identifier: MIT
// What the guards make of records with faults, effects and inputs of random strength, three cars,
// as a confusion matrix in Markdown: `guards [RECORDS_PER_CASE_AND_CAR [FIRST_SEED
// [INCOHERENT_POWER [CASE]]]]`. A record of 300 s takes about half a second.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bench/guard_cases.hpp"
#include "dampline/sample/placer.hpp"

namespace {

using namespace dampline;
using namespace dampline::bench;

struct Row {
  int records{0};
  int right{0};
  int extra{0};  // another name beside the right one
  std::map<std::string, int> names;
  std::array<int, 3> right_in{};
};

std::vector<Fault> faults_of(const GuardRecord& record, GuardInputs& inputs, bool verbose) {
  const auto guard = std::make_unique<Guard>(record.guard);
  sim::FaultyRecord source{record.simulation, record.faults};
  const auto samples = static_cast<std::int64_t>(record.length_s * sim::kSampleRateHz);
  BlockFigures last{};
  SamplePlacer placer{record.guard.sample_rate_hz};
  for (std::int64_t i = 0; i < samples; ++i) {
    static_cast<void>(source.next());
    placer.push(source.stamped());
    for (Sample taken, placed; placer.pop(taken, placed);) guard->update(placed, taken.accel_mps2);
    const BlockFigures now = guard->block();
    const bool print = verbose && now.last_tick != last.last_tick;
    const BlockFigures ended = last;
    last = now;
    if (!print) continue;
    fmt::print(
        stderr,
        "  {:6.1f} s coherent {:.2f} match {:+.2f} at {:3d} delay {:9.4f} ms gain {:+.4f} lag "
        "{} {:8.4f} {:8.4f} {:8.4f} ms frame {:.3f} follow {:+.2f} noise {:.2e} {:.2e} {:.2e}\n",
        static_cast<double>(ended.first_tick) / 300.0, ended.coherent_share, ended.match,
        ended.match_delay, 1e3 * ended.delay_s, ended.log_gain, ended.has_lag ? 1 : 0,
        1e3 * ended.lag_s[0], 1e3 * ended.lag_s[1], 1e3 * ended.lag_s[2], ended.frame_power,
        ended.following, ended.noise[0], ended.noise[1], ended.noise[2]);
  }
  guard->finish();
  inputs = guard->inputs();
  return {guard->faults().begin(), guard->faults().end()};
}

void run_one(const GuardCase& c, const GuardCondition& condition, std::uint64_t seed, Row& row,
             std::size_t place, bool verbose, double incoherent) {
  GuardRecord record = clean_record(condition, seed);
  sim::Random random{seed * 7919 + place, sim::Stream::kFaults};
  record.simulation.incoherent_power = incoherent;
  c.make(record, random);
  GuardInputs inputs;
  const std::vector<Fault> faults = faults_of(record, inputs, verbose);
  ++row.records;
  bool right = c.right.empty() && faults.empty();
  bool extra = false;
  std::string names;
  for (const Fault& fault : faults) {
    const bool good = std::find(c.right.begin(), c.right.end(), fault.kind) != c.right.end();
    right = right || good;
    extra = extra || !good;
    if (names.find(name_of(fault.kind)) == std::string::npos) {
      names += std::string{names.empty() ? "" : " + "} + name_of(fault.kind);
    }
    if (verbose || !good) {
      fmt::print(stderr, "{} {} seed {}: {} {} at {:.1f} s, {:.4g} {} x {}\n", c.name,
                 condition.name, seed, name_of(fault.kind), name_of(fault.channel), fault.time_s,
                 fault.size, fault.unit, fault.count);
    }
  }
  if (!right) fmt::print(stderr, "{} {} seed {}: missed\n", c.name, condition.name, seed);
  if (verbose) {
    fmt::print(stderr, "impacts {} {} {}, speed changes {}\n", inputs.impacts[0], inputs.impacts[1],
               inputs.impacts[2], inputs.speed_changes);
  }
  row.right += right ? 1 : 0;
  row.extra += extra && !c.right.empty() ? 1 : 0;
  row.right_in[place] += right ? 1 : 0;
  ++row.names[names.empty() ? "none" : names];
}

int run(int each, std::uint64_t first_seed, double incoherent, const std::string& only) {
  fmt::print(
      "| record | right | laden 80 / laden 60 / empty 80 | with another name too | verdicts |\n"
      "|--|--|--|--|--|\n");
  for (const GuardCase& c : guard_cases()) {
    if (!only.empty() && c.name.find(only) == std::string::npos) continue;
    Row row;
    for (std::size_t place = 0; place < kGuardConditions.size(); ++place) {
      for (int i = 0; i < each; ++i) {
        run_one(c, kGuardConditions[place], first_seed + static_cast<std::uint64_t>(i), row, place,
                !only.empty() && each == 1, incoherent);
      }
    }
    std::string verdicts;
    for (const auto& [name, count] : row.names) {
      verdicts += fmt::format("{}{} {}", verdicts.empty() ? "" : ", ", name, count);
    }
    fmt::print("| {} | {}/{} | {}, {}, {} of {} | {} | {} |\n", c.name, row.right, row.records,
               row.right_in[0], row.right_in[1], row.right_in[2], each, row.extra, verdicts);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int each = argc > 1 ? std::atoi(argv[1]) : 3;
  const auto seed = static_cast<std::uint64_t>(argc > 2 ? std::atoll(argv[2]) : 1);
  return run(each, seed, argc > 3 ? std::atof(argv[3]) : 0.0, argc > 4 ? argv[4] : "");
}
