// SPDX-License-Identifier: MIT
#include "dampline/effect/candidates.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>

#include "dampline/effect/gram_store.hpp"

namespace dampline::effect {
namespace {

double value_of(const Regressor& regressor, const Row& row) {
  double sum = 0.0;
  for (std::size_t p = 0; p < regressor.count; ++p)
    sum += regressor.weight[p] * row[regressor.column[p]];
  return sum;
}

std::unique_ptr<CandidateList> listed(const BaseForce& base = {0.2, 140.0}) {
  auto out = std::make_unique<CandidateList>();
  list_candidates(base, Grids{}, *out);
  return out;
}

/// One instant of frame and wheelsets: deflections, velocities, accelerations.
struct Reading {
  double frame, one, two;
  double frame_rate, one_rate, two_rate;
  double frame_accel, one_accel, two_accel;
};
constexpr Reading kInstant{0.7e-3, -0.3e-3, 0.2e-3, 11e-3, 4e-3, 9e-3, 0.3, -2.0, 1.5};
constexpr BaseForce kBase{0.2, 140.0};
constexpr double kWidth = 8e-3;

double sign_of(double velocity) { return std::tanh(velocity / kWidth); }
double tangent_of(double velocity) { return (1.0 - std::pow(sign_of(velocity), 2)) / kWidth; }
/// k y + F(v) with y = 2 z_b - z_1 - z_2.
double force_of(const Reading& x) {
  return kBase.stiffness * (2.0 * x.frame - x.one - x.two) +
         kBase.coulomb * sign_of(2.0 * x.frame_rate - x.one_rate - x.two_rate);
}
Row row_of(const Reading& x) {
  Row row = Row::Zero();
  const double v = 2.0 * x.frame_rate - x.one_rate - x.two_rate;
  row[kFrameTwice] = x.frame;
  row[kFrameOnce] = x.frame_rate;
  row[kWheelset1Twice] = x.one;
  row[kWheelset1Once] = x.one_rate;
  row[kWheelset2Twice] = x.two;
  row[kWheelset2Once] = x.two_rate;
  row[kTangentV] = tangent_of(v) * v;
  row[kTangent1] = tangent_of(v) * x.one_rate;
  row[kTangent2] = tangent_of(v) * x.two_rate;
  row[kTangentRate1] = tangent_of(v) * x.one_accel;
  row[kTangentRate2] = tangent_of(v) * x.two_accel;
  return row;
}
const Regressor& sensor(const CandidateList& list, Effect effect, std::uint8_t form) {
  for (std::size_t i = 0; i < list.count; ++i)
    if (list.item[i].effect == effect && list.item[i].form == form)
      return list.item[i].regressor[0];
  ADD_FAILURE() << "no such candidate";
  return list.item[0].regressor[0];
}

TEST(Candidates, KnowDeflectionAndVelocity) {
  const Row row = row_of(kInstant);
  EXPECT_NEAR(value_of(stiffness_regressor(), row), 1.5e-3, 1e-12);
  EXPECT_NEAR(value_of(viscous_regressor(), row), 9e-3, 1e-12);
}

// With x_true = x (1 - e) of one channel: what the force changes by, to first order in e.
TEST(Candidates, AWrongGainIsTheForcesSlope) {
  constexpr double kSmall = 1e-6;
  const auto list = listed(kBase);
  const Row row = row_of(kInstant);
  for (const auto& [form, deflection, rate] :
       {std::tuple{kFrameForm, &Reading::frame, &Reading::frame_rate},
        std::tuple{kWheelset1Form, &Reading::one, &Reading::one_rate},
        std::tuple{kWheelset2Form, &Reading::two, &Reading::two_rate}}) {
    Reading wrong = kInstant;
    wrong.*deflection *= 1.0 - kSmall;
    wrong.*rate *= 1.0 - kSmall;
    EXPECT_NEAR(value_of(sensor(*list, Effect::kGainError, form), row),
                (force_of(wrong) - force_of(kInstant)) / kSmall, 1e-5)
        << int{form};
  }
}

// With x_true(t) = x(t + tau) of a wheelset; of the frame its own acceleration moves, too.
TEST(Candidates, ALateChannelIsTheForcesSlope) {
  constexpr double kSmall = 1e-7;
  const auto list = listed(kBase);
  Row row = row_of(kInstant);
  for (const auto& [form, deflection, rate, accel] :
       {std::tuple{kWheelset1Form, &Reading::one, &Reading::one_rate, &Reading::one_accel},
        std::tuple{kWheelset2Form, &Reading::two, &Reading::two_rate, &Reading::two_accel}}) {
    Reading later = kInstant;
    later.*deflection += kSmall * later.*rate;
    later.*rate += kSmall * later.*accel;
    // The columns have the wheelsets' sign in y and v: minus.
    EXPECT_NEAR(value_of(sensor(*list, Effect::kTimeSkew, form), row),
                (force_of(later) - force_of(kInstant)) / kSmall, 1e-3)
        << int{form};
  }
  row[kFrameRate] = 5.0;
  EXPECT_NEAR(value_of(sensor(*list, Effect::kTimeSkew, kFrameForm), row),
              5.0 + 2.0 * kBase.stiffness * kInstant.frame_rate, 1e-12);
}

TEST(Candidates, OfChannelsAreRefreshedWithTheBaseForce) {
  const auto list = listed({0.0, 0.0});
  const auto truth = listed(kBase);
  const Row row = row_of(kInstant);
  for (std::size_t i = 0; i < list->count; ++i) {
    Candidate candidate = list->item[i];
    refresh(kBase, candidate);
    EXPECT_EQ(value_of(candidate.regressor[0], row), value_of(truth->item[i].regressor[0], row));
  }
}

// Each effect of the library, each point of its grid, and what lies between two of them.
TEST(Candidates, AreEveryPointOfEveryGrid) {
  const auto list = listed();
  std::map<Effect, std::size_t> points, pairs;
  std::set<std::tuple<Effect, int, int, bool>> seen;
  for (std::size_t i = 0; i < list->count; ++i) {
    const Candidate& c = list->item[i];
    ++(is_pair(c) ? pairs : points)[c.effect];
    EXPECT_TRUE(seen.insert({c.effect, c.form, c.variant, is_pair(c)}).second) << "twice";
    EXPECT_EQ(c.slopes, 0U);
    if (!is_pair(c)) continue;
    ASSERT_EQ(c.count, 2U);
    EXPECT_EQ(c.regressor[1].column[0], c.regressor[0].column[0] + 1) << "neighbours";
  }
  EXPECT_EQ(points,
            (std::map<Effect, std::size_t>{{Effect::kViscous, 1},
                                           {Effect::kAsymmetricViscous, 1},
                                           {Effect::kQuadraticDamping, 1},
                                           {Effect::kViscoelastic, kRelaxations},
                                           {Effect::kProgressiveFriction, 2},
                                           {Effect::kStribeck, kStribeckSpeeds},
                                           {Effect::kPreslidingHysteresis, kDahlDistances},
                                           {Effect::kBacklash, kBacklashGaps},
                                           {Effect::kBumpStop, 3 * kBumpGaps},
                                           {Effect::kCubicStiffness, 1},
                                           {Effect::kQuadraticStiffness, 1},
                                           {Effect::kAsymmetricStiffness, 1},
                                           {Effect::kUnmodelledMode, kPitchModes + kFlexibleModes},
                                           {Effect::kTimeSkew, 3},
                                           {Effect::kGainError, 3}}));
  EXPECT_EQ(pairs,
            (std::map<Effect, std::size_t>{{Effect::kViscoelastic, kRelaxations - 1},
                                           {Effect::kPreslidingHysteresis, kDahlDistances - 1},
                                           {Effect::kBacklash, kBacklashGaps - 1},
                                           {Effect::kUnmodelledMode, kFlexibleModes - 1}}));
}

// Damping damps, friction holds, stops push back; a spring or a skew may have either sign.
TEST(Candidates, HaveTheSignThatTheyCanHave) {
  const auto list = listed();
  for (std::size_t i = 0; i < list->count; ++i) {
    const Candidate& c = list->item[i];
    const bool any =
        c.effect == Effect::kAsymmetricViscous || c.effect == Effect::kProgressiveFriction ||
        c.effect == Effect::kCubicStiffness || c.effect == Effect::kQuadraticStiffness ||
        c.effect == Effect::kAsymmetricStiffness || c.effect == Effect::kTimeSkew ||
        c.effect == Effect::kGainError;
    const bool mass = c.effect == Effect::kUnmodelledMode && c.form == kFlexibleForm;
    EXPECT_EQ(int{c.sign}, any ? 0 : mass ? -1 : 1) << name_of(c.effect);
  }
}

// A gap that is reached pushes against the deflection, on one side or on both.
TEST(Candidates, StopsPushAgainstTheDeflection) {
  const auto list = listed();
  for (std::size_t i = 0; i < list->count; ++i) {
    const Candidate& c = list->item[i];
    if (c.effect != Effect::kBumpStop) continue;
    Row up = Row::Zero();
    Row down = Row::Zero();
    up[kBumpUp + c.variant] = 1.0;
    down[kBumpDown + c.variant] = 1.0;
    EXPECT_EQ(value_of(c.regressor[0], up), c.form == kOneSidedDown ? 0.0 : 1.0);
    EXPECT_EQ(value_of(c.regressor[0], down), c.form == kOneSidedUp ? 0.0 : -1.0);
  }
}

/// The columns of a slope, by number.
std::map<int, double> columns_of(const Candidate& candidate, std::size_t regressor) {
  std::map<int, double> out;
  const Regressor& r = candidate.regressor[regressor];
  for (std::size_t p = 0; p < r.count; ++p) out[r.column[p]] += r.weight[p];
  return out;
}
Candidate point(Effect effect, std::uint8_t variant, std::uint8_t form = kPlainForm) {
  Candidate out{.effect = effect, .variant = variant, .form = form, .count = 1};
  return out;
}
using SlopeColumns = std::map<int, double>;

// A step of the grid: half the difference of the neighbours, or the whole to the only one.
TEST(CandidateSlopes, AreDifferencesAlongTheGrid) {
  const Grids grids;
  for (const auto& [effect, column, points] :
       {std::tuple{Effect::kStribeck, int{kStribeck}, kStribeckSpeeds},
        std::tuple{Effect::kViscoelastic, int{kRelaxing}, kRelaxations},
        std::tuple{Effect::kPreslidingHysteresis, int{kDahl}, kDahlDistances},
        std::tuple{Effect::kBacklash, int{kBacklash}, kBacklashGaps}}) {
    const int last = static_cast<int>(points) - 1;
    for (int i = 0; i <= last; ++i) {
      const Candidate found = with_slopes(point(effect, static_cast<std::uint8_t>(i)), grids);
      ASSERT_EQ(found.count, 2U) << name_of(effect) << i;
      EXPECT_EQ(found.slopes, 1U);
      const int low = std::max(i - 1, 0);
      const int high = std::min(i + 1, last);
      const double weight = 1.0 / (high - low);
      EXPECT_EQ(columns_of(found, 1),
                (SlopeColumns{{column + low, -weight}, {column + high, weight}}));
    }
  }
  const Candidate stop = with_slopes(point(Effect::kBumpStop, 2), grids);
  EXPECT_EQ(
      columns_of(stop, 1),
      (SlopeColumns{
          {kBumpUp + 1, -0.5}, {kBumpUp + 3, 0.5}, {kBumpDown + 1, 0.5}, {kBumpDown + 3, -0.5}}));
  const Candidate down = with_slopes(point(Effect::kBumpStop, 2, kOneSidedDown), grids);
  EXPECT_EQ(columns_of(down, 1), (SlopeColumns{{kBumpDown + 1, 0.5}, {kBumpDown + 3, -0.5}}));
}

// Pitch: three frequencies of each of three slips, of which each has its own slope.
TEST(CandidateSlopes, OfPitchAreThoseOfFrequencyAndSlip) {
  for (int i = 0; i < static_cast<int>(kPitchModes); ++i) {
    const Candidate found = with_slopes(
        point(Effect::kUnmodelledMode, static_cast<std::uint8_t>(i), kPitchForm), Grids{});
    ASSERT_EQ(found.count, 3U);
    EXPECT_EQ(found.slopes, 2U);
    const int line = i / 3 * 3;
    const int low = std::max(i - 1, line);
    const int high = std::min(i + 1, line + 2);
    const double frequency = 1.0 / (high - low);
    EXPECT_EQ(columns_of(found, 1),
              (SlopeColumns{{kPitchSign + low, -frequency}, {kPitchSign + high, frequency}}))
        << i;
    const int less = i >= 3 ? i - 3 : i;
    const int more = i < 6 ? i + 3 : i;
    const double slip = 3.0 / (more - less);
    EXPECT_EQ(columns_of(found, 2),
              (SlopeColumns{{kPitchSign + less, -slip}, {kPitchSign + more, slip}}))
        << i;
  }
}

TEST(CandidateSlopes, AreNoneWithoutAGridNorBetweenItsPoints) {
  EXPECT_EQ(with_slopes(point(Effect::kViscous, 0), Grids{}).count, 1U);
  Candidate pair = point(Effect::kBacklash, 2);
  pair.count = 2;
  EXPECT_EQ(with_slopes(pair, Grids{}).slopes, 0U);
  EXPECT_TRUE(is_pair(pair)) << "two neighbours";
  EXPECT_FALSE(is_pair(with_slopes(point(Effect::kBacklash, 2), Grids{}))) << "a law and its slope";
  pair.effect = Effect::kAsymmetricViscous;
  EXPECT_FALSE(is_pair(pair)) << "two sides";
}

}  // namespace
}  // namespace dampline::effect
