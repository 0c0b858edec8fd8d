// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <limits>
#include <numbers>
#include <utility>

#include "rig_run.hpp"
#include "simulated_rig.hpp"

namespace dampline::test {
namespace {

constexpr double kRateHz = 500.0;
constexpr rig::Terms kDamper{false, false, rig::Branches::kSeparate, rig::Branches::kSeparate,
                             false};

/// A damper with different branches: 800 N + 3000 v for v > 0, -500 N + 5000 v below.
double force_n(double v) { return v > 0.0 ? 800.0 + 3000.0 * v : -500.0 + 5000.0 * v; }

/// Prescribed motion of two incommensurable sines, exact in x and v.
std::vector<rig::Sample> damper_record(double length_s, bool with_velocity) {
  std::vector<rig::Sample> out;
  const double w1 = 2.0 * std::numbers::pi * 0.9;
  const double w2 = 2.0 * std::numbers::pi * 2.3;
  for (std::int64_t tick = 0; tick < static_cast<std::int64_t>(length_s * kRateHz); ++tick) {
    const double t = static_cast<double>(tick) / kRateHz;
    const double v = 0.02 * w1 * std::cos(w1 * t) + 0.01 * w2 * std::cos(w2 * t + 0.4);
    rig::Sample sample;
    sample.tick = tick;
    sample.deflection_m = 0.02 * std::sin(w1 * t) + 0.01 * std::sin(w2 * t + 0.4);
    if (with_velocity) sample.velocity_mps = v;
    sample.force_n = force_n(v);
    out.push_back(sample);
  }
  return out;
}

void expect_branches(const RigRun& run, double limit_percent) {
  ASSERT_TRUE(run.snapshot.valid);
  EXPECT_LT(percent(run.of(rig::Parameter::kCoulombPositive).value, 800.0), limit_percent);
  EXPECT_LT(percent(run.of(rig::Parameter::kCoulombNegative).value, 500.0), limit_percent);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscousPositive).value, 3000.0), limit_percent);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscousNegative).value, 5000.0), limit_percent);
}

TEST(RigIdentifier, TellsTheBranchesOfADamperApart) {
  expect_branches(run_rig(damper_record(30.0, false), kRateHz, kDamper), 1.0);
}

TEST(RigIdentifier, UsesTheMeasuredVelocityWhereThereIsOne) {
  expect_branches(run_rig(damper_record(30.0, true), kRateHz, kDamper), 0.5);
  auto record = damper_record(30.0, true);
  for (rig::Sample& sample : record) sample.velocity_mps *= 2.0;
  const RigRun run = run_rig(record, kRateHz, kDamper);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscousPositive).value, 1500.0), 1.0);
}

TEST(RigPredictor, PassesOverSamplesWhoseTicksDoNotRise) {
  const auto record = damper_record(10.0, true);
  std::vector<rig::Sample> twice;
  for (const rig::Sample& sample : record) {
    twice.push_back(sample);
    twice.push_back(sample);
    twice.back().force_n = 1e6;
  }
  const rig::Config config = run_rig(record, kRateHz, kDamper).config;
  const auto errors_of = [&](const std::vector<rig::Sample>& samples) {
    const auto identifier = identify(record, config);
    const auto predictor = std::make_unique<rig::Predictor>(config, identifier->solution(kDamper),
                                                            identifier->block_samples());
    rig::Prediction prediction;
    for (const rig::Sample& sample : samples) predictor->update(sample, prediction);
    return predictor->errors();
  };
  EXPECT_EQ(errors_of(twice).samples, errors_of(record).samples);
  EXPECT_EQ(errors_of(twice).nmse, errors_of(record).nmse);
}

TEST(RigIdentifier, DrawsBothBranchesOfTheCurveWithTheirSupport) {
  const auto record = damper_record(30.0, false);
  const RigRun run = run_rig(measure(record, {1e-6, 0.0, 20.0, 0.0}, 5), kRateHz, kDamper);
  const rig::Curve& curve = run.snapshot.curve;
  ASSERT_TRUE(curve.valid);
  ASSERT_EQ(curve.size, rig::kCurvePoints);
  std::uint64_t samples = 0;
  for (std::size_t i = 0; i < curve.size; ++i) {
    const CurvePoint& point = curve.points[i];
    EXPECT_GE(point.velocity_mps, i > 0 ? curve.points[i - 1].velocity_mps : -1.0);
    const bool positive = i > kCurveSegments;
    const double tiny = positive ? 1e-12 : -1e-12;
    EXPECT_NEAR(point.force_n, force_n(point.velocity_mps + tiny), 12.0) << point.velocity_mps;
    EXPECT_GT(point.std_n, 0.0);
    EXPECT_LT(point.std_n, 20.0);
    samples += point.samples;
  }
  EXPECT_GT(samples, record.size() - 20);
}

TEST(RigIdentifier, ExcludesAndCountsGapsAndValuesThatAreNoNumber) {
  auto record = damper_record(30.0, false);
  const rig::Config config = run_rig(record, kRateHz, kDamper).config;
  record[4000].force_n = std::numeric_limits<double>::quiet_NaN();
  record[5000].deflection_m = std::numeric_limits<double>::infinity();
  record.erase(record.begin() + 7000, record.begin() + 7300);
  record[9000].tick = record[8999].tick;
  const auto identifier = identify(record, config);
  const rig::Snapshot snapshot = identifier->snapshot(kDamper);
  EXPECT_EQ(snapshot.counts.samples, record.size());
  EXPECT_EQ(snapshot.counts.not_finite, 2U);
  EXPECT_EQ(snapshot.counts.repeated, 1U);
  EXPECT_EQ(snapshot.counts.gaps, 2U);  // the erased stretch, and the repeated tick's own place
  EXPECT_EQ(snapshot.counts.lost, 301U);
  rig::Sample next = record.back();
  ++next.tick;
  EXPECT_EQ(identifier->update(next), rig::Status::kUsed);
  next.tick += 2;
  EXPECT_EQ(identifier->update(next), rig::Status::kGap);
  RigRun run;
  run.snapshot = snapshot;
  expect_branches(run, 1.0);
}

TEST(RigIdentifier, LeavesOutStandstill) {
  auto record = damper_record(20.0, false);
  const rig::Config config = run_rig(record, kRateHz, kDamper).config;
  const std::int64_t end = record.back().tick;
  for (std::int64_t tick = 1; tick <= 5000; ++tick) {
    rig::Sample still = record.back();
    still.tick = end + tick;
    still.force_n = 321.0;  // whatever the rig holds while it stands
    record.push_back(still);
  }
  RigRun run;
  run.snapshot = identify(record, config)->snapshot(kDamper);
  EXPECT_GT(run.snapshot.counts.rows_still, 300U);
  expect_branches(run, 1.5);
}

TEST(RigIdentifier, KeepsItsMemoryFixedOverALongRecord) {
  const auto record = damper_record(30.0, false);
  rig::Config config = run_rig(record, kRateHz, kDamper).config;
  const rig::Snapshot coarse = identify(record, config)->snapshot(kDamper);
  config.block_samples = 30;  // 500 blocks' worth: the store has to merge
  const auto identifier = identify(record, config);
  EXPECT_EQ(identifier->block_samples(), 120);
  const rig::Snapshot merged = identifier->snapshot(kDamper);
  for (std::size_t i = 0; i < coarse.size; ++i) {
    const double value = coarse.estimates[i].estimate.value;
    EXPECT_NEAR(merged.estimates[i].estimate.value, value, 1e-9 * std::abs(value));
  }
}

TEST(RigIdentifier, IsNotReadyBeforeItHasEnoughBlocks) {
  const auto record = damper_record(30.0, false);
  const rig::Config config = run_rig(record, kRateHz, kDamper).config;
  EXPECT_FALSE(identify(std::span{record}.first(100), config)->snapshot(kDamper).valid);
  EXPECT_FALSE(identify({}, config)->snapshot(kDamper).valid);
}

TEST(RigIdentifier, LeavesAnUnknownOutThatTheMotionDoesNotShow) {
  std::vector<rig::Sample> record = damper_record(30.0, false);
  const rig::Config config = run_rig(record, kRateHz, kDamper).config;
  for (rig::Sample& sample : record) {  // one direction only
    sample.deflection_m =
        1e-3 * static_cast<double>(sample.tick) / kRateHz * 100.0 + 1e-3 * sample.deflection_m;
    sample.force_n = 800.0;
  }
  const rig::Snapshot snapshot = identify(record, config)->snapshot(kDamper);
  for (std::size_t i = 0; i < snapshot.size; ++i)
    EXPECT_NE(snapshot.estimates[i].parameter, rig::Parameter::kViscousNegative);
}

}  // namespace
}  // namespace dampline::test
