// SPDX-License-Identifier: MIT
// Parameters of every law from the coefficients of its columns, with their units, and what of them
// stays in doubt where the sums tell all (docs/constants.md, effect/parameters).
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include "dampline/effect/parameters.hpp"

namespace dampline::effect {
namespace {

constexpr double kLevelFriction = 0.2;  // m/s^2, of a mass of 1000 kg: 200 N
constexpr double kLevelSpring = 140.0;
constexpr double kLawScaleM = 2e-3;  // of the deflection

Candidate law_of(Effect effect, std::uint8_t form = kPlainForm, std::uint8_t variant = 0) {
  Candidate out;
  out.effect = effect;
  out.form = form;
  out.variant = variant;
  out.count = 1;
  return out;
}

/// Laws of a model with their coefficients one after the other; those of slopes follow their law's.
struct Described {
  std::vector<Candidate> laws;
  std::vector<double> coefficients;
  std::size_t of_base{0};  ///< of the laws: in the model before any step
  bool with_places{true};  ///< slopes along grids
  double deviation{0.0};   ///< of every coefficient, friction and spring
  double factor{1.0};
  double deflection_m{0.0};  ///< rms
  Grids grids{.scale_m = kLawScaleM};
  double friction{kLevelFriction};

  [[nodiscard]] Explanation operator()() const {
    Explanation out;
    out.grids = grids;
    out.base_count = of_base;
    out.step_count = laws.size() - of_base;
    Detail detail;
    for (const Candidate& one : laws)
      detail.model = detail.model.with(with_places ? with_slopes(one, out.grids) : one);
    detail.fit.ok = true;
    detail.fit.theta[ModelFit::kCoulomb] = friction;
    detail.fit.theta[ModelFit::kStiffness] = kLevelSpring;
    detail.fit.terms = ModelFit::kFirstEffect;
    for (const double coefficient : coefficients)
      detail.fit.theta[detail.fit.terms++] = coefficient;
    for (int i = 0; i < detail.fit.terms; ++i) detail.fit.covariance(i, i) = deviation * deviation;
    detail.slow = detail.fit;
    detail.factor = factor;
    detail.mass_kg = 1000.0;
    detail.deflection_rms_m = deflection_m;
    describe(detail, out);
    return out;
  }
};

struct Told {
  std::string name, unit;
  double value;
};

void expect_told(const Described& described, const std::vector<Told>& told) {
  const Explanation e = described();
  const Step& step = e.step[0];
  ASSERT_EQ(step.parameter_count, told.size()) << told[0].name;
  for (std::size_t i = 0; i < told.size(); ++i) {
    EXPECT_EQ(step.parameter[i].name, told[i].name);
    EXPECT_EQ(step.parameter[i].unit, told[i].unit) << told[i].name;
    EXPECT_NEAR(step.parameter[i].estimate.value, told[i].value, 1e-9 * std::abs(told[i].value))
        << told[i].name;
  }
}

TEST(LawParameters, AreForcesOfTheMassThatMoves) {
  expect_told({{law_of(Effect::kViscous)}, {0.08}}, {{"viscous", "N s/m", 80.0}});
  expect_told({{law_of(Effect::kQuadraticDamping)}, {0.08}},
              {{"quadratic_damping", "N s^2/m^2", 80.0}});
  expect_told({{law_of(Effect::kCubicStiffness)}, {0.08}}, {{"cubic_stiffness", "N/m^3", 80.0}});
  expect_told({{law_of(Effect::kQuadraticStiffness)}, {0.08}},
              {{"quadratic_stiffness", "N/m^2", 80.0}});
  expect_told({{law_of(Effect::kAsymmetricStiffness)}, {0.08}},
              {{"asymmetric_stiffness_difference", "N/m", 160.0}});
  expect_told({{law_of(Effect::kProgressiveFriction)}, {0.08}},
              {{"progressive_friction_length", "m", 2.5}});
  Candidate sides = law_of(Effect::kAsymmetricViscous);
  sides.count = 2;
  expect_told({{sides}, {0.03, 0.08}},
              {{"viscous_positive", "N s/m", 110.0}, {"viscous_negative", "N s/m", 50.0}});
}

// A quarter of a step along the grid, by its logarithm; downwards by the step that ends there.
TEST(LawParameters, StandBetweenThePointsOfTheirGrids) {
  const auto between = [](double point, double next) {
    return point * std::pow(next / point, 0.25);
  };
  for (const auto& [slope, next] : {std::pair{0.02, 3U}, std::pair{-0.02, 1U}}) {
    const auto at = [&, to = next](const auto& grid) { return between(grid[2], grid[to]); };
    expect_told(
        {{law_of(Effect::kViscoelastic, kPlainForm, 2)}, {0.08, slope}},
        {{"viscoelastic_stiffness", "N/m", 80.0}, {"viscoelastic_time", "s", at(kRelaxationS)}});
    expect_told({{law_of(Effect::kStribeck, kPlainForm, 2)}, {0.08, slope}},
                {{"stribeck_share", "", 0.4}, {"stribeck_speed", "m/s", at(kStribeckMps)}});
    expect_told({{law_of(Effect::kPreslidingHysteresis, kPlainForm, 2)}, {0.08, slope}},
                {{"presliding_hysteresis_force", "N", 80.0},
                 {"presliding_hysteresis_distance", "m", kLawScaleM * at(kDahlDistance)}});
    expect_told(
        {{law_of(Effect::kBumpStop, kPlainForm, 2)}, {0.08, slope}},
        {{"bump_stop_stiffness", "N/m", 80.0}, {"bump_stop_gap", "m", kLawScaleM * at(kBumpGap)}});
    // Half of its force is there at 0.95 of the gap.
    expect_told({{law_of(Effect::kBacklash, kPlainForm, 2)}, {0.08, slope}},
                {{"backlash_force", "N", 80.0},
                 {"backlash_gap", "m", 0.95 * kLawScaleM * at(kBacklashGap)}});
  }
  const Explanation far = Described{{law_of(Effect::kStribeck, kPlainForm, 1)}, {0.08, 0.9}}();
  EXPECT_NEAR(far.step[0].parameter[1].estimate.value, kStribeckMps[1] * std::exp2(1.5), 1e-12)
      << "one and a half steps at most";
  EXPECT_NEAR(far.step[0].place, 2.5, 1e-12);
}

// Two neighbours of a grid without slopes: both coefficients are the law's, and the place is that
// of their balance.
TEST(LawParameters, OfTwoNeighboursAreTheirSum) {
  Candidate pair = law_of(Effect::kPreslidingHysteresis, kPlainForm, 3);
  pair.count = 2;
  Described described{{pair}, {0.06, 0.02}};
  described.with_places = false;
  expect_told(described, {{"presliding_hysteresis_force", "N", 80.0},
                          {"presliding_hysteresis_distance", "m",
                           kLawScaleM * kDahlDistance[3] *
                               std::pow(kDahlDistance[4] / kDahlDistance[3], 0.25)}});
  const Explanation e = described();
  EXPECT_NEAR(e.step[0].place, 3.25, 1e-12);
  EXPECT_NEAR(e.final_coulomb_n.value, 200.0 + 80.0, 1e-9) << "with what a history replaced";
}

// The width of its end makes it uncertain where a gap ends; its lines are one law otherwise.
TEST(LawParameters, OfAPlayKnowItsGapTheLessTheMoreItsEndYields) {
  const auto gap_of = [](double width_mps) {
    Described described{{law_of(Effect::kBacklash, kPlainForm, 6)}, {0.08, 0.0, 0.0}};
    Grids& grids = described.grids;
    grids.fine[static_cast<std::size_t>(Effect::kBacklash)] = true;
    for (std::size_t i = 0; i < kBacklashGaps; ++i)
      grids.play[i] = {0.3 * std::pow(1.04, static_cast<double>(i % kFineGaps)), width_mps};
    const Explanation e = described();
    EXPECT_EQ(e.step[0].parameter_count, 2U);
    return e.step[0].parameter[1].estimate;
  };
  const Estimate sharp = gap_of(kInnerWidthMps);
  const Estimate soft = gap_of(6e-3);
  EXPECT_NEAR(sharp.value, 0.95 * kLawScaleM * 0.3 * 1.04 * 1.04, 1e-12);
  EXPECT_EQ(soft.value, sharp.value);
  const double yields_m = 0.5 * (6e-3 * 6e-3 - kInnerWidthMps * kInnerWidthMps) / 0.08;
  EXPECT_NEAR(soft.std * soft.std - sharp.std * sharp.std, std::pow(0.25 * yields_m, 2),
              1e-3 * std::pow(0.25 * yields_m, 2));
}

TEST(LawParameters, NoFrictionDrivesBesideAPlay) {
  Described described{{law_of(Effect::kBacklash, kPlainForm, 2)}, {0.08, 0.0}};
  described.friction = 0.01;
  EXPECT_NEAR(described().final_coulomb_n.value, 90.0, 1e-9);
  described.friction = -0.01;
  const Estimate level = described().final_coulomb_n;
  EXPECT_NEAR(level.value, 80.0, 1e-9);
  EXPECT_GT(level.std, 10.0) << "as much of the law is none";
}

TEST(LawParameters, OfPitchAreItsFrequencyAndForce) {
  for (const auto& [variant, next] : {std::pair{0, 1}, std::pair{3, 4}, std::pair{6, 7}}) {
    const double hz = kPitch[static_cast<std::size_t>(variant)].frequency_hz;
    const double step = kPitch[static_cast<std::size_t>(next)].frequency_hz / hz;
    const Described described{
        {law_of(Effect::kUnmodelledMode, kPitchForm, static_cast<std::uint8_t>(variant))},
        {0.08, 0.02, -0.04}};
    expect_told(described, {{"unmodelled_mode_frequency", "Hz", hz * std::pow(step, 0.25)},
                            {"unmodelled_mode_force", "N", 80.0}});
    EXPECT_NEAR(described().step[0].line_offset, -0.5, 1e-12);
    EXPECT_NEAR(described().final_coulomb_n.value, 200.0 + 80.0, 1e-9);
  }
}

// The coefficient of a mass m on the frame, of all mass, is -m / (1 - m).
TEST(LawParameters, OfAMassOnTheFrameIsItsShare) {
  const Described described{{law_of(Effect::kUnmodelledMode, kFlexibleForm, 4)}, {-0.25, -0.0625}};
  expect_told(described, {{"unmodelled_mode_frequency", "Hz",
                           kFlexibleHz[4] * std::pow(kFlexibleHz[5] / kFlexibleHz[4], 0.25)},
                          {"unmodelled_mode_mass", "kg", 200.0}});
  const Explanation e = described();
  EXPECT_NEAR(e.final_coulomb_n.value, 0.8 * 200.0, 1e-9) << "by the frame's own share";
  EXPECT_NEAR(e.final_stiffness_npm.value, 0.8 * 140e3, 1e-6);
}

TEST(LawParameters, OfChannelsAreTheirsAlone) {
  const char* const skews[] = {"time_skew_frame", "time_skew_wheelset1", "time_skew_wheelset2"};
  const char* const gains[] = {"gain_error_frame", "gain_error_wheelset1", "gain_error_wheelset2"};
  for (std::uint8_t form = 0; form < 3; ++form) {
    expect_told({{law_of(Effect::kTimeSkew, form)}, {0.003}}, {{skews[form], "s", 0.003}});
    expect_told({{law_of(Effect::kGainError, form)}, {0.08}},
                {{gains[form], "", form == kFrameForm ? 0.08 / 0.92 : 0.08}});
    const Explanation e = Described{{law_of(Effect::kGainError, form)}, {0.08}}();
    EXPECT_NEAR(e.final_coulomb_n.value, form == kFrameForm ? 184.0 : 200.0, 1e-9);
  }
}

TEST(LawParameters, OfASecondLawFollowThoseOfTheFirst) {
  const Described both{{law_of(Effect::kStribeck, kPlainForm, 1), law_of(Effect::kViscous)},
                       {0.08, 0.02, 0.05}};
  const Explanation e = both();
  EXPECT_NEAR(e.step[0].parameter[0].estimate.value, 0.4, 1e-12);
  ASSERT_EQ(e.step[1].parameter_count, 1U);
  EXPECT_NEAR(e.step[1].parameter[0].estimate.value, 50.0, 1e-9);
  Described known = both;
  known.of_base = 1;
  expect_told(known, {{"viscous", "N s/m", 50.0}});
}

TEST(LawParameters, DeviateByTheirCoefficientsAndTheFactorOfFewEntries) {
  Described described{{law_of(Effect::kProgressiveFriction)}, {0.08}};
  described.deviation = 1e-3;
  described.factor = 1.5;
  // Of F / theta, both with the same deviation.
  const double relative = 1e-3 * std::hypot(1.0 / kLevelFriction, 1.0 / 0.08);
  const Explanation e = described();
  EXPECT_NEAR(e.step[0].parameter[0].estimate.std, std::hypot(1.5 * 2.5 * relative, 0.03 * 2.5),
              1e-12);
  EXPECT_NEAR(e.final_coulomb_n.std, std::hypot(1.5 * 1.0, 0.0025 * 200.0), 1e-9);
  EXPECT_NEAR(e.final_stiffness_npm.std, std::hypot(1.5 * 1.0, 0.003 * 140e3), 1e-6);
}

// With 0.2 N and 140 N/m for a kilogram and 1 mm rms, 0.04 * 0.2 / 0.14 of the deflection's power
// is missing.
TEST(LawParameters, AreRidOfWhatTheDeflectionLacks) {
  constexpr double kLost = 0.04 * 0.2 / 0.14;
  const auto held = [](const Candidate& law, double coefficient) {
    Described described{{law}, {coefficient}};
    described.deflection_m = 1e-3;
    return described();
  };
  const Explanation grows = held(law_of(Effect::kProgressiveFriction, kAbsoluteForm), 80.0);
  const double of_friction = kLost * 80.0 * 1e-3 / 0.2;
  EXPECT_NEAR(grows.final_coulomb_n.value, 200.0 * (1.0 - of_friction), 1e-9);
  EXPECT_NEAR(grows.final_coulomb_n.std, 200.0 * std::hypot(0.0025, of_friction), 1e-9);
  EXPECT_NEAR(grows.final_stiffness_npm.value, 140e3 * (1.0 + 0.2 * kLost), 1e-6);
  EXPECT_NEAR(grows.final_stiffness_npm.std, 140e3 * std::hypot(0.003, 0.2 * kLost), 1e-6);
  const Explanation hardens = held(law_of(Effect::kCubicStiffness), 4e6);
  const double of_spring = 3.0 * kLost * 1e-6 * 4e6 / 140.0;
  EXPECT_NEAR(hardens.final_coulomb_n.value, 200.0, 1e-9);
  EXPECT_NEAR(hardens.final_stiffness_npm.value, 140e3 * (1.0 - of_spring), 1e-6);
  EXPECT_NEAR(hardens.final_stiffness_npm.std, 140e3 * std::hypot(0.003, 0.007, of_spring), 1e-6);
  // No more than 0.3; a level that grows with y itself has its mean.
  const Explanation most = held(law_of(Effect::kProgressiveFriction, kAbsoluteForm), 8e3);
  EXPECT_NEAR(most.final_coulomb_n.value, 140.0, 1e-9);
  const Explanation other = held(law_of(Effect::kProgressiveFriction), 80.0);
  EXPECT_NEAR(other.final_coulomb_n.value, 200.0, 1e-9);
}

TEST(LawParameters, NameTheOneTheyAreMostCorrelatedWith) {
  const auto twin = [](int i, double correlation, int k, double less) {
    Explanation out;
    out.step_count = 1;
    Detail detail;
    detail.model = Model{}.with(law_of(Effect::kViscous));
    detail.fit.theta[ModelFit::kCoulomb] = kLevelFriction;
    detail.fit.theta[ModelFit::kStiffness] = kLevelSpring;
    detail.fit.theta[ModelFit::kFirstEffect] = 0.08;
    detail.fit.terms = 4;
    detail.fit.covariance = 1e-6 * ModelFit::Square::Identity();
    detail.fit.covariance(i, 3) = detail.fit.covariance(3, i) = 1e-6 * correlation;
    detail.fit.covariance(k, 3) = detail.fit.covariance(3, k) = 1e-6 * less;
    detail.slow = detail.fit;
    detail.mass_kg = 1000.0;
    describe(detail, out);
    EXPECT_NEAR(out.step[0].parameter[0].correlation, correlation, 1e-9);
    return std::string{out.step[0].parameter[0].twin};
  };
  EXPECT_EQ(twin(ModelFit::kCoulomb, -0.9, ModelFit::kStiffness, 0.5), "coulomb");
  EXPECT_EQ(twin(ModelFit::kStiffness, 0.9, ModelFit::kCoulomb, -0.5), "stiffness");
  EXPECT_EQ(twin(ModelFit::kWidthChange, 0.6, ModelFit::kCoulomb, 0.1), "law_width");
}

// Of friction, spring, the law's size, and its length, speed, time or frequency.
TEST(LawParameters, StayInDoubtByWhatTheirLawsDoNotShow) {
  struct Doubt {
    Effect effect;
    std::uint8_t form;
    double coulomb, stiffness, size, place;
  };
  for (const Doubt& d : {Doubt{Effect::kViscous, 0, 0.012, 0.0, 0.05, 0.0},
                         Doubt{Effect::kQuadraticDamping, 0, 0.005, 0.0, 0.015, 0.0},
                         Doubt{Effect::kViscoelastic, 0, 0.009, 0.004, 0.07, 0.09},
                         Doubt{Effect::kStribeck, 0, 0.025, 0.0, 0.35, 0.35},
                         Doubt{Effect::kProgressiveFriction, 0, 0.0, 0.0, 0.03, 0.0},
                         Doubt{Effect::kPreslidingHysteresis, 0, 0.002, 0.005, 0.008, 0.006},
                         Doubt{Effect::kBacklash, 0, 0.02, 0.006, 0.025, 0.012},
                         Doubt{Effect::kBumpStop, 0, 0.002, 0.005, 0.17, 0.045},
                         Doubt{Effect::kCubicStiffness, 0, 0.0, 0.007, 0.05, 0.0},
                         Doubt{Effect::kQuadraticStiffness, 0, 0.0, 0.007, 0.05, 0.0},
                         Doubt{Effect::kAsymmetricStiffness, 0, 0.0, 0.03, 0.15, 0.0},
                         Doubt{Effect::kTimeSkew, 1, 0.0, 0.0, 0.02, 0.0},
                         Doubt{Effect::kGainError, 1, 0.0, 0.0, 0.0, 0.0}}) {
    const Explanation e = Described{{law_of(d.effect, d.form, 1)}, {0.08, 0.01}}();
    const auto relative = [](const Estimate& of) { return of.std / of.value; };
    EXPECT_NEAR(relative(e.final_coulomb_n), std::hypot(0.0025, d.coulomb), 1e-9)
        << name_of(d.effect);
    EXPECT_NEAR(relative(e.final_stiffness_npm), std::hypot(0.003, d.stiffness), 1e-9)
        << name_of(d.effect);
    const Step& step = e.step[0];
    EXPECT_NEAR(relative(step.parameter[0].estimate), d.size, 1e-9) << name_of(d.effect);
    if (step.parameter_count > 1) {
      EXPECT_NEAR(relative(step.parameter[1].estimate), d.place, 1e-9) << name_of(d.effect);
    }
  }
  const Explanation pitch =
      Described{{law_of(Effect::kUnmodelledMode, kPitchForm, 1)}, {0.08, 0.01, 0.01}}();
  EXPECT_NEAR(pitch.step[0].parameter[0].estimate.std / pitch.step[0].parameter[0].estimate.value,
              0.04, 1e-9);
  EXPECT_NEAR(pitch.step[0].parameter[1].estimate.std / 80.0, 0.012, 1e-9);
  const Explanation mass =
      Described{{law_of(Effect::kUnmodelledMode, kFlexibleForm, 4)}, {-0.25, 0.0}}();
  EXPECT_NEAR(mass.step[0].parameter[1].estimate.std / 200.0, 0.012, 1e-9);
}

}  // namespace
}  // namespace dampline::effect
