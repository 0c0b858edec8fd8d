// SPDX-License-Identifier: MIT
#include "dampline/effect/grids.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "dampline/effect/conclusion.hpp"

namespace dampline::effect {
namespace {

Explanation with_step(Effect effect, std::uint8_t form, std::uint8_t variant, double place) {
  Explanation out;
  out.grids.scale_m = 2e-3;
  Step& step = out.step[out.step_count++];
  step.chosen.effect = effect;
  step.chosen.form = form;
  step.chosen.variant = variant;
  step.place = place;
  return out;
}

/// Neighbours of a grid, the one over the other.
template <std::size_t N>
void expect_ratio(const std::array<double, N>& grid, double ratio, double tolerance) {
  for (std::size_t i = 1; i < N; ++i) EXPECT_NEAR(grid[i] / grid[i - 1], ratio, tolerance) << i;
}

// What is told between two points is told by its logarithm.
TEST(Grids, RiseByTheSameFactor) {
  expect_ratio(kWidthMps, std::sqrt(2.0), 0.03);
  expect_ratio(kStribeckMps, 2.0, 1e-12);
  expect_ratio(kRelaxationS, 2.2, 0.03);
  expect_ratio(kDahlDistance, std::pow(10.0, 0.2), 0.04);
  expect_ratio(kBacklashGap, 1.5, 0.05);
  expect_ratio(kFlexibleHz, 1.1, 0.01);
  expect_ratio(kBumpGap, std::sqrt(2.0), 0.19);
  for (std::size_t i = 0; i < kPitchModes; ++i) {
    EXPECT_EQ(kPitch[i].frequency_hz, kPitch[i % kPitchFrequencies].frequency_hz);
    EXPECT_EQ(kPitch[i].slip_m, 0.4e-3 * std::exp2(i / kPitchFrequencies));
  }
  expect_ratio(std::array{kPitch[0].frequency_hz, kPitch[1].frequency_hz, kPitch[2].frequency_hz},
               1.6, 0.02);
}

TEST(Grids, DrawTogetherAroundALength) {
  const Explanation e = with_step(Effect::kBacklash, kPlainForm, 3, 3.5);
  Grids out;
  ASSERT_TRUE(draw_together(e, 0, out));
  const double found = std::sqrt(kBacklashGap[3] * kBacklashGap[4]);
  EXPECT_NEAR(std::sqrt(out.backlash_gap.front() * out.backlash_gap.back()), found, 1e-12);
  EXPECT_LT(out.backlash_gap.front(), 0.8 * found);
  EXPECT_GT(out.backlash_gap.back(), 1.2 * found);
  EXPECT_EQ(out.scale_m, 2e-3);
  EXPECT_TRUE(out.is_fine(Effect::kBacklash));
  EXPECT_FALSE(out.is_fine(Effect::kBumpStop));
  EXPECT_EQ(out.dahl_distance, kDahlDistance);
  Grids finer;
  ASSERT_TRUE(draw_together(e, 1, finer));
  EXPECT_GT(finer.backlash_gap.front(), out.backlash_gap.front());
}

TEST(Grids, KeepTheOctavesOfSpeeds) {
  Grids out;
  ASSERT_TRUE(draw_together(with_step(Effect::kStribeck, kPlainForm, 2, 1.75), 0, out));
  EXPECT_NEAR(out.stribeck_mps[1], 6e-3 * std::exp2(0.75), 1e-9);
  for (std::size_t i = 1; i < kStribeckSpeeds; ++i)
    EXPECT_NEAR(out.stribeck_mps[i], 2.0 * out.stribeck_mps[i - 1], 1e-12);
}

TEST(Grids, LinesOfModesAreFrequenciesTimesDampings) {
  Explanation e = with_step(Effect::kUnmodelledMode, kFlexibleForm, 6, 6.4);
  Grids out;
  ASSERT_TRUE(draw_together(e, 0, out));
  const double hz = kFlexibleHz[6] * std::pow(kFlexibleHz[7] / kFlexibleHz[6], 0.4);
  EXPECT_NEAR(out.flexible[7].frequency_hz, hz, 1e-9);  // the middle of the middle line
  EXPECT_NEAR(out.flexible[7].damping_ratio, kFlexibleDamping, 1e-12);
  EXPECT_LT(out.flexible[2].damping_ratio, kFlexibleDamping);
  EXPECT_EQ(out.flexible[2].frequency_hz, out.flexible[12].frequency_hz);
  // Found again between two points and two lines of it.
  e.grids = out;
  e.step[0].chosen.variant = 7;
  e.step[0].place = 7.5;
  e.step[0].line_offset = 0.5;
  const FlexibleShape found = flexible_of(e.step[0], out);
  EXPECT_NEAR(found.frequency_hz,
              std::sqrt(out.flexible[7].frequency_hz * out.flexible[8].frequency_hz), 1e-9);
  EXPECT_NEAR(found.damping_ratio,
              std::sqrt(out.flexible[7].damping_ratio * out.flexible[12].damping_ratio), 1e-9);
}

TEST(Grids, PitchIsDrawnTogetherInFrequencyAndSlip) {
  Explanation e = with_step(Effect::kUnmodelledMode, kPitchForm, 4, 4.0);
  Grids out;
  ASSERT_TRUE(draw_together(e, 0, out));
  EXPECT_NEAR(out.pitch[4].frequency_hz, kPitch[4].frequency_hz, 1e-9);
  EXPECT_NEAR(out.pitch[4].slip_m, kPitch[4].slip_m, 1e-12);
  EXPECT_LT(out.pitch[3].frequency_hz, out.pitch[4].frequency_hz);
  EXPECT_LT(out.pitch[1].slip_m, out.pitch[4].slip_m);
}

TEST(Grids, NothingToDrawTogether) {
  Grids out;
  EXPECT_FALSE(draw_together(with_step(Effect::kViscous, kPlainForm, 0, 0.0), 0, out));
}

}  // namespace
}  // namespace dampline::effect
