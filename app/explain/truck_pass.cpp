// SPDX-License-Identifier: MIT
#include "app/explain/truck_pass.hpp"

#include <fmt/format.h>

#include <string>

#include "app/error.hpp"
#include "app/identify/identify_source.hpp"
#include "app/identify/source_kind.hpp"

namespace dampline::app {
namespace {

SourceKind truck_source(const Config& config, const SourceOptions& source) {
  const SourceKind kind = detect_source(config, source);
  if (kind == SourceKind::kInterface)
    throw UsageError{fmt::format(
        "{}: is an interface, expected a record: record it with identify first", source.path)};
  if (kind == SourceKind::kRigCsv)
    throw UsageError{
        fmt::format("{}: has the columns of a rig, expected a truck's accelerations as the others",
                    source.path)};
  return kind;
}

}  // namespace

TruckPass pass_of(const Config& config, const SourceOptions& source,
                  const TruckPassOptions& options) {
  TruckPass pass;
  EstimatorConfig core = identifier_config(config);
  pass.feed = open_feed(config, source, truck_source(config, source));
  core.screen = pass.feed->screen();
  pass.run = std::make_unique<TruckRun>(config, core.screen);
  pass.diagnosis = std::make_unique<effect::Diagnosis>(core, options.grids);
  const auto take = [&diagnosis = *pass.diagnosis, &options](const Sample& sample,
                                                             const UpdateResult& result) {
    diagnosis.update(sample, result);
    if (options.watch) options.watch(sample, result, diagnosis);
  };
  std::unique_ptr<Estimator> second;
  Alignment alignment{options.lateness, core.sample_rate_hz};
  if (options.lateness.late_s == 0.0) {
    pass.run->watch(take);
  } else {
    second = std::make_unique<Estimator>(core);
    pass.run->watch([&](const Sample& sample, const UpdateResult&) {
      const auto aligned = alignment.next(sample);
      if (aligned) take(*aligned, second->update(*aligned));
    });
  }
  const auto no_state = [](const TruckRun&) { return std::string{}; };
  pump(*pass.feed, source, options.show_progress, no_state, *pass.run);
  pass.run->close();
  pass.run->watch({});
  pass.diagnosis->finish();
  return pass;
}

}  // namespace dampline::app
