// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/looks.hpp"

#include <cmath>
#include <filesystem>
#include <memory>

#include "app/diagnosis/common/evidence.hpp"
#include "app/diagnosis/truck/law.hpp"
#include "app/diagnosis/truck/pass.hpp"
#include "app/diagnosis/truck/points.hpp"
#include "app/diagnosis/truck/surrogates.hpp"
#include "app/diagnosis/truck/verdict.hpp"

namespace dampline::app {

namespace {

constexpr double kLeastTurn = 0.05;  // of the deflection's rms: smaller ones are noise
constexpr double kLawReach = 2.5;    // of the velocity's rms

EvidenceScale scale_of(const EstimatorConfig& core, const TruckPass& first) {
  const double deflection_m = first.diagnosis().deflection_rms_m();
  return {deflection_m, first.diagnosis().velocity_rms_mps(), kLeastTurn * deflection_m,
          core.sample_rate_hz, first.run->time_s()};
}

/// The record again, with the surrogates.
void read_again(const Config& config, const ExplainOptions& options, const EstimatorConfig& core,
                const TruckPass& first, Surrogates* surrogates, OtherTruckSearch& search,
                Explained& out) {
  EvidenceMeter meter{scale_of(core, first)};
  const auto look = [&](const EvidencePoint& p) {
    meter.add(p);
    search.add(p);
  };
  search.clear();
  TruckPoints points{
      core.sample_rate_hz, core.moving_mass_kg, out.explanation, {look, [&] { meter.gap(); }}};
  TruckPassOptions again{
      out.explanation.grids, out.lateness, options.show_progress, {}, out.other.get()};
  again.watch = [&](const Sample& sample, const UpdateResult& result,
                    const effect::Diagnosis& diagnosis) {
    search.take(sample);
    points.take(sample, result, diagnosis);
    if (surrogates != nullptr) surrogates->take(sample);
  };
  const TruckPass pass = pass_of(config, options.source, again);
  Evidence& evidence = out.identified.evidence;
  evidence = {};
  meter.fill(evidence);
  evidence.law = truck_law(out.explanation, core.moving_mass_kg,
                           kLawReach * first.diagnosis().velocity_rms_mps());
  out.signature = meter.signature();
  out.convergence =
      convergence_of(out.explanation, pass.diagnosis().store(), out.identified.duration_s);
}

}  // namespace

bool can_read_again(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) ||
         std::filesystem::is_directory(path, ignored);
}

bool look_again(const Config& config, const ExplainOptions& options, const TruckPass& first,
                const FrameNoise& noise, effect::Explainer& explainer, Explained& out,
                OtherTruckSearch& search) {
  if (!can_read_again(options.source.path)) return true;
  EstimatorConfig core = estimator_config(config);
  core.screen = first.run->config().estimator.screen;
  const RecordNoise seen =
      noise_of_record(guarded_noise(first.run->core()), noise, core.screen.step_mps2);
  const auto surrogates = std::make_unique<Surrogates>();
  surrogates->begin(core, surrogate_config(core, out.explanation, seen), out.explanation);
  read_again(config, options, core, first, surrogates.get(), search, out);
  surrogates->finish();
  return surrogates->hold_against(explainer, 0.0, out);
}

namespace {

constexpr int kRounds = 3;
constexpr double kEnoughS = 20e-6;  // of a channel's lateness
constexpr double kSettled = 0.998;  // of the error of the round before

/// The late channels among an explanation's steps, as columns.
effect::Model late_channels(const effect::Explanation& e) noexcept {
  effect::Model out;
  for (const effect::Step& step : e.steps())
    if (is_late(step)) out = out.with(step.chosen);
  return out;
}

ChannelLateness values_of(const LateEstimates& late_s) noexcept {
  ChannelLateness out{};
  for (std::size_t c = 0; c < kChannels; ++c) out[c] = late_s[c].value;
  return out;
}

void set_late(effect::Explanation& e, const LateEstimates& late_s) noexcept {
  for (effect::Step& step : e.steps())
    if (is_late(step)) step.parameter[0].estimate = late_s[step.chosen.form];
}

/// One reading more.
class CloserLook {
 public:
  CloserLook(const Config& config, const ExplainOptions& options, const TruckPass& first,
             const FrameNoise& noise, effect::Explainer& explainer)
      : config_{config}, options_{options}, core_{estimator_config(config)}, explainer_{explainer} {
    core_.screen = first.run->config().estimator.screen;
    noise_ = noise_of_record(guarded_noise(first.run->core()), noise, core_.screen.step_mps2);
  }

  /// Explains with these grids and channels set right; `left`: how late they still are.
  effect::Explanation explain(const Explained& known, const effect::Grids& grids,
                              const ChannelLateness& lateness, LateEstimates& left) {
    TruckPassOptions reading{grids, lateness, options_.show_progress, {}, known.other.get()};
    const effect::SurrogateConfig law =
        with_found(surrogate_config(core_, known.explanation, noise_), known.explanation);
    const bool late = late_channels(known.explanation).count > 0;
    std::unique_ptr<SurrogatePass> surrogate;
    if (late && is_physical(law)) surrogate = std::make_unique<SurrogatePass>(core_, law, grids);
    reading.watch = [&](const Sample& sample, const UpdateResult&, const effect::Diagnosis&) {
      if (surrogate) surrogate->take(sample);
    };
    const TruckPass pass = pass_of(config_, options_.source, reading);
    effect::ExplainerConfig wanted = explainer_config(config_, known);
    wanted.known = &known.explanation;
    effect::Explanation out = explainer_.explain(pass.diagnosis(), wanted);
    if (late_channels(out).count > 0) left = lateness_left(pass.diagnosis(), surrogate.get(), out);
    return out;
  }

 private:
  /// Errors of the velocity's phase look like lateness, too, and do so on the surrogate.
  LateEstimates lateness_left(const effect::Diagnosis& diagnosis, SurrogatePass* surrogate,
                              const effect::Explanation& e) {
    const effect::Model late = late_channels(e);
    LateEstimates out = explainer_.lateness(diagnosis, e.model, late);
    if (surrogate == nullptr) return out;
    surrogate->finish();
    const LateEstimates bias =
        explainer_.lateness(surrogate->diagnosis(), effect::law_part(e), late);
    for (std::size_t c = 0; c < kChannels; ++c)
      out[c] = {out[c].value - bias[c].value, std::hypot(out[c].std, bias[c].std)};
    return out;
  }

  const Config& config_;
  const ExplainOptions& options_;
  EstimatorConfig core_;
  effect::Explainer& explainer_;
  RecordNoise noise_;
};

/// A column for a lateness of less than some 1.1 ms takes more of the error than a channel that is
/// set right, and tells a fifth too little of it. It stays in the model; how late the channel is
/// comes from the closer look, and friction and spring are as uncertain as the two are apart.
void correct_lateness(const effect::Explanation& closer, effect::Explanation& e) {
  set_late(e, late_of(closer));
  const auto widen = [](const Estimate& other, Estimate& one) {
    one.std = std::hypot(one.std, one.value - other.value);
  };
  widen(closer.final_coulomb_n, e.final_coulomb_n);
  widen(closer.final_stiffness_npm, e.final_stiffness_npm);
}

/// False: it stays as it was.
bool look_closer(CloserLook& look, Explained& out) {
  Explained now = out;
  const bool late = late_channels(out.explanation).count > 0;
  ChannelLateness lateness = values_of(late_of(out.explanation));
  bool set_right = !late;
  for (int round = 0; round < kRounds; ++round) {
    effect::Grids grids;
    const bool has_grids = effect::draw_together(now.explanation, round, grids);
    if (!late && !has_grids) return false;
    const double before = now.explanation.final.held_out_nmse;
    LateEstimates left{};
    now.explanation = look.explain(now, grids, lateness, left);
    if (!now.explanation.final.ok) return false;
    now.lateness = lateness;
    set_right = true;
    for (std::size_t c = 0; c < kChannels; ++c) {
      lateness[c] += left[c].value;
      set_right = set_right && std::abs(left[c].value) < kEnoughS;
      left[c] = {lateness[c], std::hypot(left[c].std, kEnoughS)};
    }
    set_late(now.explanation, left);
    const bool settled = now.explanation.final.held_out_nmse > kSettled * before;
    if (set_right && (!has_grids || (round > 0 && settled))) break;
  }
  const double limit = (late ? out.explanation.base : out.explanation.final).held_out_nmse;
  if (!(kSettled * now.explanation.final.held_out_nmse < limit)) {
    if (late && set_right) correct_lateness(now.explanation, out.explanation);
    return false;
  }
  out.explanation = now.explanation;
  out.lateness = now.lateness;
  return true;
}

}  // namespace

void look_closer(const Config& config, const ExplainOptions& options, const TruckPass& first,
                 const FrameNoise& noise, effect::Explainer& explainer, Explained& out) {
  if (!can_read_again(options.source.path)) return;
  CloserLook look{config, options, first, noise, explainer};
  Explained kinked = out;
  const bool may_be_kink = effect::as_kink(kinked.explanation);
  look_closer(look, out);
  if (may_be_kink && look_closer(look, kinked) &&
      kinked.explanation.final.held_out_nmse < out.explanation.final.held_out_nmse)
    out = std::move(kinked);
}

}  // namespace dampline::app
