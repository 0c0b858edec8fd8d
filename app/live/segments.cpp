// SPDX-License-Identifier: MIT
#include "app/live/segments.hpp"

#include <algorithm>
#include <cmath>

#include "app/error.hpp"
#include "app/record/rate.hpp"
#include "app/run/directory.hpp"
#include "dampline/damping/summary.hpp"

namespace dampline::app {
namespace {

EstimatorConfig segment_config(const Config& config) {
  EstimatorConfig out = estimator_config(config);
  out.memory = Memory::kInfinite;  // all of a segment counts
  return out;
}

/// Over when it was last seen; the others change what comes after them.
bool passes(FaultKind kind) {
  switch (kind) {
    case FaultKind::kClipping:
    case FaultKind::kStuckChannel:
    case FaultKind::kSpikes:
    case FaultKind::kDcJump:
    case FaultKind::kLostSamples:
    case FaultKind::kRepeatedSamples:
    case FaultKind::kNoiseBurst:
      return true;
    default:
      return false;
  }
}

/// Those that concern the segment, in its own time.
FaultView faults_within(const FaultView& all, double start_s) {
  FaultView out = all;
  out.count = 0;
  for (Fault fault : all.list()) {
    if (passes(fault.kind) && fault.last_s < start_s) continue;
    fault.time_s = std::max(0.0, fault.time_s - start_s);
    fault.last_s = std::max(0.0, fault.last_s - start_s);
    out.faults[out.count++] = fault;
  }
  return out;
}

/// What the segment's sums say; nothing where they do not suffice, or the rate is a wrong one.
RunResult result_of(const SegmentState& segment, const Config& config) {
  TruckView view = segment.view;
  const double start_s = static_cast<double>(view.first_tick - segment.run_first_tick) /
                         segment.sums.header.sample_rate_hz;
  view.faults = faults_within(view.faults, start_s);
  view.snapshot =
      summarise(segment.sums, {.moving_mass_kg = estimator_config(config).moving_mass_kg});
  RunResult nothing;
  nothing.sample_rate_hz = Estimate{segment.rate.rate_hz, segment.rate.std_hz};
  nothing.trust = Trust::kNotIdentified;
  if (!view.snapshot.valid) return nothing;
  try {
    return describe_view(view, segment.rate, config, "segment");
  } catch (const RunError&) {
    return nothing;
  }
}

}  // namespace

SegmentRun::SegmentRun(const Config& config, ExplainRun& run)
    : run_{run},
      low_pass_{run.config().estimator.anti_alias, run.config().estimator.sample_rate_hz},
      estimator_{std::make_unique<Estimator>(segment_config(config))},
      segment_ns_{std::llround(1e9 * config.spool.segment_s)},
      every_ns_{std::llround(1e9 * config.spool.every_s)} {
  run.watch([this](const Sample& sample, const UpdateResult& /*result*/) { take(sample); });
}

void SegmentRun::take(const Sample& sample) noexcept {
  const bool other = any_ && (sample.time_ns / segment_ns_ != first_ns_ / segment_ns_ ||
                              sample.time_ns < newest_ns_);
  if (other) end();
  if (!any_) begin(sample);
  estimator_->update(low_pass_.update(sample));
  fresh_ = true;
  newest_tick_ = sample.tick;
  newest_ns_ = sample.time_ns;
  if (newest_ns_ < due_ns_) return;
  due_ns_ = newest_ns_ + every_ns_;
  export_to(newest_->back());
  newest_->publish();
}

void SegmentRun::begin(const Sample& sample) noexcept {
  any_ = true;
  if (++number_ == 1) run_first_tick_ = sample.tick;
  first_tick_ = sample.tick;
  first_ns_ = sample.time_ns;
  due_ns_ = first_ns_ + every_ns_;
}

void SegmentRun::end() noexcept {
  any_ = false;
  export_to(*ending_);
  ending_->is_last = true;
  if (!ended_.push(*ending_)) lost_.fetch_add(1, std::memory_order_release);
  estimator_->clear_statistics();
}

void SegmentRun::export_to(SegmentState& out) noexcept {
  estimator_->export_statistics(out.sums);
  out.view.first_tick = first_tick_;
  out.view.newest_tick = newest_tick_;
  out.view.first_time_ns = first_ns_;
  out.view.newest_time_ns = newest_ns_;
  out.view.faults = run_.core().faults();
  out.view.wheelset_mps2 = run_.core().guard().block().wheelset_mps2;
  out.rate = run_.core().assembler().measured_rate();
  out.number = number_;
  out.run_first_tick = run_first_tick_;
  fresh_ = false;
}

void SegmentRun::finish() {
  // Of the same samples there is one state: what the end adds to it could not be told to be later.
  if (!any_ || !fresh_) return;
  estimator_->finish();
  end();
}

bool SegmentRun::next() {
  if (ended_.pop(*ended_front_)) {
    front_ = ended_front_.get();
    ended_number_ = front_->number;
    return true;
  }
  if (!newest_->take() || newest_->front().number <= ended_number_) return false;
  front_ = &newest_->front();
  return true;
}

SegmentFile describe_segment(const SegmentState& segment, const Config& config,
                             const std::vector<InputFile>& inputs, std::uint64_t boot,
                             const std::string& alarms) {
  RunResult result = result_of(segment, config);
  result.origin = origin_of(config, inputs,
                            recorded_span(segment.view.first_time_ns, segment.view.newest_time_ns));
  SegmentFile out;
  out.about = state_about(config, result, segment.sums);
  if (out.about.segment.start_ns == 0) out.about.segment.record = boot + segment.number;
  out.about.alarms = alarms;
  const StateKind kind = config.spool.kind == "light" ? StateKind::kLight : StateKind::kFull;
  out.bytes = encode_state(segment.sums, out.about, kind);
  return out;
}

}  // namespace dampline::app
