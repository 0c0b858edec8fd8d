// SPDX-License-Identifier: MIT
#include "app/live/status.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/error.hpp"
#include "app/record/frames.hpp"
#include "app/record/rate.hpp"
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
  if (result.live) live.collecting = result.live->collecting;
  result.live = live;
  warn_of_losses(status, around, result);
  for (const std::string& problem : around.realtime.problems) result.notes.push_back(problem);
}

Collecting collecting_of(double elapsed_s, std::uint64_t usable_blocks,
                         const Config& config) noexcept {
  constexpr double kLagS = 4.0;  // of a block behind the samples that make it, at most
  constexpr double kFewestBlocks = 4.0;
  const double blocks = std::min(static_cast<double>(usable_blocks), kFewestBlocks);
  const double before_s = config.guards.wait_s + kLagS;
  return {std::min(elapsed_s, before_s + Estimator::kBlockS * blocks),
          before_s + Estimator::kBlockS * kFewestBlocks};
}

namespace {

Collecting collecting_of(const TruckView& view, const Config& config) {
  const auto ticks = static_cast<double>(view.newest_tick - view.first_tick);
  return collecting_of(ticks / truck_rate_hz(config.input), view.usable_blocks, config);
}

}  // namespace

RunResult result_so_far(const LiveStatus& status, const Config& config, const std::string& source) {
  RunResult result;
  result.kind = "truck";
  const Collecting collecting =
      status.any_sample ? collecting_of(status.view, config) : collecting_of(0.0, 0, config);
  result.headline = fmt::format("Collecting motion for the first estimate: {:.0f} of {:.0f} s.",
                                std::floor(collecting.have_s), collecting.need_s);
  result.trust_reasons = {result.headline};
  result.asymmetry = "not observable from accelerations";
  if (status.any_sample) result.faults = faults_of(status.view, config.input.sample_rate_hz);
  if (status.any_sample && status.view.snapshot.valid) {
    try {
      result = describe_view(status.view, status.rate, config, source);
    } catch (const RunError& error) {
      result.warnings.emplace_back(error.what());
    }
  }
  if (status.any_sample)
    result.origin.recorded = recorded_span(status.view.first_time_ns, status.view.newest_time_ns);
  if (result.parameters.empty()) {
    result.live.emplace();
    result.live->collecting = collecting;
  }
  return result;
}

RunResult live_result(const LiveStatus& status, const LiveSurroundings& around,
                      const Config& config) {
  RunResult result = result_so_far(status, config, around.source);
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
