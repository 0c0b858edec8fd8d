// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/explain.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "app/diagnosis/truck/by_motion.hpp"
#include "app/diagnosis/truck/looks.hpp"
#include "app/diagnosis/truck/low_pass.hpp"
#include "app/diagnosis/truck/pass.hpp"
#include "app/diagnosis/truck/points.hpp"
#include "app/diagnosis/truck/verdict.hpp"
#include "app/error.hpp"
#include "app/identify/source.hpp"
#include "dampline/effect/explainer.hpp"
#include "dampline/numeric/mean_t.hpp"

namespace dampline::app {

namespace {

constexpr double kByMotionT = 2.0;  // of another spring: it leaves less of the frame's motion

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

/// One record, and what its readings share.
struct Reading {
  const Config& config;
  const ExplainOptions& options;
  FrameNoise noise;
  std::unique_ptr<effect::Explainer> explainer{std::make_unique<effect::Explainer>()};
  OtherTruckSearch search;
};

/// Explains what a pass gathered, until nothing needless is named.
void explain_pass(Reading& reading, const TruckPass& pass, Explained& out) {
  const auto& [config, options, noise, explainer, search] = reading;
  while (true) {
    if (!judge_sums(config, pass.diagnosis(), *explainer, out))
      throw RunError{
          fmt::format("{}: too short to explain: {} groups of blocks, some ten are needed. {}",
                      options.source.path, pass.diagnosis().store().count(),
                      fmt::join(out.identified.trust_reasons, " "))};
    out.lateness = {};
    look_closer(config, options, pass, noise, *explainer, out);
    if (!look_again(config, options, pass, noise, *explainer, out, reading.search)) continue;
    hold_back(out);
    if (!take_needless(out.explanation, out.needless)) return;
  }
}

/// Friction of a truck that hardly moves can look like two late channels, which then leave
/// something: none is late where the record as it was read leaves less, and that is no more than
/// sensors make.
void doubt_lateness(Reading& reading, const TruckPass& pass, Explained& out) {
  if (!any_of_steps(out.explanation, is_late) || out.withheld || out.drifts) return;
  if (conclusion_of(out) != effect::Conclusion::kPartlyExplained) return;
  Explained punctual = out;
  punctual.needless = {};
  punctual.needless.effect[static_cast<std::size_t>(effect::Effect::kTimeSkew)] = true;
  explain_pass(reading, pass, punctual);
  const bool whole = conclusion_of(punctual) == effect::Conclusion::kExplained;
  if (whole && left_nmse(punctual) < left_nmse(out)) out = std::move(punctual);
}

/// The truck under the other end of the body: the record is explained anew with what its frame
/// does, and stays so where less is left then.
void look_for_other(Reading& reading, const TruckPass& first, Explained& out) {
  Explained with = out;
  with.other = other_in(reading.config, reading.search, first.diagnosis().velocity_rms_mps(), out);
  if (!with.other) return;
  with.without_other_nmse = base_error(out.explanation);
  with.needless = {};
  const TruckPass pass = pass_of(reading.config, reading.options.source,
                                 {{}, {}, reading.options.show_progress, {}, with.other.get()});
  explain_pass(reading, pass, with);
  if (other_leaves_less(with, out)) out = std::move(with);
}

/// Mean over its deviation, of what blocks gain.
double t_of(const Eigen::VectorXd& gain) {
  MeanT mean;
  for (const double g : gain) mean.add(g);
  return mean.t();
}

/// A stop and a spring that hardens leave the equations almost alike, since these see the
/// deflection without what is slow; the frame's own motion has that too, and tells them apart.
void refine(Reading& reading, const TruckPass& pass, Explained& out) {
  const Config& config = reading.config;
  const SourceOptions& source = reading.options.source;
  const auto chosen = spring_with_rival(out.explanation);
  Explained rival;
  if (chosen) rival = out;
  const Eigen::VectorXd left = refine_by_motion(config, source, out);
  if (left.size() == 0 || !chosen) return;
  rival.needless.effect[static_cast<std::size_t>(*chosen)] = true;
  explain_pass(reading, pass, rival);
  effect::name_nothing_impossible(rival.explanation);
  const Eigen::VectorXd by_rival = refine_by_motion(config, source, rival);
  if (by_rival.size() != left.size() || !(t_of(left - by_rival) > kByMotionT)) return;
  rival.notes.push_back(
      fmt::format("{} would explain the equations as well; moved by the "
                  "wheelsets it leaves {:.3g} of the velocity's square.",
                  effect::name_of(*chosen), left.sum()));
  out = std::move(rival);
}

}  // namespace

void take_misplaced(TruckView view, double rate_hz, Explained& out) {
  view.faults = out.circumstances.faults;
  DataFaults& faults = out.identified.faults;
  const DataFaults all = faults_of(view, rate_hz);
  faults.list.insert(faults.list.end(),
                     all.list.begin() + static_cast<std::ptrdiff_t>(faults.list.size()),
                     all.list.end());
  faults.lasting = all.lasting;
}

std::shared_ptr<const OtherTruck> other_in(const Config& config, const OtherTruckSearch& search,
                                           double velocity_rms_mps, const Explained& without) {
  if (!is_wanted(config.model, "other_truck") || config.car.far_mass_kg) return nullptr;
  if (without.withheld || without.drifts) return nullptr;
  const effect::Explanation& e = without.explanation;
  auto found = search.find({estimator_config(config).moving_mass_kg, e.final_stiffness_npm.value,
                            e.final_coulomb_n.value, velocity_rms_mps});
  return found ? std::make_shared<const OtherTruck>(std::move(*found)) : nullptr;
}

bool other_leaves_less(const Explained& with, const Explained& without) noexcept {
  constexpr double kLeastGain = 0.1;  // of the error that is left
  return with.explanation.final.held_out_nmse <
         (1.0 - kLeastGain) * without.explanation.final.held_out_nmse;
}

Explained explain_truck(const Config& config, const ExplainOptions& options) {
  const EstimatorConfig core = estimator_config(config);
  Reading reading{config, options, FrameNoise{core.sample_rate_hz, core.anti_alias},
                  std::make_unique<effect::Explainer>(), OtherTruckSearch{core.sample_rate_hz}};
  const auto listen = [&](const Sample& sample, const UpdateResult&, const effect::Diagnosis&) {
    reading.noise.take(sample);
  };
  const TruckPass pass = pass_of(config, options.source, {{}, {}, options.show_progress, listen});
  Explained out;
  out.identified = pass.run->finish(rate_of(*pass.feed, *pass.run), options.source.path);
  pass.feed->describe(pass.run->frames(), out.identified);
  out.circumstances = pass.run->circumstances();
  explain_pass(reading, pass, out);
  doubt_lateness(reading, pass, out);
  look_for_other(reading, pass, out);
  if (options.refine && shows_no_gain(config, options.source, out)) {
    out.needless.effect[static_cast<std::size_t>(effect::Effect::kGainError)] = true;
    explain_pass(reading, pass, out);
  }
  look_for_low_pass(config, options.source, reading.noise, out);
  effect::name_nothing_impossible(out.explanation);
  if (options.refine) refine(reading, pass, out);
  excuse_rate(config, late_of(out.explanation), out);
  take_misplaced(pass.run->view(), core.sample_rate_hz, out);
  std::uint32_t number = 0;
  for (const std::string& path : options.validation)
    out.validation.push_back(
        validate(config, {path, options.source.skip_bad_lines}, ++number, out, *reading.explainer));
  out.inputs = pass.feed->extra_inputs();
  out.inputs.insert(out.inputs.begin(), describe_record(options.source.path));
  for (const std::string& path : options.validation)
    out.inputs.push_back(describe_input(path, "validation"));
  out.sums = pass.run->statistics();
  return out;
}

}  // namespace dampline::app
