// SPDX-License-Identifier: MIT
#pragma once
#include "published/wavelet/models.hpp"

/// The models of the published cases, from the core's vocabulary.
namespace dampline::app {

using LinearTerms = TermList<Viscous, Spring>;
using ProductTerms = TermList<Viscous, Spring, Power<1, 1>>;
using DuffingTerms = TermList<Viscous, Spring, CubicSpring>;
using VanDerPolTerms = TermList<Viscous, Spring, VanDerPolDamper>;
using BothTerms = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper>;
template <class Sign>
using CoulombTerms = TermList<Viscous, Spring, Friction<Sign>>;
using LinearCoulombTerms = TermList<Viscous, Spring, Friction<>, ProgressiveFriction<>>;
using TeflonTerms = TermList<Viscous, Spring, Friction<TanhSign>, ExponentialFriction<TanhSign>>;

/// The over-specified models of tables 17 and 18: seven terms, and five per element.
template <class Sign>
using SevenTerms = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Power<2, 0>, Power<0, 2>,
                            Friction<Sign>>;
using FiveTerms = TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Friction<TanhSign>>;

}  // namespace dampline::app
