// SPDX-License-Identifier: MIT
#include "app/live/status.hpp"

#include <fmt/format.h>

#include "app/error.hpp"
#include "app/record/frames.hpp"
#include "app/text/format.hpp"

namespace dampline::app {
namespace {

double microseconds(std::uint64_t ns) { return 1e-3 * static_cast<double>(ns); }

void warn_of_losses(const LiveStatus& status, const LiveSurroundings& around, RunResult& result) {
  if (status.source.dropped > 0)
    result.warnings.push_back(
        fmt::format("The kernel dropped {} frames: the receive buffer was full. [input.can] "
                    "receive_buffer_kib makes it larger.",
                    format_count(status.source.dropped)));
  if (around.record_wanted && !around.record.recording)
    result.warnings.emplace_back(
        "The black box is not being written: its disk is full or failed. Identification goes on.");
  if (around.record.lost > 0)
    result.warnings.push_back(
        fmt::format("{} records are missing in the black box: a replay will differ from this run.",
                    format_count(around.record.lost)));
  if (around.publish_failures > 0)
    result.warnings.push_back(
        fmt::format("live.json could not be written {} times. Identification went on.",
                    format_count(around.publish_failures)));
}

}  // namespace

void describe_live(const LiveStatus& status, const LiveSurroundings& around, RunResult& result) {
  LiveFigures live;
  live.state = around.state;
  live.lateness_p50_us = microseconds(status.lateness.quantile_ns(0.5));
  live.lateness_p90_us = microseconds(status.lateness.quantile_ns(0.9));
  live.lateness_p99_us = microseconds(status.lateness.quantile_ns(0.99));
  live.lateness_p999_us = microseconds(status.lateness.quantile_ns(0.999));
  live.lateness_max_us = microseconds(status.lateness.max_ns());
  status.lateness.for_each([&](std::uint64_t from_ns, std::uint64_t to_ns, std::uint64_t frames) {
    result.lateness.push_back({microseconds(from_ns), microseconds(to_ns), frames});
  });
  live.cycle_slips = status.cycle_slips;
  live.minor_faults = status.faults.minor;
  live.major_faults = status.faults.major;
  live.memory_locked = around.realtime.memory_locked;
  live.realtime_scheduled = around.realtime.scheduled;
  if (status.any_sample)
    live.first_sample_s = 1e-9 * static_cast<double>(status.first_sample_ns - around.start_ns);
  live.silence_s = 1e-9 * static_cast<double>(around.silence_ns);
  live.recording = around.record_wanted && around.record.recording;
  live.recorded_bytes = around.record.bytes;
  live.records_lost = around.record.lost;
  live.publish_failures = around.publish_failures;
  result.live = live;
  warn_of_losses(status, around, result);
  for (const std::string& problem : around.realtime.problems) result.notes.push_back(problem);
}

RunResult live_result(const LiveStatus& status, const LiveSurroundings& around,
                      const Config& config) {
  RunResult result;
  result.kind = "truck";
  result.headline = "Not enough motion yet to identify anything.";
  result.trust_reasons = {result.headline};
  result.asymmetry = "not observable from accelerations";
  if (status.any_sample) result.faults = faults_of(status.view, config.input.sample_rate_hz);
  if (status.any_sample && status.view.snapshot.valid) {
    try {
      result = describe_view(status.view, status.rate, config, around.source);
    } catch (const RunError& error) {
      result.warnings.emplace_back(error.what());
    }
  }
  if (status.any_sample)
    result.origin.recorded = recorded_span(status.view.first_time_ns, status.view.newest_time_ns);
  describe_frames(status.source, status.assembler, result);
  describe_live(status, around, result);
  return result;
}

std::string status_line(const RunResult& result) {
  std::string text = result.live ? result.live->state : "";
  text += fmt::format("  {}", format_duration(result.duration_s));
  for (std::size_t i = 0; i < result.parameters.size() && i < 2; ++i) {
    const Parameter& p = result.parameters[i];
    const QuantityText value = format_quantity(p.value, p.std);
    text += fmt::format("  {} {} ± {} {}", p.name, value.value, value.std, p.unit);
  }
  return text;
}

}  // namespace dampline::app
