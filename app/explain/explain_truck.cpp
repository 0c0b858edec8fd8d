// SPDX-License-Identifier: MIT
#include "app/explain/explain_truck.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>

#include "app/error.hpp"
#include "app/explain/fault_veto.hpp"
#include "app/identify/identify_source.hpp"
#include "app/identify/source_kind.hpp"
#include "app/identify/truck_run.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::app {
namespace {

bool has(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

effect::ExplainerConfig explainer_config(const Config& config) {
  effect::ExplainerConfig out;
  out.moving_mass_kg = config.car.moving_mass_kg;
  out.base_viscous = has(config.model.base, "viscous");
  const auto& wanted = config.model.candidates;
  for (std::size_t i = 0; i < effect::kEffects; ++i) {
    const char* name = effect::name_of(static_cast<effect::Effect>(i));
    out.allowed[i] = (has(wanted, "all") || has(wanted, name)) && !has(config.model.base, name);
  }
  return out;
}

SourceKind truck_source(const Config& config, const SourceOptions& source) {
  const SourceKind kind = detect_source(config, source);
  if (kind == SourceKind::kInterface)
    throw UsageError{fmt::format(
        "{}: is an interface, expected a record: record it with identify first", source.path)};
  if (kind == SourceKind::kRigCsv)
    throw UsageError{fmt::format(
        "{}: has the columns of a rig, expected a truck's accelerations: explain cannot read rigs "
        "yet",
        source.path)};
  return kind;
}

/// One record through the estimate and the diagnosis beside it.
struct Pass {
  std::unique_ptr<SampleFeed> feed;
  std::unique_ptr<TruckRun> run;
  std::unique_ptr<effect::Diagnosis> diagnosis;
};

Pass pass_of(const Config& config, const SourceOptions& source, double scale_m,
             bool show_progress) {
  Pass pass;
  IdentifierConfig core = identifier_config(config);
  pass.feed = open_feed(config, source, truck_source(config, source));
  core.screen = pass.feed->screen();
  pass.run = std::make_unique<TruckRun>(config, core.screen);
  pass.diagnosis = std::make_unique<effect::Diagnosis>(core, scale_m);
  pass.run->watch([&diagnosis = *pass.diagnosis](const Sample& sample, const UpdateResult& result) {
    diagnosis.update(sample, result);
  });
  const auto no_state = [](const TruckRun&) { return std::string{}; };
  pump(*pass.feed, source, show_progress, no_state, *pass.run);
  pass.diagnosis->finish();
  return pass;
}

Validated validate(const Config& config, const std::string& path, bool skip_bad_lines,
                   double scale_m, const effect::Explanation& explanation,
                   effect::Explainer& explainer) {
  const Pass pass = pass_of(config, {path, skip_bad_lines}, scale_m, false);
  const auto found = explainer.predict(*pass.diagnosis, explanation);
  if (!(found.base_nmse > 0.0)) throw RunError{fmt::format("{}: too short to validate on", path)};
  return {path, found.base_nmse, found.final_nmse};
}

}  // namespace

Explained explain_truck(const Config& config, const ExplainOptions& options) {
  const Pass pass = pass_of(config, options.source, 0.0, options.show_progress);
  Explained out;
  out.identified = pass.run->finish(pass.feed->rate(), options.source.path);
  pass.feed->describe(out.identified);
  const auto explainer = std::make_unique<effect::Explainer>();
  out.explanation = explainer->explain(*pass.diagnosis, explainer_config(config));
  if (out.explanation.conclusion == effect::Conclusion::kNotReady)
    throw RunError{fmt::format("{}: too short to explain: {} groups of blocks, some ten are needed",
                               options.source.path, pass.diagnosis->store().count())};
  out.withheld = forbids_naming(out.identified.faults);
  out.drifts = !out.withheld && drift_explains_more(out.identified.faults, out.explanation);
  if (out.withheld || out.drifts) withhold_effects(out.explanation);
  for (const std::string& path : options.validation)
    out.validation.push_back(validate(config, path, options.source.skip_bad_lines,
                                      pass.diagnosis->scale_m(), out.explanation, *explainer));
  out.inputs = pass.feed->extra_inputs();
  out.inputs.insert(out.inputs.begin(), describe_input(options.source.path, "record"));
  for (const std::string& path : options.validation)
    out.inputs.push_back(describe_input(path, "validation"));
  out.state = pass.run->encoded_state();
  return out;
}

}  // namespace dampline::app
