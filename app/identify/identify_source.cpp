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

Identified identify_truck(const Config& config, const SourceOptions& source, SourceKind kind,
                          bool show_progress) {
  static_cast<void>(estimator_config(config));  // wrong settings before a wrong source
  const auto feed = open_feed(config, source, kind);
  TruckRun<kIdentifyParts> run{config, feed->signals()};
  pump(*feed, source, show_progress, run);
  Identified out;
  out.result = run.finish(rate_of(*feed, run), source.path);
  feed->describe(run.frames(), out.result);
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
