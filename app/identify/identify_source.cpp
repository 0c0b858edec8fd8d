// SPDX-License-Identifier: MIT
#include "app/identify/identify_source.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <future>
#include <memory>

#include "app/error.hpp"
#include "app/identify/progress.hpp"
#include "app/identify/source_kind.hpp"
#include "app/rig/identify.hpp"
#include "app/rig/record.hpp"

namespace dampline::app {
namespace {

constexpr std::size_t kSampleBatch = 4096;

std::string state_text(const TruckRun& run) {
  const ConvergenceHistory::Row* row = run.newest();
  if (row == nullptr) return "";
  return fmt::format("Fc {:.0f} +- {:.0f} N  k {:.3f} +- {:.3f} MN/m", row->coulomb_n.value,
                     row->coulomb_n.std, 1e-6 * row->stiffness_npm.value,
                     1e-6 * row->stiffness_npm.std);
}

Identified identify_truck(const Config& config, const SourceOptions& source, SourceKind kind,
                          bool show_progress) {
  static_cast<void>(identifier_config(config));  // wrong settings before a wrong source
  const auto feed = open_feed(config, source, kind);
  TruckRun run{config, feed->screen()};
  pump(*feed, source, show_progress, state_text, run);
  Identified out;
  out.result = run.finish(feed->rate(), source.path);
  feed->describe(out.result);
  out.inputs = feed->extra_inputs();
  out.state = run.encoded_state();
  return out;
}

Identified identify_rig_file(const Config& config, const SourceOptions& source,
                             bool show_progress) {
  Progress progress{show_progress};
  Identified out;
  const rig::Record record = rig::csv_record(source.path, config.input, source.skip_bad_lines);
  out.result = rig::identify(record, config, [&](double share) {
    if (progress.due()) progress.show(share, 0.0, "");
  });
  return out;
}

InputFile describe_record(const std::string& path) {
  if (!std::filesystem::is_regular_file(path)) return {path, "record", 0, ""};
  return describe_input(path, "record");
}

}  // namespace

void pump(SampleFeed& feed, const SourceOptions& source, bool show_progress,
          const std::function<std::string(const TruckRun&)>& state, TruckRun& run) {
  const auto lines = show_progress ? estimate_lines(source.path) : std::nullopt;
  Progress progress{show_progress};
  std::vector<Sample> samples;
  samples.reserve(kSampleBatch);
  for (bool more = true; more;) {
    samples.clear();
    more = feed.read(samples);
    for (const Sample& sample : samples) run.take(sample);
    if (!progress.due()) continue;
    const auto share =
        lines ? std::optional{static_cast<double>(feed.lines()) / *lines} : std::nullopt;
    progress.show(share, run.time_s(), state(run));
  }
  if (run.empty())
    throw RunError{
        fmt::format("{}: holds no complete sample: {}", source.path, feed.explain_emptiness())};
}

std::unique_ptr<SampleFeed> open_feed(const Config& config, const SourceOptions& source,
                                      SourceKind kind) {
  if (kind == SourceKind::kCandump) return open_can_feed(config, source);
  if (kind == SourceKind::kBlackbox) return open_blackbox_feed(config, source);
  return open_csv_feed(config, source);
}

Identified identify_source(const Config& config, const SourceOptions& source, SourceKind kind,
                           bool show_progress) {
  // Beside the identification, so that a checksum costs no time.
  auto record = std::async(std::launch::async, describe_record, source.path);
  Identified out = kind == SourceKind::kRigCsv
                       ? identify_rig_file(config, source, show_progress)
                       : identify_truck(config, source, kind, show_progress);
  out.inputs.insert(out.inputs.begin(), record.get());
  return out;
}

}  // namespace dampline::app
