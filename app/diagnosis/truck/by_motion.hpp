// SPDX-License-Identifier: MIT
#pragma once
#include <Eigen/Core>
#include <optional>

#include "app/diagnosis/truck/explain.hpp"

namespace dampline::app {

/// Refines a spring that is not straight by the frame's own motion: the measured wheelsets move the
/// law, with exact stick and slip, and its figures move until the velocity of the deflection is
/// what was measured (output error, Levenberg and Marquardt). The equations see the deflection
/// without what is slower than about 1 Hz, so that a stop, or a spring that hardens, stands at
/// wrong places for them; the law's motion has what is slow too. Spring and its effects take the
/// motion's figures where these leave less, held out. The level of friction stays: vibration above
/// the sensors' low pass eases the friction of the truck and not that of the law, whose level is
/// therefore low; by as much the other figures may be off, and that is in their deviations.
/// Only where every effect is a term of the law. Reads the record once more. Returns what is left
/// of the squares of the velocity in each block of 5 s, held out, as shares of all; nothing where
/// the figures stay.
Eigen::VectorXd refine_by_motion(const Config& config, const SourceOptions& source, Explained& out);

/// Of a spring that is not straight: what was chosen where the equations leave another one of that
/// kind almost as well.
[[nodiscard]] std::optional<effect::Effect> spring_with_rival(const effect::Explanation& e);

/// Whether a gain of the frame's sensor that was named beside such a spring is none by the frame's
/// own motion, where it is an unknown too: the gain made up for a stop at a wrong place.
[[nodiscard]] bool shows_no_gain(const Config& config, const SourceOptions& source,
                                 const Explained& explained);

}  // namespace dampline::app
