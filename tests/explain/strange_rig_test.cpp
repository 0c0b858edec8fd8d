// SPDX-License-Identifier: MIT
// One rig, written down as other people's programs do.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "app/error.hpp"
#include "tests/explain/explained_rig.hpp"

namespace dampline::app {
namespace {

using dampline::test::explained;
using ::testing::HasSubstr;

struct Row {
  double time_s, deflection_m, velocity_mps, accel_mps2, force_n;
};

/// Dry friction of 300 N and 2000 N s/m that grows with the speed, nothing in the units' way.
std::vector<Row> rows(const std::vector<double>& times) {
  std::mt19937_64 random{71};
  std::normal_distribution<double> noise;
  std::vector<Row> out;
  for (const double t : times) {
    Row row{t, 2e-7 * noise(random), 0.0, 0.0, 2.0 * noise(random)};
    const double tones[][3] = {{0.008, 0.41, 0.3}, {0.004, 1.07, 1.0}, {0.0012, 2.6, 2.0}};
    for (const auto& [amplitude, hz, phase] : tones) {
      const double w = 2.0 * M_PI * hz;
      row.deflection_m += amplitude * std::sin(w * t + phase);
      row.velocity_mps += amplitude * w * std::cos(w * t + phase);
      row.accel_mps2 -= amplitude * w * w * std::sin(w * t + phase);
    }
    const double v = row.velocity_mps;
    row.force_n += (v < 0.0 ? -300.0 : 300.0) + 2000.0 * v + 5e4 * v * std::abs(v);
    out.push_back(row);
  }
  return out;
}

std::vector<double> uniform() {
  std::vector<double> out;
  for (int i = 0; i < 12000; ++i) out.push_back(i / 400.0);
  return out;
}

/// Time, deflection and force times their factors, in the shape of `line`.
std::string table(const std::string& head, fmt::string_view line, double time = 1.0,
                  double deflection = 1.0, double force = 1.0) {
  std::string out = head;
  for (const Row& r : rows(uniform()))
    out += fmt::format(fmt::runtime(line), time * r.time_s, deflection * r.deflection_m,
                       force * r.force_n);
  return out;
}

std::string error_of(const std::string& text) {
  try {
    static_cast<void>(explained(text));
  } catch (const RunError& error) {
    return error.what();
  }
  return "none";
}

void expect_quadratic(const rig::Explanation& found) {
  ASSERT_EQ(found.steps.size(), 1U) << summarize(found);
  EXPECT_EQ(found.steps[0].effect, "quadratic_damping");
  EXPECT_NEAR(found.steps[0].parameters[0].value, 5e4, 2.5e3);
}

TEST(AStrangersRig, IsReadByTheUnitsInItsHeader) {
  expect_quadratic(explained(table("Time [ms];Displacement (mm);Force in kN\n",
                                   "{:.4f};{:.7f};{:.7f}\n", 1e3, 1e3, 1e-3)));
  expect_quadratic(explained(table("% from a data logger\nt_s\tstroke_mm\tload_lbf\n",
                                   "{:.6f}\t{:.7f}\t{:.7f}\n", 1.0, 1e3, 1.0 / 4.4482216)));
  expect_quadratic(
      explained(table("Time,Position,Load\ns,mm,N\n", "{:.6f},{:.7f},{:.7f}\n", 1.0, 1e3)));
  expect_quadratic(
      explained(table("# rig\n# time_s,deflection_m,force_n\n", "{:.6f},{:.10f},{:.7f}\n")));
}

TEST(AStrangersRig, IsNotGuessedAt) {
  const char* line = "{:.6f},{:.10f},{:.7f}\n";
  EXPECT_THAT(error_of(table("time,displacement,force\n", line)),
              HasSubstr("deflection_m = 0.001 # if it is in mm"));
  EXPECT_THAT(error_of(table("Time [s],Position [mm],Force A [N]\n", line)), "none");
  EXPECT_THAT(error_of(table("time_s,Force A [N],Force B [N]\n", line)),
              HasSubstr("\"Force A [N]\", \"Force B [N]\""));
  EXPECT_THAT(error_of(table("time_s,velocity_mps,force_n\n", line)),
              HasSubstr("needs its deflection"));
  EXPECT_THAT(error_of(table("time_s,deflection_m,force_n\ns,mm,N\n", line)),
              HasSubstr("[input.scale]\ndeflection_m = 0.001"));
  EXPECT_THAT(error_of(table("time_s,deflection_m,force_n\nold,new,blue\n", line)),
              HasSubstr("expected a number or a unit"));
}

TEST(AStrangersRig, MayStandStillForLongBeforeItMoves) {
  std::string text = "time_s,deflection_m,force_n\n";
  const std::vector<Row> moving = rows(uniform());
  const auto rest = static_cast<int>(moving.size()) / 3;
  for (int i = 0; i < rest; ++i)
    text += fmt::format("{:.6f},{:.10f},{:.6f}\n", i / 400.0, moving[0].deflection_m,
                        moving[static_cast<std::size_t>(i)].force_n * 1e-3);
  for (const Row& r : moving)
    text +=
        fmt::format("{:.6f},{:.10f},{:.6f}\n", r.time_s + rest / 400.0, r.deflection_m, r.force_n);
  expect_quadratic(explained(text));
}

std::string with_rate(const char* name, double Row::*rate, double factor) {
  std::string out = fmt::format("time_s,deflection_m,{},force_n\n", name);
  for (const Row& r : rows(uniform()))
    out += fmt::format("{:.6f},{:.10f},{:.8f},{:.6f}\n", r.time_s, r.deflection_m,
                       factor * (r.*rate), r.force_n);
  return out;
}

TEST(AStrangersRig, IsToldOfARateThatIsNotItsOwn) {
  EXPECT_THAT(error_of(with_rate("velocity_mps", &Row::velocity_mps, 1e3)),
              HasSubstr("velocity_mps = 0.001"));
  EXPECT_THAT(error_of(with_rate("velocity_mps", &Row::velocity_mps, -1.0)),
              HasSubstr("velocity_mps = -1"));
  EXPECT_THAT(error_of(with_rate("velocity_mps", &Row::force_n, 1.0)), HasSubstr("expected"));
}

double named_gain(const rig::Explanation& found) {
  for (const app::Step& step : found.steps)
    if (step.effect == "gain_error") return step.parameters[0].value;
  return 0.0;
}

TEST(AStrangersRigNightly, IsToldOfAWrongSensitivity) {
  EXPECT_NEAR(named_gain(explained(with_rate("velocity_mps", &Row::velocity_mps, 1.037))), 3.7,
              0.1);
  EXPECT_NEAR(named_gain(explained(with_rate("accel_mps2", &Row::accel_mps2, 0.943))), -5.7, 0.2);
  EXPECT_EQ(named_gain(explained(with_rate("velocity_mps", &Row::velocity_mps, 1.0))), 0.0);
  EXPECT_EQ(named_gain(explained(with_rate("accel_mps2", &Row::accel_mps2, 1.0))), 0.0);
}

TEST(AStrangersRig, MayHaveItsTimesRounded) {
  std::string text = "time_s,deflection_m,force_n\n";
  for (const Row& r : rows(uniform()))
    text += fmt::format("{:.3f},{:.10f},{:.6f}\n", r.time_s, r.deflection_m, r.force_n);
  expect_quadratic(explained(text));
}

TEST(AStrangersRig, MayHaveNoTimeWhereItsRateIsGiven) {
  std::string text = "deflection_m,force_n\n";
  for (const Row& r : rows(uniform()))
    text += fmt::format("{:.10f},{:.6f}\n", r.deflection_m, r.force_n);
  EXPECT_THAT(error_of(text), HasSubstr("sample_rate_hz"));
  Config config = dampline::test::two_terms();
  config.input.sample_rate_hz = 400.0;
  config.input.sample_rate_is_set = true;
  expect_quadratic(explained(text, config));
}

TEST(AStrangersRig, IsResampledWhereItsTimesWander) {
  std::mt19937_64 random{72};
  std::uniform_real_distribution<double> step{0.5, 1.5};
  std::vector<double> times{0.0};
  while (times.size() < 12000) times.push_back(times.back() + step(random) / 400.0);
  std::string text = "time_s,deflection_m,force_n\n";
  for (const Row& r : rows(times))
    text += fmt::format("{:.7f},{:.10f},{:.6f}\n", r.time_s, r.deflection_m, r.force_n);
  const rig::Explanation found = explained(text);
  ASSERT_FALSE(found.notes.empty());
  EXPECT_THAT(found.notes[0], HasSubstr("not uniform"));
  for (const app::Step& s : found.steps) EXPECT_EQ(s.effect, "quadratic_damping");
  EXPECT_LT(found.final.fit.held_out_nmse, 0.03);
}

TEST(AStrangersRig, CountsItsDeflectionFromTheMiddleWhereZeroIsFar) {
  std::string text = "time_s,deflection_m,force_n\n";
  for (const Row& r : rows(uniform()))
    text += fmt::format("{:.6f},{:.10f},{:.6f}\n", r.time_s, r.deflection_m + 0.35, r.force_n);
  expect_quadratic(explained(text));
}

/// Friction that rounds its sign, as simulations write it, beside the spring of the rig: neither is
/// an effect that a damper lacks. Widths lie between those that are tried.
TEST(AStrangersRig, MayHaveASmoothLawAndASpring) {
  for (const double width_mps : {0.0007, 0.0023, 0.0081, 0.018}) {
    std::mt19937_64 random{73};
    std::normal_distribution<double> noise;
    std::string text = "time_s,deflection_m,force_n\n";
    for (const Row& r : rows(uniform()))
      text += fmt::format("{:.6f},{:.10f},{:.6f}\n", r.time_s, r.deflection_m,
                          300.0 * std::tanh(r.velocity_mps / width_mps) + 1.1e5 * r.deflection_m +
                              5.0 * noise(random));
    const rig::Explanation found = explained(text);
    EXPECT_TRUE(found.steps.empty()) << summarize(found);
    EXPECT_TRUE(found.is_complete()) << summarize(found);
    ASSERT_FALSE(found.notes.empty());
    EXPECT_THAT(found.notes[0], HasSubstr("A linear spring"));
    EXPECT_NEAR(found.final.fit.theta[0], 300.0, 3.0);
    for (const Parameter& p : found.final.parameters) {
      if (p.name != "law_width") continue;
      EXPECT_NEAR(p.value, width_mps, 0.1 * width_mps);
    }
  }
}

TEST(AStrangersRig, IsToldOfAForceThatDrifts) {
  std::string text = "time_s,deflection_m,force_n\n";
  for (const Row& r : rows(uniform())) {
    const double drift_n = 240.0 * (r.time_s / 30.0 - 0.5);
    text += fmt::format("{:.6f},{:.10f},{:.6f}\n", r.time_s, r.deflection_m, r.force_n + drift_n);
  }
  const rig::Explanation found = explained(text);
  ASSERT_FALSE(found.steps.empty());
  EXPECT_EQ(found.steps[0].effect, "time_drift");
  EXPECT_EQ(found.steps[0].parameters[0].name, "time_drift_offset");
  EXPECT_NEAR(found.steps[0].parameters[0].value, 240.0, 8.0);
}

}  // namespace
}  // namespace dampline::app
