// SPDX-License-Identifier: MIT
#include "app/identify/truck_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "app/error.hpp"
#include "app/identify/truck_result.hpp"
#include "app/record/rate.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "dampline/motion/decimator.hpp"
#include "dampline/sample.hpp"

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

Leading leading_of(const std::string& word) {
  if (word == "wheelset1") return Leading::kWheelset1;
  return word == "wheelset2" ? Leading::kWheelset2 : Leading::kUnknown;
}

/// The corridor's settings; throws as estimator_config() does.
IdentifierConfig core_config(const Config& config, const RecordSignals& signals) {
  IdentifierConfig out;
  out.estimator = estimator_config(config);
  out.estimator.screen = signals.screen;
  out.signals = signals.channels;
  out.extra_signals = signals.extras;
  for (std::size_t c = 0; c < kChannels; ++c)
    out.guard.noise_mps2[c] = config.input.noise_mps2[c].value_or(0.0);
  out.guard.wheelbase_m = config.car.wheelbase_m.value_or(0.0);
  out.guard.speed_mps = config.input.speed_mps.value_or(0.0);
  out.guard.leading = leading_of(config.input.leading);
  out.judgement_delay_s = config.guards.wait_s;
  if (!Guard::check(guard_config(out)).ok())
    throw UsageError{"[input] anti_alias: not a filter that the guards know"};
  return out;
}

/// Behind a filter that is open up to the thinned band's edge, leaps of friction and noise have
/// nearly one shape in it; they are told apart as in any record then.
AntiAliasConfig low_pass_of(const InputConfig& input) {
  AntiAliasConfig out{.corner_hz = input.anti_alias.corner_hz, .order = input.anti_alias.order};
  for (std::size_t c = 0; c < kChannels; ++c) {
    out.own_hz[c] = input.anti_alias.own_hz[c].value_or(0.0);
    if (out.own_hz[c] > 0.0 && out.corner_hz == 0.0)
      throw UsageError{
          "[input.anti_alias] corner_hz: found 0 (none, or unknown) beside a sensor's own corner, "
          "expected the corner of the other sensors"};
  }
  const double frame_hz = out.of(0).corner_hz;
  const bool closes = frame_hz > 0.0 && frame_hz < kThinnedEdge * truck_rate_hz(input);
  out.thinned = closes && decimation(input.sample_rate_hz) > 1;
  return out;
}

}  // namespace

EstimatorConfig estimator_config(const Config& config) {
  EstimatorConfig core;
  core.sample_rate_hz = truck_rate_hz(config.input);
  core.moving_mass_kg = config.car.moving_mass_kg;
  core.far_mass_kg = config.car.far_mass_kg.value_or(0.0);
  core.frame_pitch_mass_kg = config.car.frame_pitch_mass_kg.value_or(0.0);
  core.velocity_corner_hz = config.model.velocity_corner_hz.value_or(0.0);
  core.anti_alias = low_pass_of(config.input);
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

// A standing car's wheelsets show their sensors' noise; in g a running car's show a tenth.
constexpr double kLeastShakingInGMps2 = 0.1;

Magnitudes magnitudes_of(const TruckView& view, const Config& config) {
  return {view.wheelset_mps2,
          kStandardGravityMps2 * config.car.moving_mass_kg,
          view.faults.frame_follow.usual,
          view.faults.misplacement.difference,
          view.faults.misplacement.difference_share,
          config.input.anti_alias.corner_hz == 0.0};
}

DataFaults faults_of(const TruckView& view, double nominal_hz) {
  TruckRecord record;
  record.sample_rate_hz = nominal_hz;
  record.first_tick = view.first_tick;
  DataFaults out;
  describe_faults(view.faults, record, nominal_hz, out);
  return out;
}

RunResult describe_view(const TruckView& view, const MeasuredRate& rate, const Config& config,
                        const std::string& source) {
  const double nominal_hz = truck_rate_hz(config.input);
  const TruckRecord record = record_of(view, rate, nominal_hz, source);
  RunResult result = describe_truck(record, config.model);
  describe_faults(view.faults, record, nominal_hz, result.faults);
  describe_alarms(view.alarms, record, result);
  result.magnitudes = magnitudes_of(view, config);
  judge_trust(nullptr, result);
  return result;
}

template <Parts kParts>
TruckRun<kParts>::TruckRun(const Config& config, const RecordSignals& signals,
                           const effect::Grids& grids)
    : config_{config},
      rate_hz_{truck_rate_hz(config.input)},
      core_{std::make_unique<Core>(core_config(config, signals), grids)},
      block_ticks_{Estimator::kBlockS * rate_hz_},
      history_{static_cast<std::int64_t>(kFirstIntervalSeconds * rate_hz_), 0},
      excerpt_{rate_hz_} {}

template <Parts kParts>
void TruckRun<kParts>::note_taken(const Sample& sample) noexcept {
  if (samples_++ == 0) {
    first_tick_ = sample.tick;
    first_time_ns_ = sample.time_ns;
    history_.start(first_tick_);
  }
  newest_tick_ = std::max(newest_tick_, sample.tick);
  newest_time_ns_ = sample.time_ns;
  clipping_.take(sample);
}

template <Parts kParts>
void TruckRun<kParts>::note(const Sample& sample, const UpdateResult& result) {
  for (const Watcher& watcher : watchers_) watcher(sample, result);
  if (result.has_motion) excerpt_.take(result.motion);
  if (!result.block_closed) return;
  note_block(result.block);
  if (history_.due(sample.tick)) history_.add(sample.tick, core_->level());
}

template <Parts kParts>
void TruckRun<kParts>::note_block(const BlockReport& block) {
  ++blocks_[static_cast<std::size_t>(block.status)];
  const std::string_view why = reason(block.status);
  if (why.empty()) return;
  const double start = std::max(0.0, static_cast<double>(block.first_tick - first_tick_));
  const double end = static_cast<double>(block.first_tick - first_tick_) + block_ticks_;
  excluded_.add(start / rate_hz_, end / rate_hz_, why);
}

template <Parts kParts>
double TruckRun<kParts>::time_s() const noexcept {
  return static_cast<double>(newest_tick_ - first_tick_) / rate_hz_;
}

template <Parts kParts>
std::string TruckRun<kParts>::state_text() const {
  if (history_.rows().empty()) return "";
  const ConvergenceHistory::Row& row = history_.rows().back();
  return fmt::format("Fc {:.0f} +- {:.0f} N  k {:.3f} +- {:.3f} MN/m", row.coulomb_n.value,
                     row.coulomb_n.std, 1e-6 * row.stiffness_npm.value,
                     1e-6 * row.stiffness_npm.std);
}

template <Parts kParts>
TruckView TruckRun<kParts>::view() noexcept {
  return {core_->snapshot(), first_tick_,     newest_tick_,    first_time_ns_,
          newest_time_ns_,   core_->faults(), core_->alarms(), core_->guard().block().wheelset_mps2,
          used_blocks()};
}

template <Parts kParts>
void TruckRun<kParts>::close() {
  if (closed_) return;
  closed_ = true;
  Observer observer{*this};
  core_->finish(observer);
}

template <Parts kParts>
RunResult TruckRun<kParts>::finish(const MeasuredRate& rate, const std::string& source) {
  close();
  const TruckView last = view();
  const TruckRecord record = record_of(last, rate, rate_hz_, source);
  if (!last.snapshot.valid) fail_unusable(last.snapshot, source);
  history_.add(newest_tick_,
               {last.snapshot.valid, last.snapshot.coulomb_n, last.snapshot.stiffness_npm});
  RunResult result = describe_truck(record, config_.model);
  result.origin.recorded = recorded_span(first_time_ns_, newest_time_ns_);
  result.counts.emplace_back("blocks_spoilt",
                             blocks_[static_cast<std::size_t>(BlockStatus::kExcludedSpoilt)]);
  result.latency_s = core_->estimator().motion_latency_s() + config_.guards.wait_s;
  fill_history(history_.rows(), record, result);
  fill_motion(excerpt_.best(), record, result);
  fill_phase(core_->phase(), record, result);
  fill_densities(core_->density(), record, result);
  if (config_.estimate.methods == "all")
    fill_methods(core_->density(), config_.car.moving_mass_kg, last.snapshot.stiffness_npm.value,
                 record, result);
  result.warnings = clipping_.warnings();
  circumstances_ = effect::circumstances_of(
      last.faults, find_parameter_drift(*statistics(), Estimator::kBlockS));
  describe_faults_of_all(core_->guard(), circumstances_.faults, circumstances_.drift, record,
                         rate_hz_, result);
  describe_alarms(last.alarms, record, result);
  result.excluded = excluded_.list();
  result.excluded_more = excluded_.more();
  result.magnitudes = magnitudes_of(last, config_);
  judge_trust(nullptr, result);
  return result;
}

template <Parts kParts>
std::unique_ptr<Statistics> TruckRun<kParts>::statistics() {
  auto out = std::make_unique<Statistics>();
  core_->statistics(*out);
  return out;
}

template <Parts kParts>
void TruckRun<kParts>::fail_unusable(const Snapshot& snapshot, const std::string& source) const {
  const Counts& counts = snapshot.counts;
  std::string why;
  for (std::size_t i = 0; i < kStatuses; ++i) {
    const std::string_view word = reason(static_cast<BlockStatus>(i));
    if (!word.empty() && blocks_[i] > 0)
      why += fmt::format("{}{} ({})", why.empty() ? "" : ", ", blocks_[i], word);
  }
  const double shaking_mps2 = core_->guard().block().wheelset_mps2;
  const bool may_be_g = shaking_mps2 > kLeastShakingInGMps2 && shaking_mps2 < kLeastShakingMps2 &&
                        blocks_[static_cast<std::size_t>(BlockStatus::kStill)] > counts.blocks / 2;
  if (may_be_g)
    why += fmt::format("; the wheelsets shake by {:.2g} m/s^2 rms: are the accelerations in g?",
                       shaking_mps2);
  throw RunError{
      fmt::format("{}: nothing could be identified: {} samples in {} make {} blocks of 2 s, {} of "
                  "them excluded{}; "
                  "some ten usable blocks are needed",
                  source, format_count(counts.samples), format_duration(time_s()), counts.blocks,
                  counts.blocks_excluded + counts.blocks_still, why.empty() ? "" : ": " + why)};
}

template class TruckRun<kIdentifyParts>;
template class TruckRun<kExplainParts>;

}  // namespace dampline::app
