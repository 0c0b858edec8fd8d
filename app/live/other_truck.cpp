// SPDX-License-Identifier: MIT
#include "app/live/other_truck.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "app/diagnosis/truck/low_pass.hpp"
#include "app/diagnosis/truck/points.hpp"
#include "app/diagnosis/truck/verdict.hpp"

namespace dampline::app {

bool judge_live(const effect::Sums& sums, const LiveKnown& known, LiveFloor& floor,
                effect::Explainer& explainer, Explained& out) {
  while (true) {
    effect::judge(sums, explainer_config(known.config, out), out.circumstances, explainer, out);
    if (out.explanation.conclusion == effect::Conclusion::kNotReady) return false;
    if (!floor.hold_against(sums.store, known.guarded, explainer, out)) continue;
    hold_back(out);
    if (!take_needless(out.explanation, out.needless)) break;
  }
  look_for_frame_low_pass(known.config, floor.noise(), out);
  effect::name_nothing_impossible(out.explanation);
  return true;
}

namespace {

/// Sees what a run through the diagnosis makes of each sample.
template <class Watch>
struct Observer {
  const DiagnosisRun& run;
  Watch& watch;
  void taken(const Sample& /*unused*/) const noexcept {}
  void judged(const Sample& sample, const UpdateResult& result) {
    watch(sample, result, run.effects());
  }
};

/// Samples that were kept, through the diagnosis once more.
template <class Watch>
std::unique_ptr<DiagnosisRun> run_of(const IdentifierConfig& core, const effect::Grids& grids,
                                     const std::vector<Sample>& samples, Watch watch) {
  auto run = std::make_unique<DiagnosisRun>(core, grids);
  Observer<Watch> observer{*run, watch};
  for (const Sample& sample : samples) run->push(sample, observer);
  run->finish();
  return run;
}

/// The run's circumstances, and nothing found yet.
Explained about(const Explained& run) {
  Explained out;
  out.circumstances = run.circumstances;
  out.identified = run.identified;
  return out;
}

}  // namespace

std::optional<Explained> LiveOther::find(const LiveKnown& known, const std::vector<Sample>& samples,
                                         effect::Explainer& explainer, const Explained& run) const {
  const double rate_hz = core_.estimator.sample_rate_hz;
  OtherTruckSearch search{rate_hz};
  TruckPoints points{rate_hz,
                     core_.estimator.moving_mass_kg,
                     run.explanation,
                     {[&](const EvidencePoint& p) { search.add(p); }, {}}};
  const auto first = run_of(
      core_, run.explanation.grids, samples,
      [&](const Sample& sample, const UpdateResult& result, const effect::Diagnosis& diagnosis) {
        search.take(sample);
        points.take(sample, result, diagnosis);
      });
  Explained with = about(run);
  with.other = other_in(known.config, search, first->effects().velocity_rms_mps(), run);
  if (!with.other) return std::nullopt;
  LiveFloor floor{core_.estimator};
  for (const Sample& sample : samples) floor.follow(sample);
  Explained without = about(run);
  if (!judge_live(first->effects().sums(), known, floor, explainer, without)) return std::nullopt;
  with.without_other_nmse = base_error(without.explanation);
  IdentifierConfig core = core_;
  core.estimator.far_mass_kg = with.other->mass_kg.value;
  std::vector<Sample> beside;
  beside.reserve(samples.size());
  for (const Sample& sample : samples) beside.push_back(with.other->beside(sample));
  const auto second = run_of(core, {}, beside, [](const auto&...) {});
  floor.forget();
  if (!judge_live(second->effects().sums(), known, floor, explainer, with)) return std::nullopt;
  return other_leaves_less(with, without) ? std::optional{std::move(with)} : std::nullopt;
}

double LiveOther::look(const LiveKnown& known, const LiveFloor& kept, double time_s,
                       effect::Explainer& explainer, Explained& out) {
  if (time_s >= next_s_) {
    looked_s_ = time_s;
    next_s_ = time_s + std::max(kEveryS, std::min(time_s, LiveFloor::kKeptS) / 2.0);
    with_ = find(known, kept.kept(), explainer, out);
  }
  if (!with_ || out.withheld || out.drifts) return time_s;
  Explained with = *with_;
  with.circumstances = out.circumstances;
  with.identified = std::move(out.identified);
  out = std::move(with);
  return looked_s_;
}

}  // namespace dampline::app
