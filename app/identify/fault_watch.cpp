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

Leading leading_of(const std::string& word) {
  if (word == "wheelset1") return Leading::kWheelset1;
  return word == "wheelset2" ? Leading::kWheelset2 : Leading::kUnknown;
}

GuardConfig guard_config(const Config& config, const EstimatorConfig& core) {
  GuardConfig out;
  out.sample_rate_hz = core.sample_rate_hz;
  out.step_mps2 = core.screen.step_mps2;
  out.anti_alias = core.anti_alias;
  for (std::size_t c = 0; c < kChannels; ++c)
    out.noise_mps2[c] = config.input.noise_mps2[c].value_or(0.0);
  out.wheelbase_m = config.car.wheelbase_m.value_or(0.0);
  out.speed_mps = config.input.speed_mps.value_or(0.0);
  out.leading = leading_of(config.input.leading);
  const auto checked = Guard::check(out);
  if (!checked.ok()) throw UsageError{"[input] anti_alias: not a filter that the guards know"};
  return checked.value();
}

std::vector<Span> spoilt_spans(const Guard& guard, const Fault& fault, double nominal_hz,
                               const TruckRecord& record) {
  const auto second = std::max<std::int64_t>(std::llround(nominal_hz), 1);
  std::vector<Span> spans;
  const std::int64_t known = record.newest_tick - FaultLog::kSeconds * second;
  for (std::int64_t tick = std::max(record.first_tick, known); tick <= record.newest_tick;
       tick += second) {
    if (!guard.spoilt(fault.kind, fault.channel, tick)) continue;
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

void describe_faults(const FaultView& view, const TruckRecord& record, double nominal_hz,
                     DataFaults& out) {
  const auto own_s = [&](double time_s) {
    return record.time_s(std::llround(time_s * nominal_hz));
  };
  for (std::size_t i = 0; i < view.count; ++i) {
    const Fault& fault = view.faults[i];
    out.list.push_back({name_of(fault.kind),
                        name_of(fault.channel),
                        own_s(fault.time_s),
                        own_s(fault.last_s),
                        fault.size,
                        fault.unit,
                        fault.count,
                        {}});
  }
  for (const std::uint64_t impacts : view.inputs.impacts) out.impacts += impacts;
  out.speed_changes = view.inputs.speed_changes;
  out.values_replaced = view.held.replaced;
  out.samples_spoilt = view.held.spoilt;
}

FaultWatch::FaultWatch(const Config& config, const EstimatorConfig& core)
    : nominal_hz_{core.sample_rate_hz},
      wait_s_{config.guards.wait_s},
      guard_{std::make_unique<Guard>(guard_config(config, core))},
      delay_{std::make_unique<JudgementDelay>(
          static_cast<std::size_t>(std::llround(config.guards.wait_s * core.sample_rate_hz)))} {}

FaultView FaultWatch::view() const noexcept {
  FaultView out;
  for (const Fault& fault : guard_->faults()) out.faults[out.count++] = fault;
  out.inputs = guard_->inputs();
  out.held = delay_->counts();
  return out;
}

void FaultWatch::finish(const TruckRecord& record, const Statistics& statistics,
                        RunResult& result) {
  DataFaults& out = result.faults;
  describe_faults(view(), record, nominal_hz_, out);
  for (std::size_t i = 0; i < out.list.size(); ++i)
    out.list[i].spans = spoilt_spans(*guard_, guard_->faults()[i], nominal_hz_, record);
  const ParameterDrift drift = find_parameter_drift(statistics, Estimator::kBlockS);
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
