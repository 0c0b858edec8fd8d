// SPDX-License-Identifier: MIT
// The identifier of the two widest models, compiled into the library, so that what is proved of the
// library's code is proved of it.
#include "published/oscillator/identifier.hpp"

namespace dampline {

template class OscillatorIdentifier<TermList<Viscous, Spring, Friction<>, ProgressiveFriction<>>>;
template class OscillatorIdentifier<
    TermList<Viscous, Spring, CubicSpring, VanDerPolDamper, Friction<>, ProgressiveFriction<>>>;

}  // namespace dampline
