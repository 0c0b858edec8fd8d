// SPDX-License-Identifier: MIT
// Both evidences of linearity of the phase mappings on records whose law is known, and on measured
// ones (DAMPLINE_SHARED_DATA).
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "app/verify/phase/measured.hpp"
#include "tests/shared_data.hpp"

namespace dampline::app {
namespace {

constexpr double kIntervalS = 1.0 / 256.0;

/// y = A sin(2 pi 1.03 t) for 20 s, and the force of a law of y and v.
MeasuredRecord sine(double amplitude_m, const std::function<double(double, double)>& force_n) {
  MeasuredRecord out{.name = "sine", .interval_s = kIntervalS};
  const double w = 2.0 * std::numbers::pi * 1.03;
  for (int i = 0; i < 20 * 256; ++i) {
    const double t = i * kIntervalS;
    out.deflection_m.push_back(amplitude_m * std::sin(w * t));
    out.velocity_mps.push_back(amplitude_m * w * std::cos(w * t));
    out.force_n.push_back(force_n(out.deflection_m.back(), out.velocity_mps.back()));
  }
  return out;
}

double linear(double y, double v) { return 5e4 * y + 2e3 * v + 10.0; }
double rubbing(double y, double v) { return 5e4 * y + std::copysign(400.0, v); }
double hardening(double y, double v) { return 5e4 * y + 2e3 * v + 4e7 * y * y * y; }

TEST(MeasuredRecords, CyclesAreThoseOfTheMotion) {
  const auto found = measured_cycles(sine(0.02, linear));
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->period_s, 1.0 / 1.03, 1e-4);
  EXPECT_NEAR(found->amplitude_m, 0.02, 1e-4);
  EXPECT_EQ(found->cycles, 19);
  EXPECT_NEAR(found->sections.phases[2].input.mean(), 0.02, 1e-4);  // a quarter after it rises
  MeasuredRecord once = sine(0.02, linear);
  once.deflection_m.resize(300);
  once.velocity_mps.resize(300);
  once.force_n.resize(300);
  EXPECT_FALSE(measured_cycles(once).has_value());
}

TEST(MeasuredRecords, OfALinearElementHaveBothEvidences) {
  const PlanarityVerdict plane = study_measured_plane(sine(0.02, linear));
  EXPECT_EQ(plane.state, PlanarityState::kLinear);
  EXPECT_LT(plane.index, 1e-9);
  const auto scaling = study_measured_scaling(sine(0.03, linear), sine(0.01, linear));
  ASSERT_TRUE(scaling.has_value());
  EXPECT_EQ(scaling->state, ScalingState::kProportional);
  EXPECT_NEAR(scaling->input_ratio, 3.0, 1e-6);
}

TEST(MeasuredRecords, OfFrictionAndACubicSpringHaveNeither) {
  for (const auto& law : {rubbing, hardening}) {
    EXPECT_EQ(study_measured_plane(sine(0.02, law)).state, PlanarityState::kNonlinear);
    const auto scaling = study_measured_scaling(sine(0.02, law), sine(0.01, law));
    ASSERT_TRUE(scaling.has_value());
    EXPECT_EQ(scaling->state, ScalingState::kDisproportional);
    EXPECT_GT(scaling->departure, 0.1);
  }
  EXPECT_NEAR(study_measured_plane(sine(0.02, rubbing)).sign_mps2.value, 400.0, 1.0);
}

TEST(MeasuredRecords, OfDifferentPeriodsAreNotCompared) {
  MeasuredRecord slower = sine(0.02, linear);
  slower.interval_s *= 1.05;
  EXPECT_FALSE(study_measured_scaling(sine(0.01, linear), slower).has_value());
  EXPECT_EQ(record_rows({sine(0.01, linear), slower}).size(), 2U);
}

MeasuredRecord measured(const std::string& name) {
  MeasuredRecord out{.name = name, .interval_s = 1.0 / 1024.0};
  for (const auto& row : test::numbers(test::shared_data("friction_damper/" + name + ".csv"))) {
    out.deflection_m.push_back(row.at(1));
    out.velocity_mps.push_back(row.at(2));
    out.force_n.push_back(row.at(3));
  }
  return out;
}

// A banded rotary friction damper with backlash: its force hardly grows with the motion, and hangs
// on where the motion turned.
TEST(MeasuredRecords, OfTheFrictionDamperHaveNeither) {
  const std::vector<MeasuredRecord> records{
      measured("harm_0.5Hz_0.5in"), measured("harm_0.5Hz_1in"), measured("harm_0.5Hz_1.5in")};
  if (records[0].force_n.empty()) GTEST_SKIP() << "no friction_damper in the shared data";
  for (const MeasuredRecord& record : records) {
    EXPECT_GT(study_measured_plane(record).index, 0.3) << record.name;
    const auto cycles = measured_cycles(record);
    ASSERT_TRUE(cycles.has_value()) << record.name;
    EXPECT_NEAR(cycles->period_s, 2.0, 0.01) << record.name;
  }
  const auto scaling = study_measured_scaling(records[0], records[1]);
  ASSERT_TRUE(scaling.has_value());
  EXPECT_EQ(scaling->state, ScalingState::kDisproportional);
  EXPECT_GT(scaling->departure, 0.3);
  const std::vector<PhaseRow> rows = record_rows(records);
  EXPECT_EQ(rows.size(), 6U);
  for (const PhaseRow& row : rows) EXPECT_NE(row.remark.rfind("linear", 0), 0U) << row.what;
  EXPECT_EQ(plot_measured(records[0]).panels.size(), 3U);
}

}  // namespace
}  // namespace dampline::app
