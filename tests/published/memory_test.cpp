// SPDX-License-Identifier: MIT
// Parameters that change while the oscillator runs.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/published/run.hpp"

namespace dampline {
namespace {

/// 60 s at 3 Hz, then 60 s with a fifth less stiffness.
struct Change {
  sim::AccelerometerRun before = simulate(kLinearOscillator, 2.85, 41, 60.0);
  sim::AccelerometerRun after;
  Change() {
    sim::OscillatorConfig softer = kLinearOscillator;
    softer.stiffness_ps2 *= 0.8;
    after = simulate(softer, 2.85, 42, 60.0);
  }
};

template <class Identifier>
void feed(Identifier& identifier, const Change& change) {
  std::int64_t tick = 0;
  for (const auto* run : {&change.before, &change.after}) {
    for (std::size_t n = 0; n < run->mass_mps2.size(); ++n) {
      identifier.update(tick++, run->mass_mps2[n], run->base_mps2[n]);
    }
    tick += 1000;  // the two runs do not join
  }
  identifier.finish();
}

double stiffness_after(const OscillatorIdentifierConfig& config) {
  const auto identifier = std::make_unique<OscillatorIdentifier<LinearTerms>>(config);
  feed(*identifier, Change{});
  const auto estimate = identifier->estimate();
  return estimate.ok() ? estimate.value().value[1] : 0.0;
}

TEST(AccelerationOnly, ForgetsTheOldStiffnessWithinTheSlidingWindow) {
  const double k = stiffness_after({.memory = Memory::kWindow, .memory_blocks = 6.0});
  EXPECT_NEAR(k / (0.8 * 355.3), 1.0, 1e-3);
}

TEST(AccelerationOnly, ForgetsTheOldStiffnessByItsTimeConstant) {
  const double k = stiffness_after({.memory = Memory::kForgetting, .memory_blocks = 4.0});
  EXPECT_GT(k / (0.8 * 355.3), 1.0);
  EXPECT_LT(k / (0.8 * 355.3), 1.03);
}

TEST(AccelerationOnly, AveragesOverBothWithInfiniteMemory) {
  const double k = stiffness_after({});
  EXPECT_GT(k / 355.3, 0.83);
  EXPECT_LT(k / 355.3, 0.97);
}

}  // namespace
}  // namespace dampline
