// SPDX-License-Identifier: MIT
#include "dampline/effect/rules.hpp"

#include <algorithm>
#include <cmath>

#include "dampline/numeric/mean_t.hpp"

namespace dampline::effect {
namespace {

constexpr double kClearGain = 0.05;   // passes with kLaterZ, or as the smaller one does
constexpr double kClearZ = 4.0;       // coefficient over deviation
constexpr double kSmallGain = 0.025;  // passes with kSignificant and kClearZ
constexpr double kSignificant = 2.0;
constexpr double kLeastGain = 0.003;  // passes with kVerySignificant
constexpr double kVerySignificant = 3.3;
constexpr double kLaterGain = 0.012;        // of a later effect, with kLaterT and kLaterZ
constexpr double kLaterSensorGain = 0.015;  // beside a law with memory
constexpr double kLaterMemoryGain = 0.035;
constexpr double kSkewBesideMemoryGain = 0.065;
constexpr double kLookalikeGain = 0.06;
constexpr double kFrameBesideBacklashGain = 0.20;
constexpr double kRateBesideBacklashGain = 0.10;  // of what depends on speed or time
constexpr double kMemoryBesideKinkGain = 0.10;
constexpr double kProductGain = 0.15;         // of springs beside two laws whose product is missing
constexpr double kGainBesideSkewGain = 0.10;  // of the same channel
constexpr double kLaterT = 3.5;
constexpr double kLaterZ = 10.0;
constexpr double kLaterClearT = 2.5;  // with kSmallGain and kLaterClearZ
constexpr double kLaterClearZ = 8.0;
constexpr double kSignZ = 2.0;   // of a sign
constexpr double kFaintZ = 4.2;  // with kFaintT
constexpr double kFaintT = 2.5;
constexpr double kFaintFrictionGain = 0.0015;  // with kFaintFrictionT and kFaintFrictionZ
constexpr double kFaintFrictionT = 1.5;
constexpr double kFaintFrictionZ = 12.0;
constexpr std::size_t kManyEntries = 16;  // of blocks, with which the rules were calibrated

template <class Test>
bool has_any(const Model& model, const Test& test) noexcept {
  return model.count_of([&](const Candidate& candidate) { return test(candidate.effect); }) > 0;
}

bool is_even_spring(Effect effect) noexcept {
  return effect == Effect::kQuadraticStiffness || effect == Effect::kAsymmetricStiffness;
}
bool is_bent_spring(Effect effect) noexcept {
  return effect == Effect::kBumpStop || effect == Effect::kCubicStiffness;
}

/// The gain that a later effect needs beside one that is in the model. What a late channel leaves,
/// in second order, looks like a mode or like friction that builds up, and its friction, which
/// leaps late, like a wrong gain of the same channel; friction that builds up to other levels in
/// each direction, like progressive friction or damping by direction. The deflection comes without
/// its mean, so that a stop or a curved spring is not seen from its centre and leaves something
/// even.
double gain_beside(const Candidate& beside, const Candidate& candidate) noexcept {
  const Effect known = beside.effect;
  const Effect effect = candidate.effect;
  if (known == Effect::kTimeSkew && effect == Effect::kTimeSkew) return kLookalikeGain;
  // A late channel that was set right leaves nothing.
  if (beside.count == 0) return has_memory(effect) ? kLaterMemoryGain : kLaterGain;
  const bool one_channel = known == Effect::kTimeSkew && beside.form == candidate.form;
  if (one_channel && effect == Effect::kGainError) return kGainBesideSkewGain;
  if (known == Effect::kTimeSkew && (effect == Effect::kUnmodelledMode || has_memory(effect)))
    return kLookalikeGain;
  if (is_bent_spring(known) && is_even_spring(effect)) return kLaterMemoryGain;
  if (is_even_spring(known) && is_bent_spring(effect)) return kLookalikeGain;
  // Where its kink is moves with the size of the motion.
  if (is_even_spring(known) && has_memory(effect)) return kMemoryBesideKinkGain;
  if (has_memory(effect)) return kLaterMemoryGain;
  if (known == Effect::kUnmodelledMode && effect == Effect::kGainError) return kLaterMemoryGain;
  if (!has_memory(known)) return kLaterGain;
  // What takes up a gap yields: its force comes later than the library's, like a late frame's, and
  // over some time.
  const bool yields = known == Effect::kBacklash;
  if (yields && (is_damping(effect) || effect == Effect::kStribeck)) return kRateBesideBacklashGain;
  if (effect == Effect::kTimeSkew)
    return yields && candidate.form == kFrameForm ? kFrameBesideBacklashGain
                                                  : kSkewBesideMemoryGain;
  const bool directed =
      effect == Effect::kProgressiveFriction || effect == Effect::kAsymmetricViscous;
  return directed ? kLaterMemoryGain : kLaterSensorGain;
}

/// Friction that builds up to a level which itself grows with the deflection: the model has their
/// sum, and what their product adds to it is even in the deflection.
bool lacks_product(const Model& model) noexcept {
  return has_any(model, has_memory) &&
         has_any(model, [](Effect effect) { return effect == Effect::kProgressiveFriction; });
}

/// Two late channels that were set right share what the third is off by between them, and friction
/// that builds up takes what that leaves.
bool are_two_set_right(const Model& model) noexcept {
  return model.count_of(
             [](const Candidate& c) { return c.effect == Effect::kTimeSkew && c.count == 0; }) > 1;
}

double later_gain(const Model& model, const Candidate& candidate) noexcept {
  const bool springs = is_even_spring(candidate.effect) || is_bent_spring(candidate.effect);
  double gain = springs && lacks_product(model) ? kProductGain : kLaterGain;
  if (has_memory(candidate.effect) && are_two_set_right(model)) gain = kLookalikeGain;
  for (std::size_t i = 0; i < model.count; ++i)
    gain = std::max(gain, gain_beside(model.effect[i], candidate));
  return gain;
}

/// What the grid of lengths and the velocity's phase leave of a law with memory looks like a late
/// frame, and other effects may be less than that.
bool is_late_memory(const Model& model, Effect effect) noexcept {
  return effect == Effect::kTimeSkew && has_any(model, has_memory);
}

bool passes_later(const Step& step, double gain) noexcept {
  if (step.gain <= gain) return false;
  // Stops are seldom reached: few blocks gain.
  const double enough = is_bent_spring(step.chosen.effect) ? kSignificant : kLaterClearT;
  const bool clear = step.gain > kClearGain || (step.gain > kSmallGain && step.block_t > enough);
  return clear ? step.coefficient_t > kLaterClearZ
               : step.coefficient_t > kLaterZ && step.block_t > kLaterT;
}

/// Small errors of the velocity's phase look like a time skew, so that needs a larger gain. What
/// few blocks gain is certain only where the coefficient is.
bool passes_first(const Step& step) noexcept {
  const bool in_blocks = step.block_t > kSignificant && step.coefficient_t > kClearZ;
  if (step.gain > kClearGain && (in_blocks || step.coefficient_t > kLaterZ)) return true;
  if (step.gain > kSmallGain && in_blocks) return true;
  return step.chosen.effect != Effect::kTimeSkew && step.gain > kLeastGain &&
         step.block_t > kVerySignificant;
}

/// A spring that bends: small beside what sensors and the law's width leave where the truck hardly
/// reaches its curve, yet sure. What else is so small may be an imperfection: channels and modes
/// fit many things, and stops a few values.
bool is_faint(const Step& step) noexcept {
  const Effect e = step.chosen.effect;
  const bool spring = e == Effect::kCubicStiffness || e == Effect::kQuadraticStiffness ||
                      e == Effect::kAsymmetricStiffness;
  return spring && step.gain > 0.0 && step.block_t > kFaintT && step.coefficient_t > kFaintZ;
}

/// Friction that falls with speed, where the velocity's error, which looks like it, is far less
/// sure of itself: z to 4 on clean records.
bool is_faint_friction(const Step& step) noexcept {
  return step.chosen.effect == Effect::kStribeck && step.gain > kFaintFrictionGain &&
         step.block_t > kFaintFrictionT && step.coefficient_t > kFaintFrictionZ;
}

/// The normal deviate that is as rare as Student's t (Wallace 1959, Bounds on normal
/// approximations).
double as_normal(double t, double freedom) noexcept {
  const double z = std::sqrt(freedom * std::log1p(t * t / freedom));
  return std::copysign((8.0 * freedom + 1.0) / (8.0 * freedom + 3.0) * z, t);
}

}  // namespace

double block_t(const ModelFit& before, const ModelFit& after, std::size_t entries) noexcept {
  MeanT gain;
  for (std::size_t e = 0; e < entries; ++e)
    gain.add(before.held_out_error[e] - after.held_out_error[e]);
  return entries < kManyEntries ? as_normal(gain.t(), gain.count() - 1.0) : gain.t();
}

double coefficient_t(const ModelFit& fit, const ModelFit& before) noexcept {
  const int i = before.terms;
  return std::abs(fit.theta[i]) / std::sqrt(std::max(fit.covariance(i, i), 1e-300));
}

bool has_room(const Model& model, const Candidate& candidate, bool two_late) noexcept {
  std::size_t same = 0;
  for (std::size_t i = 0; i < model.count; ++i) {
    const Candidate& known = model.effect[i];
    if (known.effect != candidate.effect) continue;
    if (candidate.effect != Effect::kTimeSkew || known.form == candidate.form) return false;
    ++same;
  }
  return same < (two_late ? 2U : 1U);
}

bool is_plausible(const Candidate& candidate, const ModelFit& fit, int term) noexcept {
  const double theta = fit.theta[term];
  if (candidate.sign * theta < 0.0) return false;
  if (is_pair(candidate) && candidate.sign * fit.theta[term + 1] < 0.0) return false;
  if (candidate.effect == Effect::kAsymmetricViscous) {
    // c+ and c- : theta_v +- theta_|v|
    return fit.theta[term + 1] > std::abs(theta);
  }
  return true;
}

bool is_plausible(const Model& model, const ModelFit& fit) noexcept {
  for (std::size_t i = 0; i < model.count; ++i) {
    const Candidate& known = model.effect[i];
    if (known.count == 0) continue;
    const int term = ModelFit::first_of(model, i);
    const bool both = known.effect == Effect::kAsymmetricViscous;
    const int at = both ? term + 1 : term;
    const double against =
        both ? std::abs(fit.theta[term]) - fit.theta[at] : -known.sign * fit.theta[at];
    if (against > kSignZ * std::sqrt(std::max(fit.covariance(at, at), 0.0))) return false;
  }
  return true;
}

bool is_kink_of_spring(const Model& model, const Candidate& candidate,
                       const Grids& grids) noexcept {
  return candidate.effect == Effect::kBumpStop && grids.bump_gap[candidate.variant] < kKinkWithin &&
         has_any(model, is_even_spring);
}

Verdict judge_step(const Model& model, bool first, bool best, const Step& step) noexcept {
  if (first) {
    const bool joins = passes_first(step) || is_faint_friction(step) || is_faint(step);
    return best && joins ? Verdict::kYes : Verdict::kNo;
  }
  if (passes_later(step, later_gain(model, step.chosen))) return Verdict::kYes;
  // The best is but an imperfection of what is in the model: so may be all that explain less.
  const bool hides = passes_later(step, kLaterGain) && !is_late_memory(model, step.chosen.effect);
  return hides ? Verdict::kStop : Verdict::kNo;
}

}  // namespace dampline::effect
