// SPDX-License-Identifier: MIT
#include "app/serve/metrics.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "app/run/provenance.hpp"
#include "app/run/trust.hpp"
#include "app/serve/exposition.hpp"

namespace dampline::app {
namespace {

void write_build(const RunResult& result, Exposition& text) {
  const std::string version_text = version();
  const std::string commit_text = commit();
  text.begin("build_info", "gauge", "Always 1; which program this is.");
  text.value(1, {{"version", version_text}, {"commit", commit_text}});
  text.begin("run_info", "gauge", "Always 1; whose truck this is and where its frames come from.");
  text.value(1, {{"vehicle", result.origin.vehicle},
                 {"truck", result.origin.truck},
                 {"source", result.origin.source}});
}

void write_parameters(const RunResult& result, Exposition& text) {
  text.begin("parameter", "gauge", "An identified parameter, in the unit of its label.");
  for (const Parameter& p : result.parameters)
    text.value(p.value, {{"name", p.name}, {"unit", p.unit}});
  text.begin("parameter_std", "gauge", "Its standard deviation, in the same unit.");
  for (const Parameter& p : result.parameters)
    text.value(p.std, {{"name", p.name}, {"unit", p.unit}});
}

void write_trust(const RunResult& result, Exposition& text) {
  text.begin("trust", "gauge", "1 for what the result is worth now, 0 for what it is not.");
  for (const Trust trust :
       {Trust::kTrusted, Trust::kModelIncomplete, Trust::kDataFaulty, Trust::kNotIdentified})
    text.value(trust == result.trust ? 1 : 0, {{"trust", name_of(trust)}});
  text.begin("lacking", "gauge", "1 for each effect that the data ask for and the model lacks.");
  for (const std::string& effect : result.lacking) text.value(1, {{"effect", effect}});
}

void write_state(const RunResult& result, Exposition& text) {
  if (!result.live) return;
  const LiveFigures& live = *result.live;
  text.begin("state", "gauge", "1 for the state of the acquisition, 0 for the others.");
  for (const std::string_view state : {"waiting", "identifying", "degraded", "fault", "ended"})
    text.value(live.state == state ? 1 : 0, {{"state", state}});
  if (live.collecting) {
    text.single("collected_seconds", "gauge", "Of what the first estimate needs.",
                live.collecting->have_s);
    text.single("collected_needed_seconds", "gauge", "What the first estimate needs.",
                live.collecting->need_s);
  }
  text.single("record_seconds", "gauge", "Length of what was identified so far.",
              result.duration_s);
  text.single("silence_seconds", "gauge", "Without a sample until now.", live.silence_s);
  if (live.explanation_age_s)
    text.single("explanation_age_seconds", "gauge",
                "Since the newest sums that say what is lacking.", *live.explanation_age_s);
  text.single("cycle_slips_total", "counter", "Samples late by more than one sampling period.",
              live.cycle_slips);
  text.begin("page_faults_total", "counter", "Of the acquisition, after its warm-up.");
  text.value(live.minor_faults, {{"kind", "minor"}});
  text.value(live.major_faults, {{"kind", "major"}});
  text.single("recording", "gauge", "1 while the black box is written.", live.recording ? 1 : 0);
  text.single("recorded_bytes_total", "counter", "Written to the black box.", live.recorded_bytes);
  text.single("records_lost_total", "counter", "Missing in the black box.", live.records_lost);
  text.single("publish_failures_total", "counter", "How often live.json could not be written.",
              live.publish_failures);
}

void write_frames(const RunResult& result, Exposition& text) {
  constexpr std::string_view kPrefix = "frames_";
  text.begin("frames_total", "counter",
             "CAN frames by what became of them; sent = processed + dropped + missing + excluded, "
             "the other results are parts of excluded.");
  for (const auto& [name, count] : result.counts)
    if (name.starts_with(kPrefix))
      text.value(count, {{"result", std::string_view{name}.substr(kPrefix.size())}});
}

void write_faults(const RunResult& result, Exposition& text) {
  text.begin("faults", "gauge", "Events of each fault of a sensor or the transport so far.");
  for (const FaultFinding& fault : result.faults.list)
    text.value(fault.count, {{"name", fault.name}, {"channel", fault.channel}});
  text.begin("alarm", "gauge", "1 while an alarm of [alarm] is raised.");
  for (const WatchState& watch : result.watched)
    text.value(watch.active ? 1 : 0, {{"name", watch.name}});
}

/// The bins of the histogram have an edge at each power of two of nanoseconds, where the counts
/// are exact. The sum is that of the bins' middles: good to 3 %.
void write_lateness(const RunResult& result, Exposition& text) {
  constexpr int kFirst = 13;  // 8.2 us
  constexpr int kLast = 33;   // 8.6 s
  constexpr double kEdgeShare = 1.0 + 1e-9;
  if (!result.live) return;
  text.begin("lateness_seconds", "histogram", "From a frame's stamp to its result.");
  std::uint64_t below = 0;
  std::size_t next = 0;
  for (int k = kFirst; k <= kLast; ++k) {
    const double edge_us = 1e-3 * std::ldexp(1.0, k);
    for (; next < result.lateness.size() && result.lateness[next].to_us <= edge_us * kEdgeShare;
         ++next)
      below += result.lateness[next].frames;
    const std::string edge = fmt::format("{:.9g}", 1e-6 * edge_us);
    text.value(below, {{"le", edge}}, "_bucket");
  }
  double sum_s = 0.0;
  for (const LatenessRow& row : result.lateness)
    sum_s += 1e-6 * 0.5 * (row.from_us + row.to_us) * static_cast<double>(row.frames);
  for (; next < result.lateness.size(); ++next) below += result.lateness[next].frames;
  text.value(below, {{"le", "+Inf"}}, "_bucket");
  text.value(sum_s, {}, "_sum");
  text.value(below, {}, "_count");
}

}  // namespace

std::string metrics_text(const RunResult& result, const ServerFigures* server) {
  Exposition text;
  write_build(result, text);
  write_parameters(result, text);
  write_trust(result, text);
  write_state(result, text);
  write_frames(result, text);
  write_faults(result, text);
  write_lateness(result, text);
  if (server != nullptr) {
    text.single("http_requests_total", "counter", "Answered by this server.", server->requests);
    text.single("http_streams", "gauge", "Readers of the stream of events.", server->readers);
    text.single("page_samples_lost_total", "counter", "Samples that the page's pictures lack.",
                server->motion_lost);
  }
  return text.take();
}

}  // namespace dampline::app
