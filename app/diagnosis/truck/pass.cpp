// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/pass.hpp"

#include <fmt/format.h>

#include <string>

#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "app/record/source_kind.hpp"

namespace dampline::app {

namespace {

SourceKind truck_source(const Config& config, const SourceOptions& source) {
  const SourceKind kind = detect_source(config, source);
  if (kind == SourceKind::kInterface)
    throw UsageError{fmt::format(
        "{}: is an interface, expected a record: record it with identify first", source.path)};
  if (kind == SourceKind::kRigRows)
    throw UsageError{
        fmt::format("{}: has the columns of a rig, expected a truck's accelerations as the others",
                    source.path)};
  return kind;
}

/// Hands on what a pass's second way made of its samples.
struct AlignedWatch {
  const TruckPassOptions& options;
  const TruckPass& pass;
  void taken(const Sample& /*unused*/) const noexcept {}
  void judged(const Sample& sample, const UpdateResult& result) const {
    if (options.watch) options.watch(sample, result, pass.diagnosis());
  }
};

}  // namespace

TruckPass pass_of(const Config& config, const SourceOptions& source,
                  const TruckPassOptions& options) {
  TruckPass pass;
  static_cast<void>(estimator_config(config));  // wrong settings before a wrong source
  pass.feed = open_feed(config, source, truck_source(config, source));
  pass.run = std::make_unique<ExplainRun>(config, pass.feed->signals(), options.grids);
  const IdentifierConfig& core = pass.run->config();
  FractionalDelay alignment{options.lateness, core.estimator.sample_rate_hz};
  if (options.lateness != ChannelLateness{} || options.other != nullptr) {
    IdentifierConfig aligned = core;
    if (options.other != nullptr) aligned.estimator.far_mass_kg = options.other->mass_kg.value;
    pass.aligned = std::make_unique<DiagnosisRun>(aligned, options.grids);
    AlignedWatch watch{options, pass};
    pass.run->watch(
        [&alignment, &options, &pass, watch](const Sample& sample, const UpdateResult&) mutable {
          const auto set_right = alignment.next(sample);
          if (!set_right) return;
          pass.aligned->push(
              options.other != nullptr ? options.other->beside(*set_right) : *set_right, watch);
        });
  } else if (options.watch) {
    pass.run->watch([&options, &pass](const Sample& sample, const UpdateResult& result) {
      options.watch(sample, result, pass.diagnosis());
    });
  }
  pump(*pass.feed, source, options.show_progress, *pass.run);
  pass.run->close();
  pass.run->watch({});
  if (pass.aligned) pass.aligned->finish();
  return pass;
}

}  // namespace dampline::app
