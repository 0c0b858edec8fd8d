// SPDX-License-Identifier: MIT
#include "app/identify/fault_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/error.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kMostSpans = 200;

GuardConfig guard_config(const IdentifierConfig& config) {
  GuardConfig out;
  out.sample_rate_hz = config.sample_rate_hz;
  out.step_mps2 = config.screen.step_mps2;
  out.anti_alias = config.anti_alias;
  const auto checked = Guard::check(out);
  if (!checked.ok()) throw UsageError{"[input] anti_alias: not a filter that the guards know"};
  return checked.value();
}

std::vector<Span> spoilt_spans(const Guard& guard, FaultKind kind, double nominal_hz,
                               const TruckRecord& record) {
  const std::uint32_t bit = 1U << static_cast<unsigned>(kind);
  const auto second = std::max<std::int64_t>(std::llround(nominal_hz), 1);
  std::vector<Span> spans;
  const std::int64_t known = record.newest_tick - FaultBook::kSeconds * second;
  for (std::int64_t tick = std::max(record.first_tick, known); tick <= record.newest_tick;
       tick += second) {
    if ((guard.spoilt(tick, tick) & bit) == 0) continue;
    const double start_s = record.time_s(tick);
    const double end_s = record.time_s(tick + second);
    if (!spans.empty() && start_s - spans.back().end_s < 0.5) {
      spans.back().end_s = end_s;
    } else if (spans.size() < kMostSpans) {
      spans.push_back({start_s, end_s});
    }
  }
  return spans;
}

std::string warning_of(const DataFaults& faults) {
  std::string names;
  for (const FaultFinding& f : faults.list)
    names += fmt::format("{}{} ({})", names.empty() ? "" : ", ", f.name, f.channel);
  return "The data have faults, listed under data quality: " + names + ".";
}

}  // namespace

FaultWatch::FaultWatch(const IdentifierConfig& config)
    : nominal_hz_{config.sample_rate_hz}, guard_{std::make_unique<Guard>(guard_config(config))} {}

void FaultWatch::finish(const TruckRecord& record, const Statistics& statistics,
                        RunResult& result) {
  guard_->finish();
  DataFaults& out = result.faults;
  const auto own_s = [&](double time_s) {
    return record.time_s(std::llround(time_s * nominal_hz_));
  };
  for (const Fault& fault : guard_->faults()) {
    out.list.push_back({name_of(fault.kind), name_of(fault.channel), own_s(fault.time_s),
                        own_s(fault.last_s), fault.size, fault.unit, fault.count,
                        spoilt_spans(*guard_, fault.kind, nominal_hz_, record)});
  }
  for (const std::uint64_t impacts : guard_->inputs().impacts) out.impacts += impacts;
  out.speed_changes = guard_->inputs().speed_changes;
  const ParameterDrift drift = find_parameter_drift(statistics, Identifier::kBlockS);
  if (drift.found) {
    out.drift = DriftFinding{name_of(drift.parameter),
                             drift.step,
                             drift.time_s,
                             drift.interval_s,
                             drift.gain,
                             {100.0 * drift.change.value, 100.0 * drift.change.std}};
    result.warnings.push_back("A parameter is not constant: " + describe_drift(*out.drift) +
                              ". The values stated are means over the record.");
  }
  if (!out.list.empty()) result.warnings.push_back(warning_of(out));
}

}  // namespace dampline::app
