// SPDX-License-Identifier: MIT
#include "published/phase/resonance.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "app/verify/phase/simulated.hpp"

namespace dampline {
namespace {

Resonance sweep(const sim::OscillatorLaw& law, double swing_mps2, double from, double to) {
  ResonanceFit fit;
  for (int i = 0; i <= 8; ++i) {
    const double w = from + (to - from) * i / 8.0;
    fit.add(w, sim::steady_amplitude(law, {0.0, swing_mps2, w, 0.0}, 15, 3, 400));
  }
  return fit.resonance();
}

TEST(Resonance, OfAViscousOscillatorIsTheTheorys) {
  for (const double c : {0.2, 0.6, 1.0}) {
    const double theory = std::sqrt(1.0 - 0.5 * c * c);
    const Resonance r = sweep({.viscous_per_s = c}, 0.5, theory - 0.1, theory + 0.1);
    ASSERT_EQ(r.state, ResonanceState::kFound);
    EXPECT_NEAR(r.rate_rad_s.value, theory, c < 0.5 ? 0.002 : 1e-5) << c;
  }
}

TEST(Resonance, IsNotThereWhereNothingMoves) {
  EXPECT_EQ(sweep({.friction_mps2 = 1.0}, 1.0, 0.05, 0.3).state, ResonanceState::kNoMotion);
}

TEST(Resonance, IsNotThereOutsideTheSweep) {
  EXPECT_EQ(sweep({.viscous_per_s = 1.0}, 0.5, 1.0, 1.4).state, ResonanceState::kNoPeak);
  EXPECT_EQ(sweep({.viscous_per_s = 1.6}, 0.5, 0.3, 1.2).state, ResonanceState::kNoPeak);
}

TEST(Resonance, NeedsFourFrequencies) {
  ResonanceFit fit;
  fit.add(0.5, 1.0);
  fit.add(0.6, 1.1);
  fit.add(0.7, 1.0);
  EXPECT_EQ(fit.resonance().state, ResonanceState::kNotEnough);
}

}  // namespace
}  // namespace dampline
