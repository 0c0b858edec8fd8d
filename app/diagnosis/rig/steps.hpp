// SPDX-License-Identifier: MIT
// The steps of a search: rank, accept, take, refine, prune.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/diagnosis/rig/state.hpp"

namespace dampline::app::rig {

/// The best candidate of an effect.
struct Ranked {
  const Candidate* candidate{nullptr};
  double gain{0.0};
  double t{0.0};
  Fit fit;
  bool needs_excess{false};  ///< over the floor, however sure it is
};

/// Every effect in its best form beside a constant and a spring, the one that helps most first; of
/// those that explain alike the plainest.
[[nodiscard]] std::vector<Ranked> rank(const State& s);
/// One effect may stand in for two that are there: the one whose best companion leaves clearly less
/// goes first.
void prefer_beside_another(const State& s, std::vector<Ranked>& order);
/// What is even leaves a mean, which a constant explains in part: each in the place of the other.
void prefer_to_offset(const State& s, std::vector<Ranked>& order);
/// A memory goes first where its smooth form leaves clearly less than what leads.
void prefer_memory(const State& s, std::vector<Ranked>& order);
/// A spring behind a dashpot forgets, too: where a memory leads, and it leaves clearly less than
/// that in full, it goes first. Their names where neither leaves clearly less.
[[nodiscard]] std::string prefer_viscoelastic(State& s, std::vector<Ranked>& order);
/// Names of two effects that predict alike; empty where one is better.
[[nodiscard]] std::string alike(const State& s, const std::vector<Ranked>& order);
/// Error of the other memory's smallest form over the first one's; 0: there is none.
[[nodiscard]] double other_memory_of(const std::vector<Ranked>& order);

/// By what is gained, how sure that is, and what is left over the floor.
[[nodiscard]] bool passes(const State& s, const Ranked& top, double before_nmse);
[[nodiscard]] bool is_clearly_better(const Fit& fit, const Fit& other);
/// Clearly better than every column: many things look a little like a delay.
[[nodiscard]] bool is_better(const State& s, const Trial& trial, const std::vector<Ranked>& order);

/// What the motion of a driven mass says of a step.
enum class ByMotion : std::uint8_t {
  kUnknown,  ///< nothing that decides: the equations do
  kNothing,  ///< no more is left than noise
  kAlike,    ///< several leave no more than noise: s.alike has their names
  kFirst     ///< the order's first leaves no more
};
/// Noise of the deflection bends every equation, and hardly the motion: an effect with which the
/// force alone moves the mass as it was measured goes first, in the form that does it best.
[[nodiscard]] ByMotion prefer_what_moves(State& s, std::vector<Ranked>& order);
/// The other of friction and damping, where nobody declared the base, it has one of them, and both
/// leave far less of the motion.
void complete_base_by_motion(State& s);
/// Friction and damping that the motion does not need go, where nobody declared the base. False
/// where the motion does not decide.
[[nodiscard]] bool prune_base_by_motion(State& s);
/// The base's friction and damping, and the names of its terms.
void set_base(State& s, bool friction, bool viscous);

/// Impacts come first: they are in every column's way.
void leave_impacts_out(State& s);
/// The best of lateness, change over the record, and modes.
[[nodiscard]] std::optional<Trial> best_trial(const State& s, double before_nmse);
void take(State& s, const Trial& trial);
/// A travel or gap that is another one from some moment on changes over the record; the law stays
/// one for all of it.
void take_change_of_memory(State& s);
/// An inertia force is no effect that a damper lacks: effects are looked for beside it. A late
/// force is one of a negative mass, an early one may be meant by a positive one.
[[nodiscard]] bool take_mass(State& s, const std::vector<Ranked>& order,
                             const std::optional<Trial>& trial);
/// A spring that carries most of the force is no effect that a damper lacks: effects are looked for
/// beside it.
void take_dominant_spring(State& s);

/// A smooth law of friction between two widths of the grid would leave what looks like an effect.
void refine_width(State& s);
/// Friction with a memory in its full form: a bank of stop operators, or one smooth law where that
/// leaves clearly less.
void refine_memory(State& s, Chosen& memory);

/// A linear term that belongs to the rig rather than to the damper stays where it helps.
void try_linear(State& s, bool& added);
/// Neither is less than nothing: a negative one would only help the fit.
void try_mass(State& s);
/// Drops effects that the others have made superfluous.
void backward(State& s);
/// Beside what was found: whether the base's friction and damping are still the right ones, where
/// nobody declared them.
void reconsider_base(State& s);

/// Looks for what a rig's base model lacks, step by step, and says what was found. A base that
/// nobody declared is looked at once more in the end.
[[nodiscard]] Explanation search(const Config& config, const std::vector<Series>& records,
                                 bool base_is_declared, bool refine);

}  // namespace dampline::app::rig
