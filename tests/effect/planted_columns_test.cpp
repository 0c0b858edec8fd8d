// SPDX-License-Identifier: MIT
// Laws planted in rows of white columns: each is found by its name at its point of the grid.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "dampline/effect/explainer.hpp"

namespace dampline::effect {
namespace {

constexpr double kPlantedLevel = 0.2;
constexpr double kPlantedSpring = 140.0;

/// Coefficients of laws, and the rows that they make.
struct PlantedLaw {
  Candidate candidate;
  double coefficient{0.0};
};

double sum_over(const Regressor& of, const Row& row) {
  double sum = 0.0;
  for (std::size_t p = 0; p < of.count; ++p) sum += of.weight[p] * row[of.column[p]];
  return sum;
}

std::unique_ptr<GramStore> store_of(const std::vector<PlantedLaw>& laws, double noise) {
  auto store = std::make_unique<GramStore>();
  std::mt19937_64 random{5};
  std::normal_distribution<double> normal;
  for (int block = 0; block < 30; ++block) {
    for (int i = 0; i < 40; ++i) {
      for (std::size_t s = 0; s < kScales; ++s) {
        Row row;
        for (int c = 0; c < kColumns; ++c) row[c] = 1e-2 * normal(random);
        const double velocity_mps = 0.02 * normal(random);
        for (std::size_t w = 0; w < kWidths; ++w)
          row[kSign + at(w)] = std::erf(0.886226925452758 * velocity_mps / kWidthMps[w]);
        double force = kPlantedLevel * row[kSign + 3] + noise * normal(random) +
                       kPlantedSpring * sum_over(stiffness_regressor(), row);
        for (const PlantedLaw& law : laws)
          force += law.coefficient * sum_over(law.candidate.regressor[0], row);
        row[kTarget] = force;
        store->absorb(block, s, row);
      }
    }
    store->close(block);
    store->finish();
  }
  return store;
}

Explanation explained_of(const std::vector<PlantedLaw>& laws, double noise) {
  const auto store = store_of(laws, noise);
  const ImpulseMeter impulses;
  const Grids grids{.scale_m = 2e-3};
  return std::make_unique<Explainer>()->explain({*store, impulses, grids, {}},
                                                {.moving_mass_kg = 1000.0});
}

Candidate candidate_of(Effect effect, std::uint8_t variant) {
  const auto list = std::make_unique<CandidateList>();
  list_candidates({kPlantedLevel, kPlantedSpring}, Grids{.scale_m = 2e-3}, *list);
  for (std::size_t i = 0; i < list->count; ++i) {
    const Candidate& one = list->item[i];
    if (one.effect == effect && one.variant == variant && one.count == 1) return one;
  }
  ADD_FAILURE() << name_of(effect);
  return {};
}

PlantedLaw law_in_columns(Effect effect, std::uint8_t variant, double coefficient) {
  const Candidate one = candidate_of(effect, variant);
  return {one, one.sign < 0 ? -coefficient : coefficient};
}

TEST(PlantedColumns, NothingIsMissingWhereNothingWasPlanted) {
  const Explanation e = explained_of({}, 0.02);
  EXPECT_EQ(e.step_count, 0U);
  EXPECT_NEAR(e.final_coulomb_n.value, 200.0, 2.0);
  EXPECT_NEAR(e.final_stiffness_npm.value, 140e3, 1.4e3);
}

void expect_found(const Explanation& e, const PlantedLaw& law) {
  ASSERT_EQ(e.step_count, 1U) << name_of(law.candidate.effect);
  const Step& step = e.step[0];
  EXPECT_EQ(name_of(step.chosen.effect), name_of(law.candidate.effect));
  EXPECT_EQ(step.chosen.form, law.candidate.form);
  EXPECT_EQ(step.chosen.variant, law.candidate.variant) << name_of(law.candidate.effect);
  EXPECT_NEAR(step.place, law.candidate.variant, 0.02) << name_of(law.candidate.effect);
  EXPECT_NEAR(e.final.theta[ModelFit::kFirstEffect], law.coefficient,
              0.01 * std::abs(law.coefficient));
  EXPECT_NEAR(e.final_stiffness_npm.value, 140e3, 1.4e3);
  EXPECT_GT(step.gain, 0.5);
  EXPECT_LT(step.held_out_nmse_after, step.held_out_nmse_before);
  EXPECT_EQ(e.final.held_out_nmse, step.restated_after) << "in the weights of the final model";
}

TEST(PlantedColumns, EveryLawIsFoundAtItsPoint) {
  for (const auto& [effect, points] :
       {std::pair{Effect::kViscous, 1U}, std::pair{Effect::kQuadraticDamping, 1U},
        std::pair{Effect::kViscoelastic, 5U}, std::pair{Effect::kStribeck, 4U},
        std::pair{Effect::kPreslidingHysteresis, 8U}, std::pair{Effect::kBacklash, 8U},
        std::pair{Effect::kBumpStop, 7U}, std::pair{Effect::kCubicStiffness, 1U},
        std::pair{Effect::kQuadraticStiffness, 1U}, std::pair{Effect::kAsymmetricStiffness, 1U}}) {
    for (std::uint8_t variant = 0; variant < points; ++variant) {
      const PlantedLaw law = law_in_columns(effect, variant, 60.0);
      expect_found(explained_of({law}, 0.02), law);
    }
  }
}

TEST(PlantedColumns, TwoLawsAreFoundTheLargerFirst) {
  const PlantedLaw damping = law_in_columns(Effect::kViscous, 0, 90.0);
  const PlantedLaw spring = law_in_columns(Effect::kCubicStiffness, 0, 50.0);
  for (const auto& laws : {std::vector{damping, spring}, std::vector{spring, damping}}) {
    const Explanation e = explained_of(laws, 0.02);
    ASSERT_EQ(e.step_count, 2U);
    EXPECT_EQ(name_of(e.step[0].chosen.effect), name_of(Effect::kViscous));
    EXPECT_EQ(name_of(e.step[1].chosen.effect), name_of(Effect::kCubicStiffness));
    EXPECT_NEAR(e.step[0].parameter[0].estimate.value, 90e3, 900.0);
    EXPECT_NEAR(e.step[1].parameter[0].estimate.value, 1e3 * spring.coefficient,
                0.01 * std::abs(1e3 * spring.coefficient));
    EXPECT_NEAR(e.final_coulomb_n.value, 200.0, 3.0);
  }
}

// Damping that drives, or friction that grows below nothing, is none.
TEST(PlantedColumns, ALawOfTheWrongSignIsNotNamed) {
  PlantedLaw driving = law_in_columns(Effect::kViscous, 0, 60.0);
  driving.coefficient = -driving.coefficient;
  const Explanation e = explained_of({driving}, 0.02);
  for (std::size_t i = 0; i < e.step_count; ++i)
    EXPECT_NE(name_of(e.step[i].chosen.effect), name_of(Effect::kViscous));
}

TEST(PlantedColumns, WhatIsNotAllowedIsNotNamed) {
  const PlantedLaw law = law_in_columns(Effect::kViscous, 0, 60.0);
  const auto store = store_of({law}, 0.02);
  const ImpulseMeter impulses;
  const Grids grids{.scale_m = 2e-3};
  ExplainerConfig config{.moving_mass_kg = 1000.0};
  config.allowed[static_cast<std::size_t>(Effect::kViscous)] = false;
  config.allowed[static_cast<std::size_t>(Effect::kAsymmetricViscous)] = false;
  const Explanation e =
      std::make_unique<Explainer>()->explain({*store, impulses, grids, {}}, config);
  for (std::size_t i = 0; i < e.step_count; ++i)
    EXPECT_NE(name_of(e.step[i].chosen.effect), name_of(Effect::kViscous));
  ExplainerConfig known{.moving_mass_kg = 1000.0, .base_viscous = true};
  const Explanation with_damping =
      std::make_unique<Explainer>()->explain({*store, impulses, grids, {}}, known);
  EXPECT_EQ(with_damping.step_count, 0U) << "it belongs to the base";
  EXPECT_EQ(with_damping.base_count, 1U);
  EXPECT_LT(with_damping.final.held_out_nmse, 0.1 * e.final.held_out_nmse);
}

TEST(PlantedColumns, RunnersUpLeaveMoreThanTheChosenOne) {
  const Explanation e = explained_of({law_in_columns(Effect::kBumpStop, 3, 60.0)}, 0.02);
  ASSERT_EQ(e.step_count, 1U);
  for (std::size_t r = 0; r < e.step[0].runner_up_count; ++r)
    EXPECT_GT(e.step[0].runner_up[r].held_out_nmse, e.step[0].held_out_nmse_after);
}

}  // namespace
}  // namespace dampline::effect
