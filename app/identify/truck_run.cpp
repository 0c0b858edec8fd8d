// SPDX-License-Identifier: MIT
#include "app/identify/truck_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "app/error.hpp"
#include "app/identify/other_methods.hpp"
#include "app/identify/record_rate.hpp"
#include "app/identify/truck_result.hpp"
#include "app/run/state_file.hpp"
#include "app/text/quantity.hpp"

namespace dampline::app {
namespace {

constexpr double kFirstIntervalSeconds = 4.0;

constexpr std::string_view reason(BlockStatus status) {
  switch (status) {
    case BlockStatus::kExcludedGap:
      return "samples missing";
    case BlockStatus::kExcludedSaturated:
      return "channel at full scale";
    case BlockStatus::kExcludedStuck:
      return "channel stuck";
    case BlockStatus::kExcludedNotFinite:
      return "not a number";
    case BlockStatus::kExcludedSpoilt:
      return "fault of the data";
    case BlockStatus::kStill:
      return "standstill";
    case BlockStatus::kUsed:
    case BlockStatus::kPartial:
      break;
  }
  return "";
}

Memory memory_of(const std::string& word) {
  if (word == "window") return Memory::kWindow;
  return word == "forgetting" ? Memory::kForgetting : Memory::kInfinite;
}

TruckRecord record_of(const TruckView& view, const MeasuredRate& rate, double nominal_hz,
                      const std::string& source) {
  const RateCorrection correction = make_correction(rate, nominal_hz, source);
  return {corrected(view.snapshot, correction), correction,      rate,
          nominal_hz * correction.ratio,        view.first_tick, view.newest_tick};
}

EstimatorConfig with_screen(EstimatorConfig core, const ScreenConfig& screen) {
  core.screen = screen;
  return core;
}

}  // namespace

EstimatorConfig identifier_config(const Config& config) {
  EstimatorConfig core;
  core.sample_rate_hz = truck_rate_hz(config.input);
  core.moving_mass_kg = config.car.moving_mass_kg;
  core.velocity_corner_hz = config.model.velocity_corner_hz.value_or(0.0);
  core.anti_alias = {config.input.anti_alias.corner_hz, config.input.anti_alias.order};
  const auto& nodes = config.model.curve_nodes_mps;
  if (!nodes.empty()) std::copy(nodes.begin(), nodes.end(), core.curve_nodes_mps.begin());
  core.memory = memory_of(config.estimate.memory);
  core.memory_s =
      core.memory == Memory::kWindow ? config.estimate.window_s : config.estimate.time_constant_s;
  for (const std::string& effect : config.model.base)
    if (effect != "coulomb" && effect != "viscous")
      throw UsageError{
          fmt::format("[model] base: \"{}\" cannot be identified from a truck's "
                      "accelerations yet; \"coulomb\" and \"viscous\" can",
                      effect)};
  if (!Estimator::check(core).ok())
    throw UsageError{
        fmt::format("[input] sample_rate_hz: found {}, expected at least 150 for a truck's "
                    "accelerations (with [model] and [estimate] in their ranges)",
                    config.input.sample_rate_hz)};
  return core;
}

DataFaults faults_of(const TruckView& view, double nominal_hz) {
  TruckRecord record;
  record.sample_rate_hz = nominal_hz;
  record.first_tick = view.first_tick;
  DataFaults out;
  describe_faults(view.faults, record, nominal_hz, out);
  return out;
}

TruckRun::TruckRun(const Config& config, const ScreenConfig& screen)
    : core_{with_screen(identifier_config(config), screen)},
      config_{config},
      identifier_{std::make_unique<Estimator>(core_)},
      methods_{std::make_unique<Methods>(core_)},
      phase_{std::make_unique<PhaseView>(PhaseViewConfig{.sample_rate_hz = core_.sample_rate_hz})},
      block_ticks_{Estimator::kBlockS * core_.sample_rate_hz},
      history_{static_cast<std::int64_t>(kFirstIntervalSeconds * core_.sample_rate_hz), 0},
      excerpt_{core_.sample_rate_hz},
      faults_{config, core_},
      alarms_{core_} {}

void TruckRun::take(const Sample& sample) {
  if (!started_) {
    started_ = true;
    first_tick_ = sample.tick;
    first_time_ns_ = sample.time_ns;
    history_.start(first_tick_);
  }
  newest_tick_ = std::max(newest_tick_, sample.tick);
  clipping_.take(sample);
  Sample due;
  if (faults_.take(sample, due)) use(due);
}

void TruckRun::use(const Sample& sample) {
  const UpdateResult result = identifier_->update(sample);
  if (watcher_) watcher_(sample, result);
  if (result.has_motion) {
    excerpt_.take(result.motion);
    phase_->update(result.motion);
  }
  methods_->update(result);
  if (!result.block_closed) return;
  note_block(result.block);
  alarms_.take(result.block, sample.tick, *identifier_);
  if (history_.due(sample.tick)) history_.add(sample.tick, identifier_->level());
}

void TruckRun::note_block(const BlockReport& block) {
  ++blocks_[static_cast<std::size_t>(block.status)];
  const std::string_view why = reason(block.status);
  if (why.empty()) return;
  const double start = std::max(0.0, static_cast<double>(block.first_tick - first_tick_));
  const double end = static_cast<double>(block.first_tick - first_tick_) + block_ticks_;
  excluded_.add(start / core_.sample_rate_hz, end / core_.sample_rate_hz, why);
}

double TruckRun::time_s() const noexcept {
  return static_cast<double>(newest_tick_ - first_tick_) / core_.sample_rate_hz;
}

const ConvergenceHistory::Row* TruckRun::newest() const noexcept {
  return history_.rows().empty() ? nullptr : &history_.rows().back();
}

TruckView TruckRun::view() noexcept {
  return {identifier_->snapshot(), first_tick_,    newest_tick_,
          first_time_ns_,          faults_.view(), alarms_.view()};
}

RunResult describe_view(const TruckView& view, const MeasuredRate& rate, const Config& config,
                        const std::string& source) {
  const double nominal_hz = truck_rate_hz(config.input);
  const TruckRecord record = record_of(view, rate, nominal_hz, source);
  RunResult result = describe_truck(record, config.model);
  describe_faults(view.faults, record, nominal_hz, result.faults);
  describe_alarms(view.alarms, record, result);
  return result;
}

void TruckRun::close() {
  if (closed_) return;
  closed_ = true;
  faults_.close();
  for (Sample due; faults_.drain(due);) use(due);
  identifier_->finish();
}

RunResult TruckRun::finish(const MeasuredRate& rate, const std::string& source) {
  close();
  const TruckView last = view();
  const TruckRecord record = record_of(last, rate, core_.sample_rate_hz, source);
  if (!last.snapshot.valid) fail_unusable(last.snapshot, source);
  history_.add(newest_tick_,
               {last.snapshot.valid, last.snapshot.coulomb_n, last.snapshot.stiffness_npm});
  RunResult result = describe_truck(record, config_.model);
  result.counts.emplace_back("blocks_spoilt", blocks(BlockStatus::kExcludedSpoilt));
  result.latency_s = identifier_->motion_latency_s() + faults_.wait_s();
  fill_history(history_.rows(), record, result);
  fill_motion(excerpt_.best(), record, result);
  fill_phase(*phase_, record, result);
  fill_densities(methods_->fokker_planck(), record, result);
  if (config_.estimate.methods == "all")
    fill_methods(methods_->fokker_planck(), core_.moving_mass_kg, last.snapshot.stiffness_npm.value,
                 record, result);
  result.warnings = clipping_.warnings();
  const auto statistics = std::make_unique<Statistics>();
  identifier_->export_statistics(*statistics);
  faults_.finish(record, *statistics, result);
  describe_alarms(last.alarms, record, result);
  result.excluded = excluded_.list();
  result.excluded_more = excluded_.more();
  return result;
}

std::string TruckRun::encoded_state() {
  const auto statistics = std::make_unique<Statistics>();
  identifier_->export_statistics(*statistics);
  return encode_state(*statistics);
}

void TruckRun::fail_unusable(const Snapshot& snapshot, const std::string& source) const {
  const Counts& counts = snapshot.counts;
  std::string why;
  for (std::size_t i = 0; i < kStatuses; ++i) {
    const std::string_view word = reason(static_cast<BlockStatus>(i));
    if (!word.empty() && blocks_[i] > 0)
      why += fmt::format("{}{} ({})", why.empty() ? "" : ", ", blocks_[i], word);
  }
  throw RunError{
      fmt::format("{}: nothing could be identified: {} samples in {} make {} blocks of 2 s, {} of "
                  "them excluded{}; "
                  "some ten usable blocks are needed",
                  source, format_count(counts.samples), format_duration(time_s()), counts.blocks,
                  counts.blocks_excluded + counts.blocks_still, why.empty() ? "" : ": " + why)};
}

}  // namespace dampline::app
