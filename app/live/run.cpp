// SPDX-License-Identifier: MIT
#include "app/live/run.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <thread>

#include "app/error.hpp"
#include "app/record/frames.hpp"
#include "app/text/format.hpp"

namespace dampline::app {
namespace {

constexpr std::chrono::milliseconds kLampTurn{60};  // often enough for the lamp's patterns

AcquisitionConfig acquisition_config(const AssemblerConfig& assembler, const LiveOptions& options) {
  AcquisitionConfig config;
  config.sample_rate_hz = assembler.sample_rate_hz;
  config.publish_interval_ns = std::llround(1e9 * options.publish_every_s);
  config.read_interval_ns = std::llround(1e9 * options.read_every_s);
  return config;
}

}  // namespace

LiveRun::LiveRun(const Config& config, const AssemblerConfig& assembler, const LiveParts& parts,
                 const LiveOptions& options, LiveOutlets outlets)
    : config_{config},
      channels_{assembler.channels},
      parts_{parts},
      options_{options},
      outlets_{std::move(outlets)},
      truck_{config, {assembler.channels, screen_of(assembler.channels), assembler.extras}},
      segments_{outlets_.segment ? std::make_unique<SegmentRun>(config, truck_) : nullptr},
      explainer_{config, truck_},
      acquisition_{std::make_unique<Acquisition>(*parts.source, *parts.clock, truck_,
                                                 acquisition_config(assembler, options))},
      recorder_{*parts.sink, *parts.clock, acquisition_->items()},
      monitor_{*acquisition_, parts.clock->monotonic_ns()},
      alarms_{config.alarm},
      alarm_program_{config.alarm.on_alarm},
      start_ns_{parts.clock->monotonic_ns()} {
  if (parts.tap != nullptr)
    truck_.watch([tap = parts.tap](const Sample& sample, const UpdateResult& result) {
      tap->take(sample, result);
    });
}

Identified LiveRun::run() {
  const Signals signals;  // before the threads, which inherit what it blocks
  note(hal::EventKind::kRunStart, parts_.run_time.offset_ns);
  lock_memory(realtime_);
  recorder_.start();
  explainer_.start();
  std::jthread acquisition{[this] { acquire(); }};
  // However this function is left, the thread can be joined.
  const std::unique_ptr<Acquisition, void (*)(Acquisition*)> stopper{
      acquisition_.get(), [](Acquisition* a) { a->stop(); }};
  ready_.wait();
  if (outlets_.begin) outlets_.begin(recorder_);
  watch(signals);
  acquisition_->stop();
  acquisition.join();
  explainer_.stop();
  acquisition_->finish();
  note(hal::EventKind::kRunEnd, static_cast<std::int64_t>(parts_.source->health().frames));
  if (outlets_.end) outlets_.end();
  recorder_.stop();
  return conclude();
}

void LiveRun::acquire() {
  schedule_fifo(options_.realtime_priority, realtime_);
  prefault_stack();
  ready_.count_down();
  acquisition_->run();
}

void LiveRun::note(hal::EventKind kind, std::int64_t value) {
  const std::int64_t now_ns = parts_.run_time.from_monotonic(parts_.clock->monotonic_ns());
  recorder_.add({now_ns, kind, 0, value});
}

void LiveRun::watch(const Signals& signals) {
  const std::int64_t end_ns = start_ns_ + std::llround(1e9 * options_.duration_s);
  while (!acquisition_->ended()) {
    const SignalSeen seen = signals.wait(kLampTurn);
    if (seen == SignalSeen::kStop) return;
    if (seen == SignalSeen::kRotate) rotate();
    const std::int64_t now_ns = parts_.clock->monotonic_ns();
    const Condition condition = monitor_.look(recorder_.health(), now_ns);
    state_ = judge(condition);
    silence_ns_ = condition.silence_ns;
    alarm_program_.collect();
    if (outlets_.turn)
      outlets_.turn({state_, alarms_.any_raised(), acquisition_->heartbeats(),
                     acquisition_->samples(), silence_ns_, now_ns});
    publish_when_fresh();
    pass_segments();
    if (options_.duration_s > 0.0 && now_ns >= end_ns) return;
  }
}

void LiveRun::rotate() {
  recorder_.rotate();
  if (outlets_.rotated) outlets_.rotated();
}

void LiveRun::publish_when_fresh() {
  if (!acquisition_->status().take() || !outlets_.publish) return;
  RunResult result = live_result(acquisition_->status().front(),
                                 surroundings(std::string{name_of(state_)}), config_);
  const TruckView& view = acquisition_->status().front().view;
  explainer_.add_newest(result, static_cast<double>(view.newest_tick - view.first_tick) /
                                    truck_rate_hz(config_.input));
  result.origin = origin_of(config_, parts_.inputs, result.origin.recorded);
  result.origin.written_ns = parts_.clock->realtime_ns();
  raise_alarms(result);
  describe_segments(result);
  if (acquisition_->status().front().any_sample)
    recorder_.newest_events().describe(acquisition_->status().front().view.first_time_ns, result);
  publish(result);
}

void LiveRun::raise_alarms(RunResult& result) {
  for (const AlarmChange& change : alarms_.look(result)) {
    const std::int64_t now_ns = parts_.run_time.from_monotonic(parts_.clock->monotonic_ns());
    recorder_.add(
        {now_ns, change.kind(), change.number, std::llround(change.watch.value.value_or(0.0))});
    if (change.watch.active) raised_.insert(change.watch.name);
    static_cast<void>(alarm_program_.start(change, result.duration_s));
    if (outlets_.alarm) outlets_.alarm(change, result.duration_s);
  }
  result.watched = alarms_.states();
  if (alarm_program_.failures() > 0)
    result.warnings.push_back(fmt::format("[alarm] on_alarm could not be started {} times.",
                                          format_count(alarm_program_.failures())));
}

void LiveRun::describe_segments(RunResult& result) const {
  if (segments_ && segments_->lost() > 0)
    result.warnings.push_back(
        fmt::format("[spool]: the last states of {} segments found no room on their way to it.",
                    format_count(segments_->lost())));
  if (outlets_.describe) outlets_.describe(result);
}

void LiveRun::pass_segments() {
  while (segments_ && segments_->next()) {
    outlets_.segment(segments_->front(), fmt::format("{}", fmt::join(raised_, ", ")));
    if (segments_->front().is_last) forget_alarms();
  }
}

/// Those that are still raised belong to the next segment, too.
void LiveRun::forget_alarms() {
  raised_.clear();
  for (const WatchState& watch : alarms_.states())
    if (watch.active) raised_.insert(watch.name);
}

/// A disk that is full or a directory that is gone ends no run: the next version is tried again.
void LiveRun::publish(const RunResult& result) {
  try {
    outlets_.publish(result);
    if (failed_in_a_row_ > 0)
      note(hal::EventKind::kPublishResumed, static_cast<std::int64_t>(failed_in_a_row_));
    failed_in_a_row_ = 0;
  } catch (const std::exception& error) {
    const auto* io = dynamic_cast<const IoError*>(&error);
    if (failed_in_a_row_ == 0) note(hal::EventKind::kPublishFailed, io != nullptr ? io->error : 0);
    ++failed_in_a_row_;
    ++publish_failures_;
  }
}

LiveSurroundings LiveRun::surroundings(const std::string& state) const {
  return {parts_.name, realtime_, recorder_.health(), options_.record,
          state,       start_ns_, silence_ns_,        publish_failures_};
}

Identified LiveRun::conclude() {
  const LiveStatus status = acquisition_->final_status();
  if (truck_.empty())
    throw RunError{fmt::format("{}: not one complete sample: {}", parts_.name,
                               explain_no_sample(status.source, status.assembler, channels_))};
  Identified out;
  truck_.close();
  if (segments_) segments_->finish();
  pass_segments();
  out.result = truck_.finish(status.rate, parts_.name);
  describe_segments(out.result);
  describe_frames(status.source, status.assembler, out.result);
  describe_live(status, surroundings("ended"), out.result);
  out.result.watched = alarms_.states();
  recorder_.events().describe(truck_.first_time_ns(), out.result);
  explainer_.conclude(out.result);
  out.sums = truck_.statistics();
  out.inputs = parts_.inputs;
  return out;
}

}  // namespace dampline::app
