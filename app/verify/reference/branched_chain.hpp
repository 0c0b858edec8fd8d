// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "app/verify/reference/chain.hpp"

namespace dampline::sim::reference {

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

}  // namespace dampline::sim::reference
