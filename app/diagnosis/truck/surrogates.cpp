// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/surrogates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dampline::app {
namespace {

constexpr double kOneKind = 3.0;      // of powers of noise
constexpr double kNoiseDoubt = 1.25;  // of the guards' median, which bursts do not lift
// Of the floor, where it is known less well than elsewhere: what is unexplained.
constexpr double kThinnedAbove = 1.35;
constexpr double kFoldedAbove = 1.6;
constexpr double kMuchFolded = 0.38;  // a corner, of the rate

double rounding(double step_mps2) { return step_mps2 * step_mps2 / 12.0; }  // mean square

/// What the wheelsets do not share counts as their noise, and aliasing adds to it. Where sensors
/// may be of one kind, the frame's noise, which is measured apart from its motion, is that of all.
std::array<double, kChannels> noise_of(std::array<double, kChannels> seen_mps2,
                                       const std::array<double, kChannels>& step_mps2) {
  const double frame = seen_mps2[0] * seen_mps2[0] - rounding(step_mps2[0]);
  for (std::size_t c = 1; c < kChannels; ++c) {
    const double own = seen_mps2[c] * seen_mps2[c] - rounding(step_mps2[c]);
    if (frame > 0.0 && own < kOneKind * frame)
      seen_mps2[c] = std::sqrt(frame + rounding(step_mps2[c]));
  }
  return seen_mps2;
}

/// Noise of a frame where leaps of friction fill the band that should tell it, as behind a low pass
/// that is open up to half the rate: that of wheelsets' sensors of the same kind.
double frame_of_their_kind(const std::array<double, kChannels>& seen_mps2,
                           const std::array<double, kChannels>& step_mps2) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t c = 1; c < kChannels; ++c) {
    const double white = seen_mps2[c] * seen_mps2[c] - rounding(step_mps2[c]);
    least = std::min(least, std::max(white, 0.0));
  }
  return std::sqrt(least + rounding(step_mps2[0]));
}

/// How far above its floor a sound record may be.
double unexplained_above(const EstimatorConfig& core) {
  const AntiAliasConfig seen = ReferenceLowPass::seen_behind(core.anti_alias);
  if (seen.thinned) return kThinnedAbove;
  return seen.corner_hz > kMuchFolded * core.sample_rate_hz ? kFoldedAbove
                                                            : effect::kUnexplainedAbove;
}

}  // namespace

RecordNoise noise_of_record(const GuardedNoise& guarded, const FrameNoise& frame,
                            const std::array<double, kChannels>& step_mps2) {
  const auto of_sensor = [&](double seen_mps2, std::size_t c) {
    const double added = guarded.bridged.noise_mps2[c];
    return added > 0.0 ? std::sqrt(std::max(seen_mps2 * seen_mps2 - added * added, 0.0))
                       : seen_mps2;
  };
  std::array<double, kChannels> seen{};
  for (std::size_t c = 0; c < kChannels; ++c) seen[c] = of_sensor(guarded.seen_mps2[c], c);
  const double whole = of_sensor(frame.noise_mps2(), 0);
  if (seen[0] > 0.0 && whole > 0.0)
    seen[0] = std::clamp(whole, seen[0] / kNoiseDoubt, kNoiseDoubt * seen[0]);
  if (seen[0] == 0.0 && whole == 0.0) seen[0] = frame_of_their_kind(seen, step_mps2);
  return {noise_of(seen, step_mps2), guarded.bridged.error_mps2};
}

effect::SurrogateConfig surrogate_config(const EstimatorConfig& core, const effect::Explanation& e,
                                         const RecordNoise& noise) {
  effect::SurrogateConfig out;
  out.sample_rate_hz = core.sample_rate_hz;
  out.stiffness_per_s2 = e.final.theta[effect::ModelFit::kStiffness];
  const double mass_kg = e.final_stiffness_npm.value / out.stiffness_per_s2;
  out.coulomb_mps2 = e.final_coulomb_n.value / mass_kg;
  if (e.base_count > 0)
    out.viscous_per_s = std::max(e.final.theta[effect::ModelFit::kFirstEffect], 0.0);
  out.input_low_pass_hz = 0.5 * (core.anti_alias.of(1).corner_hz + core.anti_alias.of(2).corner_hz);
  out.low_pass_hz = ReferenceLowPass::seen_behind(core.anti_alias).corner_hz;
  out.noise_mps2 = noise.sensors_mps2;
  out.bridged_mps2 = noise.bridged_mps2;
  out.step_mps2 = core.screen.step_mps2;
  return out;
}

namespace {

/// Parameters of a step, per unit of mass.
struct Parts {
  const effect::Step& step;
  const effect::Grids& grids;
  double mass_kg;
  [[nodiscard]] double plain(std::size_t i) const { return step.parameter[i].estimate.value; }
  [[nodiscard]] double force(std::size_t i) const { return plain(i) / mass_kg; }
};

/// `coulomb_mps2`: of all friction, with memory or without.
void add(const Parts& p, double coulomb_mps2, effect::SurrogateConfig& out) {
  using effect::Effect;
  effect::FoundForce& found = out.found;
  const Effect kind = p.step.chosen.effect;
  const auto form = p.step.chosen.form;
  switch (kind) {
    case Effect::kPreslidingHysteresis:
    case Effect::kBacklash:
      if (out.memory.force_mps2 > 0.0) return;
      out.memory = {kind == Effect::kBacklash, p.force(0), p.plain(1)};
      if (out.memory.is_play) out.memory.width_mps = effect::play_of(p.step, p.grids).width_mps;
      out.coulomb_mps2 = std::max(out.coulomb_mps2 - out.memory.force_mps2, 0.0);
      return;
    case Effect::kViscous:
    case Effect::kAsymmetricViscous:
      found.viscous_up_per_s = p.force(0);
      found.viscous_down_per_s = p.force(p.step.parameter_count - 1);
      return;
    case Effect::kQuadraticDamping:
      found.quadratic_per_m = p.force(0);
      return;
    case Effect::kViscoelastic:
      found.relaxing_per_s2 = p.force(0);
      found.relaxing_s = p.plain(1);
      return;
    case Effect::kProgressiveFriction:
      (form == effect::kAbsoluteForm ? found.widens_per_m : found.grows_per_m) = 1.0 / p.plain(0);
      return;
    case Effect::kStribeck:
      found.falls_mps2 = p.plain(0) * coulomb_mps2;
      found.falls_over_mps = p.plain(1);
      return;
    case Effect::kCubicStiffness:
      found.cube_per_m2_s2 = p.force(0);
      return;
    case Effect::kQuadraticStiffness:
      found.square_per_m_s2 = p.force(0);
      return;
    case Effect::kAsymmetricStiffness:
      found.magnitude_per_s2 = 0.5 * p.force(0);
      return;
    case Effect::kBumpStop:
      if (form != effect::kOneSidedDown) found.stop_up_per_s2 = p.force(0);
      if (form != effect::kOneSidedUp) found.stop_down_per_s2 = p.force(0);
      found.stop_m = p.plain(1);
      return;
    default:
      return;
  }
}

}  // namespace

effect::SurrogateConfig with_found(effect::SurrogateConfig out, const effect::Explanation& e) {
  const double coulomb_mps2 = out.coulomb_mps2;
  const double mass_kg = e.final_coulomb_n.value / coulomb_mps2;
  for (const effect::Step& step : e.steps()) add({step, e.grids, mass_kg}, coulomb_mps2, out);
  return out;
}

bool is_physical(const effect::SurrogateConfig& c) {
  return c.stiffness_per_s2 > 0.0 && c.coulomb_mps2 > 0.0 && c.viscous_per_s >= 0.0;
}

namespace {

/// A law that no truck has, or one whose floor cannot be had, whatever it leaves.
void explains_nothing(effect::Explanation& e) {
  e.conclusion =
      e.step_count > 0 ? effect::Conclusion::kPartlyExplained : effect::Conclusion::kUnexplained;
}

/// A surrogate shows an effect that is none. What it hid is of the law: channels and modes fit many
/// small things.
void take_shown(effect::Effect shown, Needless& needless) {
  for (std::size_t i = 0; i < effect::kEffects; ++i) {
    const auto each = static_cast<effect::Effect>(i);
    if (each == shown || !effect::is_of_law(each)) needless.effect[i] = true;
  }
}

}  // namespace

void Surrogates::begin(const EstimatorConfig& core, const effect::SurrogateConfig& declared,
                       const effect::Explanation& e) {
  for (auto& pass : passes_) pass.reset();
  unexplained_above_ = unexplained_above(core);
  if (!is_physical(declared)) return;
  effect::SurrogateConfig second = with_found(declared, e);
  finds_ = second.memory.force_mps2 > 0.0 || second.found != effect::FoundForce{};
  ++second.seed;
  passes_[0].emplace(core, declared, e.grids);
  passes_[1].emplace(core, second, e.grids);
}

bool Surrogates::hold_against(effect::Explainer& explainer, double rows, Explained& out) const {
  effect::Explanation& e = out.explanation;
  if (!passes_[0]) {
    explains_nothing(e);
    return true;
  }
  const std::size_t steps = e.step_count;
  const effect::Effect first_effect = e.step[0].chosen.effect;
  const auto conclusion = e.conclusion;
  const effect::Diagnosis& first = passes_[0]->diagnosis();
  const effect::Diagnosis* const second = &passes_[1]->diagnosis();
  effect::Explainer::Surrogates surrogates{first, finds_ ? nullptr : second,
                                           finds_ ? second : nullptr};
  if (rows > 0.0) surrogates.share = first.store().rows() / rows;
  surrogates.unexplained_above = unexplained_above_;
  const bool judged = explainer.apply_floor(surrogates, out.identified.faults.impacts, e);
  if (!judged && steps > 0) explains_nothing(e);
  if (out.withheld || out.drifts) e.conclusion = conclusion;
  if (e.step_count == steps) return true;
  take_shown(first_effect, out.needless);
  return false;
}

}  // namespace dampline::app
