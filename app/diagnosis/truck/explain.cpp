// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/explain.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>
#include <memory>

#include "app/diagnosis/truck/looks.hpp"
#include "app/diagnosis/truck/pass.hpp"
#include "app/diagnosis/truck/points.hpp"
#include "app/diagnosis/truck/verdict.hpp"
#include "app/error.hpp"
#include "app/identify/identify_source.hpp"
#include "dampline/effect/explainer.hpp"

namespace dampline::app {

namespace {

/// Predicts a record that took no part, and appends it to prediction.csv as the `number`-th.
Validated validate(const Config& config, const SourceOptions& source, std::uint32_t number,
                   Explained& out, effect::Explainer& explainer) {
  std::vector<PredictedRow>& rows = out.identified.evidence.prediction;
  const EstimatorConfig core = estimator_config(config);
  const auto keep = [&](const EvidencePoint& p) {
    rows.push_back({number, p.time_s, p.measured_n, p.final_n, p.base_n,
                    std::numeric_limits<double>::quiet_NaN()});
  };
  TruckPoints points{core.sample_rate_hz, core.moving_mass_kg, out.explanation, {keep, {}}};
  TruckPassOptions options{out.explanation.grids, out.lateness, false, {}};
  options.watch = [&](const Sample& sample, const UpdateResult& result,
                      const effect::Diagnosis& diagnosis) {
    points.take(sample, result, diagnosis);
  };
  const TruckPass pass = pass_of(config, source, options);
  const auto found = explainer.predict(pass.diagnosis(), out.explanation);
  if (!(found.base_nmse > 0.0))
    throw RunError{fmt::format("{}: too short to validate on", source.path)};
  return {source.path, std::sqrt(found.base_nmse), std::sqrt(found.final_nmse)};
}

}  // namespace

Explained explain_truck(const Config& config, const ExplainOptions& options) {
  const EstimatorConfig core = estimator_config(config);
  FrameNoise noise{core.sample_rate_hz, core.anti_alias};
  const auto listen = [&](const Sample& sample, const UpdateResult&, const effect::Diagnosis&) {
    noise.take(sample);
  };
  const TruckPass pass = pass_of(config, options.source, {{}, {}, options.show_progress, listen});
  Explained out;
  out.identified = pass.run->finish(rate_of(*pass.feed, *pass.run), options.source.path);
  pass.feed->describe(pass.run->frames(), out.identified);
  out.circumstances = pass.run->circumstances();
  const auto explainer = std::make_unique<effect::Explainer>();
  while (true) {
    if (!judge_sums(config, pass.diagnosis(), *explainer, out))
      throw RunError{
          fmt::format("{}: too short to explain: {} groups of blocks, some ten are needed. {}",
                      options.source.path, pass.diagnosis().store().count(),
                      fmt::join(out.identified.trust_reasons, " "))};
    out.lateness = {};
    look_closer(config, options, pass, noise, *explainer, out);
    look_again(config, options, pass, noise, *explainer, out);
    const effect::Effect needless = needless_effect(out.explanation);
    if (needless == effect::Effect::kUnknown) break;
    out.needless[static_cast<std::size_t>(needless)] = true;
  }
  effect::name_nothing_impossible(out.explanation);
  std::uint32_t number = 0;
  for (const std::string& path : options.validation)
    out.validation.push_back(
        validate(config, {path, options.source.skip_bad_lines}, ++number, out, *explainer));
  out.inputs = pass.feed->extra_inputs();
  out.inputs.insert(out.inputs.begin(), describe_record(options.source.path));
  for (const std::string& path : options.validation)
    out.inputs.push_back(describe_input(path, "validation"));
  out.sums = pass.run->statistics();
  return out;
}

}  // namespace dampline::app
