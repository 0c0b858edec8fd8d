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

/// A spring that differs by direction, 1000 N/m in the mean.
Explanation uneven(double difference_npm) {
  Explanation out = with_step(Effect::kAsymmetricStiffness, kPlainForm, 0, 0.0);
  out.final_stiffness_npm.value = 1000.0;
  out.step[0].parameter[0].estimate.value = difference_npm;
  out.step[0].parameter_count = 1;
  return out;
}

// The mean force of a Gaussian motion about the kink's other side, by quadrature.
TEST(Grids, AnUnevenSpringBendsWhereItsMeanForceIsNone) {
  for (const double difference : {-900.0, -200.0, 300.0, 800.0}) {
    Grids out;
    ASSERT_TRUE(draw_together(uneven(difference), 0, out));
    double force = 0.0;
    double size = 0.0;
    for (double y = -6.0; y <= 6.0; y += 1e-3) {
      const double x = y - out.kink;
      const double weight = std::exp(-0.5 * y * y);
      force += weight * (1000.0 * x + 0.5 * difference * std::abs(x));
      size += weight * std::abs(0.5 * difference * x);
    }
    EXPECT_LT(std::abs(force), 0.02 * size) << difference;
    EXPECT_GT(out.kink * difference, 0.0);
  }
  Grids out;
  EXPECT_FALSE(draw_together(with_step(Effect::kAsymmetricStiffness, kPlainForm, 0, 0.0), 0, out));
}

TEST(Grids, AStopOnOneSideNearTheMiddleMayBeAKink) {
  for (const Form side : {kOneSidedUp, kOneSidedDown}) {
    Explanation e = with_step(Effect::kBumpStop, side, 0, 0.0);
    e.final_stiffness_npm.value = 800.0;
    Step& step = e.step[0];
    step.parameter_count = 2;
    step.parameter[0] = {"bump_stop_stiffness", {400.0, 20.0}, "N/m"};
    step.runner_up_count = 1;
    step.runner_up[0].effect = Effect::kAsymmetricStiffness;
    ASSERT_TRUE(as_kink(e));
    EXPECT_EQ(step.chosen.effect, Effect::kAsymmetricStiffness);
    EXPECT_EQ(step.chosen.form, kPlainForm);
    EXPECT_EQ(step.parameter[0].estimate.value, side == kOneSidedUp ? 400.0 : -400.0);
    EXPECT_EQ(e.final_stiffness_npm.value, 1000.0);
    EXPECT_EQ(step.runner_up[0].effect, Effect::kBumpStop);
    EXPECT_EQ(step.other[0].form, side);
  }
  Explanation far = with_step(Effect::kBumpStop, kOneSidedUp, 2, 2.0);
  EXPECT_FALSE(as_kink(far)) << "1.2 rms of the motion";
  Explanation both = with_step(Effect::kBumpStop, kPlainForm, 0, 0.0);
  EXPECT_FALSE(as_kink(both));
  Explanation none;
  EXPECT_FALSE(as_kink(none));
}

TEST(Grids, DrawTogetherAroundALength) {
  const Explanation e = with_step(Effect::kBacklash, kPlainForm, 3, 3.5);
  Grids out;
  ASSERT_TRUE(draw_together(e, 0, out));
  const double found = std::sqrt(kBacklashGap[3] * kBacklashGap[4]);
  EXPECT_NEAR(std::sqrt(out.play.front().gap * out.play.back().gap), found, 1e-12);
  EXPECT_LT(out.play.front().gap, 0.82 * found);
  EXPECT_GT(out.play.back().gap, 1.2 * found);
  EXPECT_EQ(out.scale_m, 2e-3);
  EXPECT_TRUE(out.is_fine(Effect::kBacklash));
  EXPECT_FALSE(out.is_fine(Effect::kBumpStop));
  EXPECT_EQ(out.dahl_distance, kDahlDistance);
  Grids finer;
  ASSERT_TRUE(draw_together(e, 1, finer));
  EXPECT_GT(finer.play.front().gap, out.play.front().gap);
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

TEST(Grids, PlayIsDrawnTogetherInGapAndWidth) {
  Explanation e = with_step(Effect::kBacklash, kPlainForm, 3, 3.0);
  Grids out;
  ASSERT_TRUE(draw_together(e, 0, out));
  for (std::size_t i = 0; i < kFineGaps; ++i) {
    EXPECT_EQ(out.play[i].gap, out.play[i + kFineGaps].gap);
    EXPECT_EQ(out.play[i].width_mps, out.play[0].width_mps);
  }
  EXPECT_NEAR(out.play.front().width_mps, kInnerWidthMps, 1e-12) << "the sharpest is tried";
  EXPECT_GT(out.play.back().width_mps, 2.0 * kInnerWidthMps);
  EXPECT_EQ(line_of(Effect::kBacklash, false, out), kFineGaps);
  // Found again between two points and beyond the second line.
  e.grids = out;
  e.step[0].chosen.variant = 5;
  e.step[0].place = 5.5;
  e.step[0].line_offset = 1.0;
  const double ratio = out.play.back().width_mps / out.play.front().width_mps;
  const PlayShape found = play_of(e.step[0], out);
  EXPECT_NEAR(found.gap, std::sqrt(out.play[5].gap * out.play[6].gap), 1e-12);
  EXPECT_NEAR(found.width_mps, out.play.back().width_mps * ratio, 1e-12);
  // No end is sharper than the velocity is known, or yields for ever.
  Grids next;
  e.step[0].line_offset = -9.0;
  ASSERT_TRUE(draw_together(e, 1, next));
  EXPECT_NEAR(next.play.front().width_mps, kInnerWidthMps, 1e-12);
  e.step[0].line_offset = 9.0;
  ASSERT_TRUE(draw_together(e, 1, next));
  EXPECT_NEAR(std::sqrt(next.play.front().width_mps * next.play.back().width_mps), 16e-3, 1e-12);
}

TEST(Grids, NothingToDrawTogether) {
  Grids out;
  EXPECT_FALSE(draw_together(with_step(Effect::kViscous, kPlainForm, 0, 0.0), 0, out));
}

}  // namespace
}  // namespace dampline::effect
