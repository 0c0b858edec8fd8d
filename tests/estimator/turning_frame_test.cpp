// SPDX-License-Identifier: MIT
// Two more accelerometers: over wheelset 1 on the frame, which shows its pitch, and on the other
// truck's frame, whose mass pushes on this end.
#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <vector>

#include "tests/estimator/record.hpp"
#include "tests/pitching_car.hpp"

namespace dampline {
namespace {

/// Its record, made once.
struct CarRecord {
  EstimatorConfig config;
  std::vector<Sample> record;
};
const CarRecord& pitching_car() {
  static const CarRecord kCar = [] {
    const test::PitchingCar car;
    return CarRecord{car.estimator, simulate(car.simulation, 35.0)};
  }();
  return kCar;
}

TEST(TurningFrame, IsATruckAgainWhereItsPitchIsMeasured) {
  for (const double corner_hz : {0.7, 1.0}) {
    EstimatorConfig config = pitching_car().config;
    config.velocity_corner_hz = corner_hz;
    const Snapshot found = identify(pitching_car().record, config).snapshot;
    ASSERT_TRUE(found.valid);
    EXPECT_NEAR(found.coulomb_n.value / kLadenCoulombN, 1.0, 0.015) << corner_hz;
    EXPECT_NEAR(found.stiffness_npm.value / kLadenStiffnessNpm, 1.0, 0.04) << corner_hz;
  }
}

TEST(TurningFrame, HidesATenthOfTheLevelWhereItsPitchIsNotMeasured) {
  EstimatorConfig config = pitching_car().config;
  config.frame_pitch_mass_kg = 0.0;
  const Snapshot found = identify(pitching_car().record, config).snapshot;
  EXPECT_LT(found.coulomb_n.value, 0.93 * kLadenCoulombN);
}

/// Samples [2400, end) of a laden car whose frame's end moves as its middle does, or has no sensor,
/// for an estimator whose rows are so much later. It stands still in the middle; the wheelsets move
/// alike.
std::unique_ptr<Statistics> without_turn(double pitch_mass_kg, std::size_t end, std::size_t later) {
  const auto estimator =
      std::make_unique<Estimator>(EstimatorConfig{.frame_pitch_mass_kg = pitch_mass_kg});
  for (std::size_t i = 0; i < end + later; ++i) {
    Sample sample = laden_record()[i];
    if (i > 6000 && i < 9000) sample.accel_mps2.fill(1e-4 * static_cast<double>(i % 7));
    sample.extra_mps2[0] = static_cast<float>(sample.accel_mps2[0]);
    sample.accel_mps2[0] = sample.extra_mps2[0];
    sample.accel_mps2[2] = sample.accel_mps2[1];
    if (i == 2400 + later) estimator->clear_statistics();
    estimator->update(sample);
  }
  auto out = std::make_unique<Statistics>();
  estimator->export_statistics(*out);
  return out;
}

/// By which rows are later where the frame's turn is in them.
std::size_t delay_samples() {
  const auto plain = std::make_unique<Estimator>(EstimatorConfig{});
  const auto turned = std::make_unique<Estimator>(EstimatorConfig{.frame_pitch_mass_kg = 2000.0});
  return static_cast<std::size_t>(
      std::lround(300.0 * (turned->row_latency_s() - plain->row_latency_s())));
}

// As late as the latency says.
TEST(TurningFrame, ThatDoesNotTurnIsAFrameWithoutItsSensorOnlyLater) {
  const std::size_t delay = delay_samples();
  EXPECT_GT(delay, 50U);
  for (const std::size_t end : {3000U, 5000U, 12000U}) {
    const auto plain = without_turn(0.0, end, 0);
    const auto turned = without_turn(2000.0, end, delay);
    EXPECT_GT(plain->header.counts.rows, 200U);
    EXPECT_EQ(plain->header.counts.rows, turned->header.counts.rows);
    EXPECT_EQ(plain->header.counts.rows_still, turned->header.counts.rows_still);
    for (std::size_t s = 0; s < kScales; ++s)
      EXPECT_TRUE(plain->total.factor[s].packed() == turned->total.factor[s].packed()) << s;
  }
}

/// Statistics of a stretch from sample 2001 of the pitching car on; of those ahead `length` are
/// good, but for the last.
std::unique_ptr<Statistics> after_a_stretch_of(std::size_t length) {
  const auto estimator = std::make_unique<Estimator>([] {
    EstimatorConfig config = pitching_car().config;
    config.velocity_corner_hz = 0.7;
    return config;
  }());
  for (std::size_t i = 0; i < 6000; ++i) {
    Sample sample = pitching_car().record[i];
    if (i < 2000 - length || i == 2000) sample.saturated = 1;
    estimator->update(sample);
  }
  estimator->finish();
  auto out = std::make_unique<Statistics>();
  estimator->export_statistics(*out);
  return out;
}

TEST(TurningFrame, AStretchThatIsTooShortForARowLeavesNoTurnBehind) {
  const auto alone = after_a_stretch_of(0);
  ASSERT_GT(alone->header.counts.rows, 0U);
  for (const std::size_t length : {100U, 400U, 700U}) {
    const auto with = after_a_stretch_of(length);
    ASSERT_EQ(with->header.counts.rows, alone->header.counts.rows) << length;
    for (std::size_t s = 0; s < kScales; ++s)
      EXPECT_TRUE(with->total.factor[s].packed() == alone->total.factor[s].packed()) << length;
  }
}

std::uint64_t basis_of(const EstimatorConfig& config) {
  const auto out = std::make_unique<Statistics>();
  std::make_unique<Estimator>(config)->export_statistics(*out);
  return out->header.basis_hash;
}

TEST(TurningFrame, HasABasisOfItsOwnForEachMass) {
  const std::uint64_t plain = basis_of({});
  EXPECT_NE(plain, basis_of({.frame_pitch_mass_kg = 1850.0}));
  EXPECT_NE(plain, basis_of({.far_mass_kg = 1850.0}));
  EXPECT_NE(basis_of({.far_mass_kg = 1850.0}), basis_of({.far_mass_kg = 1851.0}));
  EXPECT_NE(basis_of({.frame_pitch_mass_kg = 1850.0}), basis_of({.frame_pitch_mass_kg = 1851.0}));
  EXPECT_EQ(basis_of({.moving_mass_kg = 100.0, .far_mass_kg = 10.0}),
            basis_of({.moving_mass_kg = 200.0, .far_mass_kg = 20.0}))
      << "it is their share that counts";
  EXPECT_NE(plain, basis_of({.anti_alias = {.order = 3}}));
}

TEST(TurningFrame, NeedsMassesThatAreSome) {
  const auto accepted = [](double far_kg, double pitch_kg) {
    return Estimator::check({.frame_pitch_mass_kg = pitch_kg, .far_mass_kg = far_kg}).ok();
  };
  EXPECT_TRUE(accepted(1.0, 1.0));
  for (const double none :
       {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(accepted(none, 1.0)) << none;
    EXPECT_FALSE(accepted(1.0, none)) << none;
  }
}

TEST(TurningFrame, IsNothingForSmallParts) {
  EXPECT_FALSE(SmallEstimator::check({.frame_pitch_mass_kg = 1850.0}).ok());
  EXPECT_TRUE(SmallEstimator::check({.far_mass_kg = 1850.0}).ok());
}

}  // namespace
}  // namespace dampline
