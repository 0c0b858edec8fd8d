// SPDX-License-Identifier: MIT
#pragma once
#include "app/verify/subject.hpp"

namespace dampline::app {

/// `dampline verify phase`: the resonances, sections and friction of the phase-mapping literature,
/// see VerifySubject::run. Tables: resonance, planarity, linearity, friction.
[[nodiscard]] int verify_phase(const VerifyOptions& options);

}  // namespace dampline::app
