// SPDX-License-Identifier: MIT
#include "app/verify/reference/chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace dampline::sim::reference {
namespace {

/// The chain of `Dof` masses on known branches of its kinks: an ordinary differential equation.
/// State: all deflections, then all velocities.
template <std::size_t Dof>
class BranchedChain {
 public:
  using State = std::array<Real, 2 * Dof>;

  BranchedChain(const Chain& chain, const State& state)
      : chain_{&chain}, branches_(chain.links.size()) {
    for (std::size_t i = 0; i < branches_.size(); ++i) {
      branches_[i].of_stretch = stretch(i, state) < 0 ? -1 : 1;
      settle(i, 0, state);
    }
  }

  [[nodiscard]] State operator()(Real time_s, const State& state) const {
    State rate{};
    const Real factor = changed_ ? chain_->stiffness_factor : 1;
    for (std::size_t i = 0; i < Dof; ++i) rate[i] = state[Dof + i];
    for (std::size_t i = 0; i < chain_->inputs.size(); ++i)
      rate[Dof + i] = force_n(chain_->inputs[i], time_s);
    for (std::size_t i = 0; i < branches_.size(); ++i) {
      const Link& link = chain_->links[i];
      Element element = link.element;
      element.k *= factor;
      const Real z = stretch(i, state);
      const Real v = speed(i, state);
      const Real force = smooth_force(element, z, v) + friction_force(element, branches_[i], z, v);
      rate[Dof + static_cast<std::size_t>(link.to)] -= force;
      if (link.from != Link::kGround) rate[Dof + static_cast<std::size_t>(link.from)] += force;
    }
    for (std::size_t i = 0; i < Dof; ++i) rate[Dof + i] /= chain_->mass_kg[i];
    for (std::size_t i = 0; i < branches_.size(); ++i) {
      if (!sticks(i)) continue;
      const auto to = static_cast<std::size_t>(chain_->links[i].to);
      rate[to] = 0;
      rate[Dof + to] = 0;
    }
    return rate;
  }

  [[nodiscard]] std::size_t links() const noexcept { return branches_.size(); }
  [[nodiscard]] Branch branch(std::size_t i) const noexcept { return branches_[i]; }

  /// Each is positive as long as the branch holds: a moving element's rate on its branch; what
  /// friction can still hold of a sticking one; the stretch on its branch, where that matters.
  [[nodiscard]] Real rate_margin(std::size_t i, Real time_s, const State& state) const {
    const Element& element = chain_->links[i].element;
    if (!element.has_kink()) return 1;
    if (!sticks(i)) return static_cast<Real>(branches_[i].of_rate) * speed(i, state);
    const Real load = held_load(i, time_s, state);
    return hold_force(element, branches_[i], stretch(i, state)) - (load < 0 ? -load : load);
  }
  [[nodiscard]] Real stretch_margin(std::size_t i, const State& state) const {
    if (chain_->links[i].element.fk == 0 || sticks(i)) return 1;
    return static_cast<Real>(branches_[i].of_stretch) * stretch(i, state);
  }

  /// Crosses the kink at which rate_margin is zero: reversal, stop or release.
  void cross_rate(std::size_t i, Real time_s, State& state) {
    const Link& link = chain_->links[i];
    if (!link.element.can_stick()) {
      branches_[i].of_rate = -branches_[i].of_rate;
      return;
    }
    state[Dof + static_cast<std::size_t>(link.to)] = 0;
    if (sticks(i)) {
      branches_[i].of_rate = held_load(i, time_s, state) < 0 ? -1 : 1;
    } else {
      settle(i, time_s, state);
    }
  }
  /// Crosses the kink at which stretch_margin is zero.
  void cross_stretch(std::size_t i, State& state) {
    branches_[i].of_stretch = speed(i, state) < 0 ? -1 : 1;
    if (chain_->links[i].from == Link::kGround)
      state[static_cast<std::size_t>(chain_->links[i].to)] = 0;
  }
  void change_stiffness() noexcept { changed_ = true; }

 private:
  [[nodiscard]] bool sticks(std::size_t i) const noexcept { return branches_[i].of_rate == 0; }
  [[nodiscard]] Real stretch(std::size_t i, const State& state) const noexcept {
    return difference(i, state, 0);
  }
  [[nodiscard]] Real speed(std::size_t i, const State& state) const noexcept {
    return difference(i, state, Dof);
  }
  [[nodiscard]] Real difference(std::size_t i, const State& state,
                                std::size_t base) const noexcept {
    const Link& link = chain_->links[i];
    const Real to = state[base + static_cast<std::size_t>(link.to)];
    if (link.from == Link::kGround) return to;
    return to - state[base + static_cast<std::size_t>(link.from)];
  }

  /// The force that friction of element i must hold for its mass to stay at rest.
  [[nodiscard]] Real held_load(std::size_t i, Real time_s, const State& state) const {
    BranchedChain free = *this;
    free.branches_[i].of_rate = 1;
    const auto to = static_cast<std::size_t>(chain_->links[i].to);
    const Branch forward = free.branches_[i];
    return free(time_s, state)[Dof + to] * chain_->mass_kg[to] +
           friction_force(chain_->links[i].element, forward, stretch(i, state), 0);
  }

  /// The branch of an element from its state: from its rate, or at rest from its load.
  void settle(std::size_t i, Real time_s, const State& state) {
    const Element& element = chain_->links[i].element;
    const Real v = speed(i, state);
    branches_[i].of_rate = v < 0 ? -1 : 1;
    if (!element.can_stick() || v != 0) return;
    const Real load = held_load(i, time_s, state);
    const Real limit = hold_force(element, branches_[i], stretch(i, state));
    branches_[i].of_rate = load > limit ? 1 : (load < -limit ? -1 : 0);
  }

  const Chain* chain_;
  std::vector<Branch> branches_;
  bool changed_{false};
};

/// Halvings of a step that holds a kink: beyond the last digit.
constexpr int kHalvings = 70;
/// Kinks within one step; more are a sign of a mistake.
constexpr int kMostKinks = 64;

template <std::size_t Dof>
class Integration {
 public:
  using State = typename BranchedChain<Dof>::State;

  Integration(const Chain& chain, const State& state, const Resolution& resolution)
      : chain_{&chain}, resolution_{resolution}, equation_{chain, state}, state_{state} {}

  [[nodiscard]] Trajectory run() {
    Trajectory out;
    out.step_s = resolution_.step_s;
    for (auto* series : {&out.deflection_m, &out.velocity_mps, &out.accel_mps2, &out.force_n})
      series->resize(Dof);
    for (std::size_t n = 0; n < resolution_.samples; ++n) {
      const Real time_s = static_cast<Real>(n) * static_cast<Real>(resolution_.step_s);
      change_stiffness(time_s);
      append(time_s, out);
      if (n + 1 < resolution_.samples) pass_interval(time_s);
    }
    return out;
  }

 private:
  void change_stiffness(Real time_s) {
    if (chain_->change_time_s >= 0 && time_s >= chain_->change_time_s) equation_.change_stiffness();
  }

  void append(Real time_s, Trajectory& out) const {
    const State rate = equation_(time_s, state_);
    for (std::size_t i = 0; i < Dof; ++i) {
      out.deflection_m[i].push_back(static_cast<double>(state_[i]));
      out.velocity_mps[i].push_back(static_cast<double>(state_[Dof + i]));
      out.accel_mps2[i].push_back(static_cast<double>(rate[Dof + i]));
      out.force_n[i].push_back(
          chain_->inputs.empty() ? 0.0 : static_cast<double>(force_n(chain_->inputs[i], time_s)));
    }
  }

  [[nodiscard]] std::size_t substeps() const {
    for (const Link& link : chain_->links) {
      if (!link.element.has_friction() || link.element.signum == Signum::kExact) continue;
      const auto to = static_cast<std::size_t>(link.to);
      const Real base =
          link.from == Link::kGround ? 0 : state_[Dof + static_cast<std::size_t>(link.from)];
      if (std::abs(state_[Dof + to] - base) < resolution_.slow_mps)
        return resolution_.slow_substeps;
    }
    return resolution_.substeps;
  }

  void pass_interval(Real begin_s) {
    const std::size_t count = substeps();
    const Real step_s = static_cast<Real>(resolution_.step_s) / static_cast<Real>(count);
    for (std::size_t i = 0; i < count; ++i)
      pass_step(begin_s + static_cast<Real>(i) * step_s, step_s);
  }

  void pass_step(Real time_s, Real step_s) {
    Real done_s = 0;
    for (int kinks = 0; kinks < kMostKinks; ++kinks) {
      const Real rest_s = step_s - done_s;
      const State next = advance(equation_, time_s + done_s, state_, rest_s);
      Kink first;
      for (std::size_t i = 0; i < equation_.links(); ++i) {
        first = earlier(first, find_kink(i, true, time_s + done_s, rest_s, next));
        first = earlier(first, find_kink(i, false, time_s + done_s, rest_s, next));
      }
      if (first.after_s > rest_s) {
        state_ = next;
        return;
      }
      cross(first, time_s + done_s);
      done_s += first.after_s;
    }
    throw std::invalid_argument{"reference: too many kinks within one step; use more substeps"};
  }

  struct Kink {
    std::size_t link{0};
    bool of_rate{true};
    Real after_s{INFINITY};
  };
  static Kink earlier(const Kink& a, const Kink& b) { return b.after_s < a.after_s ? b : a; }

  [[nodiscard]] Real margin(std::size_t i, bool of_rate, Real time_s, const State& state) const {
    return of_rate ? equation_.rate_margin(i, time_s, state) : equation_.stretch_margin(i, state);
  }

  [[nodiscard]] Kink find_kink(std::size_t i, bool of_rate, Real time_s, Real step_s,
                               const State& next) const {
    if (!(margin(i, of_rate, time_s + step_s, next) < 0)) return {};
    Real low_s = 0;
    Real high_s = step_s;
    for (int n = 0; n < kHalvings; ++n) {
      const Real middle_s = (low_s + high_s) / 2;
      const State there = advance(equation_, time_s, state_, middle_s);
      (margin(i, of_rate, time_s + middle_s, there) < 0 ? high_s : low_s) = middle_s;
    }
    return {i, of_rate, high_s};
  }

  void cross(const Kink& kink, Real time_s) {
    state_ = advance(equation_, time_s, state_, kink.after_s);
    if (kink.of_rate) {
      equation_.cross_rate(kink.link, time_s + kink.after_s, state_);
    } else {
      equation_.cross_stretch(kink.link, state_);
    }
  }

  const Chain* chain_;
  Resolution resolution_;
  BranchedChain<Dof> equation_;
  State state_;
};

template <std::size_t Dof>
Trajectory integrate(const Chain& chain, const Start& start, const Resolution& resolution) {
  typename BranchedChain<Dof>::State state{};
  for (std::size_t i = 0; i < start.deflection_m.size(); ++i) state[i] = start.deflection_m[i];
  for (std::size_t i = 0; i < start.velocity_mps.size(); ++i)
    state[Dof + i] = start.velocity_mps[i];
  return Integration<Dof>{chain, state, resolution}.run();
}

void check(const Chain& chain, const Start& start, const Resolution& resolution) {
  const std::size_t masses = chain.mass_kg.size();
  const auto refuse = [](const char* text) { throw std::invalid_argument{text}; };
  if (masses != 1 && masses != 2) refuse("reference: expected one or two masses");
  if (!chain.inputs.empty() && chain.inputs.size() != masses)
    refuse("reference: expected one input per mass, or none");
  if (start.deflection_m.size() > masses || start.velocity_mps.size() > masses)
    refuse("reference: a start for more masses than there are");
  if (!(resolution.step_s > 0) || resolution.substeps == 0 || resolution.slow_substeps == 0)
    refuse("reference: expected a step above 0 s and at least one substep");
  for (const Link& link : chain.links) {
    if (std::max(link.to, link.from) >= static_cast<int>(masses) || link.to < 0)
      refuse("reference: an element joins a mass that is not there");
    if (link.element.can_stick() && link.from != Link::kGround)
      refuse("reference: exact friction between two masses is not computed");
  }
}

}  // namespace

Trajectory simulate(const Chain& chain, const Start& start, const Resolution& resolution) {
  check(chain, start, resolution);
  return chain.mass_kg.size() == 1 ? integrate<1>(chain, start, resolution)
                                   : integrate<2>(chain, start, resolution);
}

}  // namespace dampline::sim::reference
