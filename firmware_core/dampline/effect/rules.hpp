// SPDX-License-Identifier: MIT
#pragma once
#include "dampline/effect/conclusion.hpp"

namespace dampline::effect {

/// Mean over deviation of the mean of the entries' improvements from one model to another; of few
/// entries the normal deviate that is as rare.
[[nodiscard]] double block_t(const ModelFit& before, const ModelFit& after,
                             std::size_t entries) noexcept;
/// The first coefficient that a model has beyond another's, over its deviation.
[[nodiscard]] double coefficient_t(const ModelFit& fit, const ModelFit& before) noexcept;

/// Whether a model may take a candidate: each effect once, but two channels may be late beside the
/// third where `two_late`.
[[nodiscard]] bool has_room(const Model& model, const Candidate& candidate, bool two_late) noexcept;
/// A force that takes energy by the speed, at once or over some time.
[[nodiscard]] constexpr bool is_damping(Effect effect) noexcept {
  return effect == Effect::kViscous || effect == Effect::kAsymmetricViscous ||
         effect == Effect::kQuadraticDamping || effect == Effect::kViscoelastic;
}
/// Signs that physics asks for: of the effect's first coefficient, the `term`-th of the fit, and
/// friction that does not drive.
[[nodiscard]] bool is_plausible(const Candidate& candidate, const ModelFit& fit, int term) noexcept;
/// The same of every effect in a model, as far as its sign is sure: what joins must not turn it.
[[nodiscard]] bool is_plausible(const Model& model, const ModelFit& fit) noexcept;
/// A stop within the motion's own size, beside a spring that differs by direction: the deflection
/// comes without its mean, and the spring bends elsewhere.
[[nodiscard]] bool is_kink_of_spring(const Model& model, const Candidate& candidate,
                                     const Grids& grids) noexcept;

/// What becomes of a candidate: it joins the model, the next best is looked at, or nothing does.
enum class Verdict : std::uint8_t { kYes, kNo, kStop };

/// What a candidate must bring to join a model. The first effect is judged by gain and significance
/// together, and only the best is looked at but for springs that bend; a later one by what the
/// model leaves, by the size of its coefficient over the deviation, and by what it is beside: the
/// imperfections of an effect look like others. `best`: no other candidate leaves less.
[[nodiscard]] Verdict judge_step(const Model& model, bool first, bool best,
                                 const Step& step) noexcept;

}  // namespace dampline::effect
