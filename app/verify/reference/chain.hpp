// SPDX-License-Identifier: MIT
#pragma once
#include <cstddef>
#include <vector>

#include "app/verify/reference/element.hpp"

namespace dampline::sim::reference {

/// Motion and input of a system, sampled every `step_s` from time 0, without measuring error.
/// Outer index: degree of freedom; inner index: sample. All inner vectors have the same length.
struct Trajectory {
  double step_s{0.0};
  std::vector<std::vector<double>> deflection_m;
  std::vector<std::vector<double>> velocity_mps;
  std::vector<std::vector<double>> accel_mps2;
  std::vector<std::vector<double>> force_n;  ///< the input, not the restoring force
};

/// An element and what it joins: mass `to` to the ground, or to mass `from`.
struct Link {
  static constexpr int kGround = -1;
  int from{kGround};
  int to{0};
  Element element{};
};

/// One or two masses, the elements that join them, and a force on each mass. From `change_time_s`
/// on, `stiffness_factor` scales k of every element.
struct Chain {
  std::vector<Real> mass_kg{};
  std::vector<Link> links{};
  std::vector<Input> inputs{};  ///< one per mass; none at all: free
  Real change_time_s{-1};       ///< negative: never
  Real stiffness_factor{1};
};

/// One mass of 1 kg on one element to the ground; an empty input: free.
[[nodiscard]] inline Chain single(const Element& element, const Input& input) {
  Chain chain{.mass_kg = {1}, .links = {{Link::kGround, 0, element}}};
  if (!input.empty()) chain.inputs = {input};
  return chain;
}

/// The motion at time 0, one entry per mass; empty: all zero.
struct Start {
  std::vector<Real> deflection_m{};
  std::vector<Real> velocity_mps{};
};

/// How finely. Where a smooth representation of sign(v) bends sharply (speed of such an element
/// below `slow_mps` at the beginning of a sample interval), `slow_substeps` replaces `substeps`.
struct Resolution {
  double step_s{0.0};       ///< between samples
  std::size_t samples{0};   ///< at 0, step_s, 2 step_s, ...
  std::size_t substeps{8};  ///< Runge-Kutta steps between samples
  std::size_t slow_substeps{8};
  Real slow_mps{0};
};

/// The chain's motion, integrated with steps of order eight in extended precision. Every kink
/// (a reversal or a stop of an element with friction, a change of sign of the stretch where
/// friction depends on |z|) is located by bisection to the last digit and ends a step; at a stop,
/// the element sticks until the force on it exceeds what friction can hold (Coulomb's law,
/// set-valued).
///
/// An element with exact signum must join a mass to the ground. Throws std::invalid_argument for a
/// chain that it cannot compute.
[[nodiscard]] Trajectory simulate(const Chain& chain, const Start& start,
                                  const Resolution& resolution);

}  // namespace dampline::sim::reference
