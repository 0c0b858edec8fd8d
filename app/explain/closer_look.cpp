// SPDX-License-Identifier: MIT
#include "app/explain/closer_look.hpp"

#include <cmath>

#include "app/explain/second_look.hpp"
#include "app/explain/truck_verdict.hpp"
#include "app/explain/twin_pass.hpp"

namespace dampline::app {
namespace {

constexpr int kRounds = 3;
constexpr double kEnoughS = 20e-6;  // of a channel's lateness
constexpr double kSettled = 0.998;  // of the error of the round before

/// The late channel among an explanation's steps, or null.
const effect::Step* late_step(const effect::Explanation& e) {
  for (std::size_t i = 0; i < e.step_count; ++i)
    if (e.step[i].chosen.effect == effect::Effect::kTimeSkew) return &e.step[i];
  return nullptr;
}

void set_late(effect::Explanation& e, const Estimate& late_s) {
  for (std::size_t i = 0; i < e.step_count; ++i)
    if (e.step[i].chosen.effect == effect::Effect::kTimeSkew)
      e.step[i].parameter[0].estimate = late_s;
}

/// One reading more.
class CloserLook {
 public:
  CloserLook(const Config& config, const ExplainOptions& options, const TruckPass& first,
             const FrameNoise& noise, effect::Explainer& explainer)
      : config_{config}, options_{options}, core_{estimator_config(config)}, explainer_{explainer} {
    core_.screen = first.run->config().estimator.screen;
    noise_mps2_ = noise_of_record(first, noise, core_.screen.step_mps2);
  }

  /// Explains with these grids and a channel set right; `left`: how late it still is.
  effect::Explanation explain(const Explained& known, const effect::Grids& grids,
                              const LateChannel& lateness, Estimate& left) {
    TruckPassOptions reading{grids, lateness, options_.show_progress, {}};
    const TwinConfig law =
        with_memory(twin_config(core_, known.explanation, noise_mps2_), known.explanation);
    const bool late = late_step(known.explanation) != nullptr;
    std::unique_ptr<TwinPass> twin;
    if (late && is_physical(law)) twin = std::make_unique<TwinPass>(core_, law, grids);
    reading.watch = [&](const Sample& sample, const UpdateResult&, const effect::Diagnosis&) {
      if (twin) twin->take(sample);
    };
    const TruckPass pass = pass_of(config_, options_.source, reading);
    effect::ExplainerConfig wanted = explainer_config(config_, known);
    wanted.known = &known.explanation;
    effect::Explanation out = explainer_.explain(pass.diagnosis(), wanted);
    if (late) left = lateness_left(pass.diagnosis(), twin.get(), out);
    return out;
  }

 private:
  /// Errors of the velocity's phase look like lateness, too, and do so on the twin.
  Estimate lateness_left(const effect::Diagnosis& diagnosis, TwinPass* twin,
                         const effect::Explanation& e) {
    const effect::Candidate& skew = late_step(e)->chosen;
    Estimate out = explainer_.lateness(diagnosis, e.model, skew);
    if (twin == nullptr) return out;
    const Estimate bias = explainer_.lateness(twin->finish(), effect::remembering_part(e), skew);
    return {out.value - bias.value, std::hypot(out.std, bias.std)};
  }

  const Config& config_;
  const ExplainOptions& options_;
  EstimatorConfig core_;
  effect::Explainer& explainer_;
  std::array<double, kChannels> noise_mps2_{};
};

}  // namespace

void look_closer(const Config& config, const ExplainOptions& options, const TruckPass& first,
                 const FrameNoise& noise, effect::Explainer& explainer, Explained& out) {
  if (!can_read_again(options.source.path)) return;
  CloserLook look{config, options, first, noise, explainer};
  Explained now = out;
  LateChannel lateness;
  const effect::Step* const late = late_step(out.explanation);
  if (late != nullptr) lateness = {late->chosen.form, late->parameter[0].estimate.value};
  for (int round = 0; round < kRounds; ++round) {
    effect::Grids grids;
    const bool has_grids = effect::draw_together(now.explanation, round, grids);
    if (late == nullptr && !has_grids) return;
    const double before = now.explanation.final.held_out_nmse;
    Estimate left;
    now.explanation = look.explain(now, grids, lateness, left);
    if (!now.explanation.final.ok) return;
    now.lateness = lateness;
    lateness.late_s += left.value;
    if (late != nullptr) set_late(now.explanation, {lateness.late_s, left.std});
    const bool settled = now.explanation.final.held_out_nmse > kSettled * before;
    const bool set_right = late == nullptr || std::abs(left.value) < kEnoughS;
    if (set_right && (!has_grids || (round > 0 && settled))) break;
  }
  const double limit =
      (late != nullptr ? out.explanation.base : out.explanation.final).held_out_nmse;
  if (!(kSettled * now.explanation.final.held_out_nmse < limit)) return;
  out.explanation = now.explanation;
  out.lateness = now.lateness;
}

}  // namespace dampline::app
