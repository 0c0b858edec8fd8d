// SPDX-License-Identifier: MIT
#include "dampline/effect/explainer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>

#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"
#include "tests/pitching_car.hpp"

namespace dampline::effect {
namespace {

struct Record {
  std::unique_ptr<Diagnosis> diagnosis;
  Explanation explanation;
};

Record explained(const std::string& effect, std::uint64_t seed, double length_s = 150.0,
                 double scale_m = 0.0) {
  sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, seed);
  if (!effect.empty()) {
    const auto wrong = sim::add_effect_text(config, effect);
    EXPECT_FALSE(wrong) << wrong.value_or("");
  }
  sim::Simulation simulation{config};
  EstimatorConfig core;
  core.moving_mass_kg = config.truck.moving_mass_kg;
  const auto identifier = std::make_unique<Estimator>(core);
  Record out{std::make_unique<Diagnosis>(core, Grids{.scale_m = scale_m}), {}};
  for (int n = 0; n < static_cast<int>(length_s * sim::kSampleRateHz); ++n) {
    const Sample sample = sim::to_sample(simulation.next());
    out.diagnosis->update(sample, identifier->update(sample));
  }
  out.diagnosis->finish();
  const auto explainer = std::make_unique<Explainer>();
  out.explanation = explainer->explain(*out.diagnosis, {.moving_mass_kg = core.moving_mass_kg});
  return out;
}

struct Planted {
  const char* text;
  Effect effect;
  const char* parameter;  // that comes back
  double value;
  double within;  // relative
};

class NamesPlanted : public testing::TestWithParam<Planted> {};

TEST_P(NamesPlanted, WithItsSize) {
  const Planted& p = GetParam();
  const Explanation e = explained(p.text, 71).explanation;
  ASSERT_EQ(e.step_count, 1U);
  const Step& step = e.step[0];
  EXPECT_STREQ(name_of(step.chosen.effect), name_of(p.effect));
  EXPECT_LT(step.held_out_nmse_after, step.held_out_nmse_before);
  EXPECT_EQ(e.conclusion, Conclusion::kExplained);
  bool found = false;
  for (std::size_t i = 0; i < step.parameter_count; ++i) {
    if (std::string{step.parameter[i].name} != p.parameter) continue;
    found = true;
    EXPECT_NEAR(step.parameter[i].estimate.value, p.value, p.within * std::abs(p.value));
    EXPECT_GT(step.parameter[i].estimate.std, 0.0);
  }
  EXPECT_TRUE(found) << p.parameter;
  // Level and spring are what they are beside the effect; a level that grows with the deflection is
  // that at its mean, which such friction moves up.
  EXPECT_NEAR(e.final_coulomb_n.value, 8356.0, 0.035 * 8356.0);
  EXPECT_NEAR(e.final_stiffness_npm.value, 5.26e6, 0.06 * 5.26e6);
}

INSTANTIATE_TEST_SUITE_P(
    Effects, NamesPlanted,
    testing::Values(
        Planted{"viscous:coefficient_nspm=90000", Effect::kViscous, "viscous", 9.0e4, 0.1},
        Planted{"asymmetric_viscous:positive_nspm=170000,negative_nspm=50000",
                Effect::kAsymmetricViscous, "viscous_negative", 5.0e4, 0.3},
        Planted{"quadratic_damping:coefficient_ns2pm2=5.5e6", Effect::kQuadraticDamping,
                "quadratic_damping", 5.5e6, 0.1},
        Planted{"progressive_friction:length_m=0.0055", Effect::kProgressiveFriction,
                "progressive_friction_length", 5.5e-3, 0.1},
        Planted{"presliding_hysteresis:distance_m=0.00011", Effect::kPreslidingHysteresis,
                "presliding_hysteresis_distance", 1.1e-4, 0.25},
        Planted{"backlash:gap_m=0.00026", Effect::kBacklash, "backlash_gap", 2.6e-4, 0.25},
        Planted{"cubic_stiffness:coefficient_npm3=3.3e11", Effect::kCubicStiffness,
                "cubic_stiffness", 3.3e11, 0.25},
        Planted{"time_skew:frame_s=0.0013", Effect::kTimeSkew, "time_skew_frame", 1.3e-3, 0.2},
        Planted{"gain_error:wheelset1=-0.045", Effect::kGainError, "gain_error_wheelset1", -0.045,
                0.2}),
    [](const testing::TestParamInfo<Planted>& tested) {
      return std::string{name_of(tested.param.effect)};
    });

TEST(Explainer, AFramesSensorThatShowsTooMuchStretchesNoForce) {
  const Explanation e = explained("gain_error:wheelset1=0,frame=0.05", 76).explanation;
  ASSERT_EQ(e.step_count, 1U);
  EXPECT_STREQ(e.step[0].parameter[0].name, "gain_error_frame");
  EXPECT_NEAR(e.step[0].parameter[0].estimate.value, 0.05, 0.006);
  EXPECT_GT(e.base_coulomb_n.value, 1.03 * 8356.0);
  EXPECT_NEAR(e.final_coulomb_n.value, 8356.0, 0.015 * 8356.0);
  EXPECT_NEAR(e.final_stiffness_npm.value, 5.26e6, 0.03 * 5.26e6);
}

TEST(Explainer, PitchHidesNoFrictionOnceItIsNamed) {
  const Explanation e = explained("unmodelled_mode", 77).explanation;
  ASSERT_EQ(e.step_count, 1U);
  EXPECT_EQ(e.step[0].chosen.effect, Effect::kUnmodelledMode);
  EXPECT_EQ(e.step[0].chosen.form, kPitchForm);
  EXPECT_NEAR(e.step[0].parameter[0].estimate.value, 12.0, 1.0);  // Hz: 2 k a^2 / I
  EXPECT_LT(e.base_coulomb_n.value, 0.95 * 8356.0);
  EXPECT_NEAR(e.final_coulomb_n.value, 8356.0, 0.02 * 8356.0);
  EXPECT_NEAR(e.final_stiffness_npm.value, 5.26e6, 0.03 * 5.26e6);
}

TEST(Explainer, ACleanRecordIsComplete) {
  for (const std::uint64_t seed : {72U, 73U}) {
    const Explanation e = explained("", seed).explanation;
    EXPECT_EQ(e.conclusion, Conclusion::kComplete);
    EXPECT_EQ(e.step_count, 0U);
    EXPECT_NEAR(e.base_coulomb_n.value, 8356.0, 0.02 * 8356.0);
  }
}

TEST(Explainer, AMassOnTheFrameIsAMode) {
  const Explanation e =
      explained(
          "unmodelled_mode:pitch_inertia_kgm2=0,flexible_share=0.2,flexible_frequency_hz=11.6", 74)
          .explanation;
  ASSERT_GE(e.step_count, 1U);
  EXPECT_EQ(e.step[0].chosen.effect, Effect::kUnmodelledMode);
  EXPECT_EQ(e.step[0].chosen.form, kFlexibleForm);
  EXPECT_NEAR(e.step[0].parameter[0].estimate.value, 11.6, 0.7);
}

TEST(Explainer, ImpactsThatNoSensorSawAreNamed) {
  const Explanation e = explained("impulsive_input", 75).explanation;
  ASSERT_EQ(e.step_count, 1U);
  EXPECT_EQ(e.step[0].chosen.effect, Effect::kImpulsiveInput);
}

TEST(Explainer, ImpactsOnTheSurrogateTooAreNone) {
  const Record record = explained("impulsive_input", 75);
  const Record sound = explained("", 79, 150.0, record.diagnosis->scale_m());
  const auto explainer = std::make_unique<Explainer>();
  Explanation kept = record.explanation;
  const auto empty = std::make_unique<Diagnosis>(EstimatorConfig{}, record.diagnosis->grids());
  EXPECT_FALSE(explainer->apply_floor({*empty}, 0, kept)) << "too few rows";
  EXPECT_FALSE(explainer->apply_floor({*sound.diagnosis, empty.get()}, 0, kept));
  ASSERT_TRUE(explainer->apply_floor({*sound.diagnosis}, 0, kept));
  EXPECT_EQ(kept.step_count, 1U);
  Explanation taken_back = record.explanation;
  ASSERT_TRUE(explainer->apply_floor({*record.diagnosis}, 0, taken_back));
  EXPECT_EQ(taken_back.step_count, 0U);
}

// Root mean squares over the motion, standstill left out.
TEST(Diagnosis, KnowsHowMuchTheFrameMoves) {
  sim::Simulation simulation{sim::reference_run(sim::Load::kEmpty, 60.0, 5)};
  const auto identifier = std::make_unique<Estimator>(EstimatorConfig{});
  const auto diagnosis = std::make_unique<Diagnosis>(EstimatorConfig{}, Grids{.scale_m = 2e-3});
  EXPECT_EQ(diagnosis->velocity_rms_mps(), 0.0);
  EXPECT_EQ(diagnosis->deflection_rms_m(), 0.0);
  double velocity = 0.0;
  double deflection = 0.0;
  double count = 0.0;
  for (int n = 0; n < 40 * sim::kSampleRateHz; ++n) {
    const Sample sample = sim::to_sample(simulation.next());
    const UpdateResult result = identifier->update(sample);
    diagnosis->update(sample, result);
    if (!result.has_motion || result.motion.still) continue;
    velocity += result.motion.velocity_mps * result.motion.velocity_mps;
    deflection += result.motion.deflection_m * result.motion.deflection_m;
    count += 1.0;
  }
  diagnosis->finish();
  EXPECT_NEAR(diagnosis->velocity_rms_mps() / std::sqrt(velocity / count), 1.0, 0.02);
  EXPECT_NEAR(diagnosis->deflection_rms_m() / std::sqrt(deflection / count), 1.0, 0.02);
}

TEST(Explainer, TooShortARecordIsNotJudged) {
  EXPECT_EQ(explained("", 76, 20.0).explanation.conclusion, Conclusion::kNotReady);
}

TEST(Explainer, PredictsARecordThatWasNeverFitted) {
  const Record fitted = explained("quadratic_damping", 77);
  const Record other = explained("quadratic_damping", 78, 150.0, fitted.diagnosis->scale_m());
  const auto explainer = std::make_unique<Explainer>();
  const auto found = explainer->predict(*other.diagnosis, fitted.explanation);
  EXPECT_LT(found.final_nmse, 0.6 * found.base_nmse);
  EXPECT_NEAR(found.final_nmse, fitted.explanation.final.held_out_nmse,
              0.2 * fitted.explanation.final.held_out_nmse);
}

// A laden car of two trucks whose frames pitch: without what the sensor at its frame's end shows
// the level is a tenth too low.
TEST(Explainer, BeginsFromTheLevelBesideAPitchThatIsMeasured) {
  const test::PitchingCar car;
  const auto estimator = std::make_unique<Estimator>(car.estimator);
  const auto diagnosis = std::make_unique<Diagnosis>(car.estimator);
  sim::Simulation simulation{car.simulation};
  for (int n = 0; n < 42 * sim::kSampleRateHz; ++n) {
    const Sample sample = sim::to_sample(simulation.next());
    diagnosis->update(sample, estimator->update(sample));
  }
  diagnosis->finish();
  const auto explainer = std::make_unique<Explainer>();
  const Explanation e =
      explainer->explain(*diagnosis, {.moving_mass_kg = car.estimator.moving_mass_kg});
  EXPECT_NEAR(e.base_coulomb_n.value / 8356.0, 1.0, 0.02);
}

}  // namespace
}  // namespace dampline::effect
