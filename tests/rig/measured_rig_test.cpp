// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "rig_run.hpp"
#include "tests/shared_data.hpp"

namespace dampline::test {
namespace {

std::vector<rig::Sample> emps() {
  std::vector<rig::Sample> out;
  for (const auto& row : numbers(shared_data("emps/emps_train.csv"))) {
    rig::Sample sample;
    sample.tick = static_cast<std::int64_t>(out.size());
    sample.deflection_m = row[1];
    sample.force_n = 35.15065188 * row[3];
    out.push_back(sample);
  }
  return out;
}

std::vector<rig::Sample> damper(const std::string& name) {
  std::vector<rig::Sample> out;
  for (const auto& row : numbers(shared_data("friction_damper/" + name)))
    out.push_back({static_cast<std::int64_t>(out.size()), row[1], row[2], row[3]});
  return out;
}

TEST(MeasuredEmps, GivesThePublishedParameters) {
  const auto record = emps();
  if (record.empty()) GTEST_SKIP() << "no emps/emps_train.csv in the shared data";
  const rig::Terms terms{true, false, rig::Branches::kCommon, rig::Branches::kCommon, true};
  const RigRun run = run_rig(record, 1000.0, terms);
  ASSERT_TRUE(run.snapshot.valid);
  EXPECT_NEAR(run.config.corner_hz, 20.0, 1.0);
  EXPECT_LT(percent(run.of(rig::Parameter::kMovingMass).value, 95.1089), 1.5);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscous).value, 203.5034), 1.5);
  EXPECT_LT(percent(run.of(rig::Parameter::kCoulomb).value, 20.3935), 1.5);
  EXPECT_LT(percent(run.of(rig::Parameter::kOffset).value, -3.1648), 5.0);
  EXPECT_LT(std::sqrt(run.snapshot.held_out_nmse), 0.045);  // .0368 with the same filter elsewhere
  EXPECT_LT(std::sqrt(run.errors.held_out_nmse), 0.06);
}

TEST(MeasuredEmps, ShowsItsDirectionDependentViscousFriction) {
  const auto record = emps();
  if (record.empty()) GTEST_SKIP() << "no emps/emps_train.csv in the shared data";
  const rig::Terms terms{true, false, rig::Branches::kSeparate, rig::Branches::kSeparate, false};
  const RigRun run = run_rig(record, 1000.0, terms);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscousPositive).value, 166.2), 1.5);
  EXPECT_LT(percent(run.of(rig::Parameter::kViscousNegative).value, 240.1), 1.5);
  EXPECT_LT(std::sqrt(run.snapshot.nmse), 0.027);
}

TEST(MeasuredFrictionDamper, IsPoorlyExplainedByCoulombAndViscousFriction) {
  const auto record = damper("harm_1Hz_1in.csv");
  if (record.empty()) GTEST_SKIP() << "no friction_damper/harm_1Hz_1in.csv in the shared data";
  const rig::Terms terms{false, false, rig::Branches::kSeparate, rig::Branches::kSeparate, false};
  const RigRun run = run_rig(record, 1024.0, terms);
  ASSERT_TRUE(run.snapshot.valid);
  const double rrse = std::sqrt(run.errors.nmse);
  EXPECT_GT(rrse, 0.60);
  EXPECT_LT(rrse, 0.66);
  EXPECT_GE(run.errors.held_out_nmse, run.errors.nmse);
  EXPECT_EQ(run.snapshot.curve.size, rig::kCurvePoints);
}

}  // namespace
}  // namespace dampline::test
