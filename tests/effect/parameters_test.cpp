// SPDX-License-Identifier: MIT
#include "dampline/effect/parameters.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace dampline::effect {
namespace {

ModelFit fit_of(double friction, double law, double slope) {
  ModelFit fit;
  fit.ok = true;
  fit.terms = 5;
  fit.theta[ModelFit::kCoulomb] = friction;
  fit.theta[ModelFit::kStiffness] = 140.0;
  fit.theta[ModelFit::kFirstEffect] = law;
  fit.theta[ModelFit::kFirstEffect + 1] = slope;
  for (int i = 0; i < fit.terms; ++i) fit.covariance(i, i) = 1e-6 * (1.0 + i);
  return fit;
}

using Formula = std::function<Uncertain(const ModelFit&)>;

/// Slopes as differences of the formula's own values.
void expect_slopes(const Formula& formula) {
  const ModelFit fit = fit_of(0.2, 0.07, 0.01);
  const Uncertain found = formula(fit);
  for (int i = 0; i < fit.terms; ++i) {
    constexpr double kStep = 1e-6;
    ModelFit more = fit;
    more.theta[i] += kStep;
    EXPECT_NEAR(found.slope[i], (formula(more).value - found.value) / kStep, 1e-3) << i;
  }
}

TEST(Uncertain, KnowsHowAFormulaChangesWithTheUnknowns) {
  const auto term = [](const ModelFit& fit, int i) { return Uncertain::of(fit, i); };
  expect_slopes([&](const ModelFit& f) { return term(f, 3) / term(f, 0); });
  expect_slopes([&](const ModelFit& f) {
    return 3.0 * (term(f, 0) * term(f, 3)) - term(f, 4) / (Uncertain{1.0} + term(f, 3));
  });
}

/// A model with Stribeck friction, its speed's derivative beside it.
Explanation stribeck(const ModelFit& fit) {
  Candidate chosen;
  chosen.effect = Effect::kStribeck;
  chosen.variant = 1;
  chosen.count = 1;
  Explanation out;
  out.step_count = 1;
  out.step[0].chosen = chosen;
  Detail detail;
  detail.model = Model{}.with(with_slopes(chosen, out.grids));
  detail.fit = detail.slow = fit;
  detail.factor = 1.0;
  detail.mass_kg = 1000.0;
  describe(detail, out);
  return out;
}

TEST(Parameters, OfALawStandBetweenThePointsOfItsGrid) {
  const Explanation e = stribeck(fit_of(0.2, 0.08, 0.02));
  const Step& step = e.step[0];
  ASSERT_EQ(step.parameter_count, 2U);
  EXPECT_DOUBLE_EQ(step.parameter[0].estimate.value, 0.4);
  // A quarter of a step, which doubles the speed.
  EXPECT_NEAR(step.parameter[1].estimate.value, kStribeckMps[1] * std::exp2(0.25), 1e-12);
  EXPECT_NEAR(e.final_coulomb_n.value, 200.0, 1e-9);
}

TEST(Parameters, DeviateTogether) {
  ModelFit fit = fit_of(0.2, 0.08, 0.02);
  const double alone = stribeck(fit).step[0].parameter[0].estimate.std;
  fit.covariance(0, 3) = fit.covariance(3, 0) =
      -0.99 * std::sqrt(fit.covariance(0, 0) * fit.covariance(3, 3));
  const EffectParameter share = stribeck(fit).step[0].parameter[0];
  EXPECT_GT(share.estimate.std, alone);
  EXPECT_STREQ(share.twin, "coulomb");
  EXPECT_LT(share.correlation, -kInseparable);
}

TEST(Parameters, HaveSlopesWhereTheyHaveAGrid) {
  const Grids grids;
  Candidate stop;
  stop.effect = Effect::kBumpStop;
  stop.variant = 3;
  stop.count = 1;
  const Candidate found = with_slopes(stop, grids);
  ASSERT_EQ(found.slopes, 1U);
  ASSERT_EQ(found.count, 2U);
  EXPECT_EQ(found.regressor[1].count, 4U);
  EXPECT_EQ(found.regressor[1].column[0], kBumpUp + 4);
  EXPECT_DOUBLE_EQ(found.regressor[1].weight[0], 0.5);
  Candidate viscous;
  viscous.effect = Effect::kViscous;
  viscous.count = 1;
  EXPECT_EQ(with_slopes(viscous, grids).slopes, 0U);
  Candidate mode;
  mode.effect = Effect::kUnmodelledMode;
  mode.form = kPitchForm;
  mode.variant = 8;  // a corner: on one side only
  mode.count = 1;
  const Candidate corner = with_slopes(mode, grids);
  ASSERT_EQ(corner.slopes, 2U);
  EXPECT_EQ(corner.regressor[1].column[1], kPitchSign + 7);
  EXPECT_DOUBLE_EQ(corner.regressor[1].weight[0], 1.0);
  EXPECT_EQ(corner.regressor[2].column[1], kPitchSign + 5);
  EXPECT_DOUBLE_EQ(corner.regressor[2].weight[0], 1.0);
}

}  // namespace
}  // namespace dampline::effect
