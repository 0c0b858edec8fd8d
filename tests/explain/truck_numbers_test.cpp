// SPDX-License-Identifier: MIT
// What an explanation of a truck prints: deviations that hold, errors that chain.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <string>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/explanation.hpp"
#include "sim_hw/simulation.hpp"
#include "tests/drivers/temporary_file.hpp"
#include "tests/explain/coverage.hpp"
#include "tests/explain/other_truck.hpp"

namespace dampline::app {
namespace {

using test::Plant;
using test::State;
using test::Truths;

Explained numbers_of(const std::string& record, double mass_kg) {
  const test::TemporaryFile file{record, ".csv"};
  Config config;
  config.car.moving_mass_kg = mass_kg;
  return explain_truck(config, {{file.path(), false}, {}, false});
}

/// One "before", errors that fall from step to step, and no runner-up that leaves less.
void expect_chain(const Explained& found) {
  const effect::Explanation& e = found.explanation;
  double before = base_error(e);
  for (std::size_t i = 0; i < e.step_count; ++i) {
    const effect::Step& step = e.step[i];
    EXPECT_DOUBLE_EQ(step.restated_before, before) << summarize(found);
    EXPECT_LT(step.restated_after, before) << summarize(found);
    for (std::size_t r = 0; r < step.runner_up_count; ++r)
      EXPECT_GE(step.runner_up[r].held_out_nmse, step.restated_after) << summarize(found);
    before = step.restated_after;
  }
  EXPECT_DOUBLE_EQ(e.final.held_out_nmse, before) << summarize(found);
}

struct Case {
  Plant plant;
  Truths truths;
};

/// Laws of a few kinds, by the other simulation.
std::array<Case, 4> cases() {
  const Truths base{{"coulomb", test::kCoulombN}, {"stiffness", test::kSpringNpm}};
  const auto with = [&](Truths more) {
    more.insert(more.begin(), base.begin(), base.end());
    return more;
  };
  return {{{{}, base},
           {test::force([](const State& s) { return 97e3 * s.velocity_mps; }),
            with({{"viscous", 97e3}})},
           {test::force([](const State& s) { return 4.4e11 * std::pow(s.deflection_m, 3); }),
            with({{"cubic_stiffness", 4.4e11}})},
           {test::presliding(1.5e-4, 1.0), with({{"presliding_hysteresis_distance", 1.5e-4}})}}};
}

TEST(ATrucksNumbers, HoldWhatTheirDeviationsSay) {
  test::Coverage all;
  std::string text;
  for (const Case& c : cases()) {
    for (const std::uint64_t seed : {91U, 92U}) {
      const Explained found =
          numbers_of(test::record_of(c.plant, seed, 120.0, seed), test::kMassKg);
      expect_chain(found);
      test::compare(found.explanation, c.truths,
                    [&](const std::string& name, const Estimate& estimate, double truth) {
                      all.add(estimate, truth);
                      text += fmt::format("{} {} ± {}, truth {}\n", name, estimate.value,
                                          estimate.std, truth);
                    });
    }
  }
  ASSERT_GE(all.records, 18U);
  EXPECT_GE(all.within_share(), 0.8) << text;
  EXPECT_LT(all.rms(), 1.6) << text;
  EXPECT_GT(all.rms(), 0.5) << text;
}

TEST(ATrucksNumbers, ChainWhereAChannelIsLate) {
  Plant late;
  late.frame_late = 7 * test::kFine / 16;
  const Explained found = numbers_of(test::record_of(late, 93), test::kMassKg);
  ASSERT_EQ(found.explanation.step_count, 1U) << summarize(found);
  expect_chain(found);
  EXPECT_GT(base_error(found.explanation), 1.1 * found.explanation.final.held_out_nmse);
}

// Of 0.5 to 1 ms a fifth was missing, 10 deviations.
TEST(ATrucksNumbersNightly, SayHowLateAChannelIsBelowAMillisecond) {
  for (const std::size_t steps : {9U, 13U, 17U}) {
    Plant plant;
    plant.frame_late = steps;
    const Explained found = numbers_of(test::record_of(plant, 93, 300.0, 93), test::kMassKg);
    expect_chain(found);
    const double late_s = (static_cast<double>(steps) - 0.5) * test::kStepS;
    ASSERT_EQ(found.explanation.step_count, 1U) << summarize(found);
    const auto& told = found.explanation.step[0].parameter[0];
    EXPECT_STREQ(told.name, "time_skew_frame");
    EXPECT_NEAR(told.estimate.value / late_s, 1.0, 0.12) << summarize(found);
    test::compare(found.explanation,
                  {{"coulomb", test::kCoulombN},
                   {"stiffness", test::kSpringNpm},
                   {"time_skew_frame", late_s}},
                  [](const std::string& name, const Estimate& estimate, double truth) {
                    EXPECT_LT(std::abs(estimate.value - truth), 3.0 * estimate.std) << name;
                  });
  }
}

TEST(ATrucksNumbers, AreNotExplainedWhereNothingIsMissing) {
  // Once called an asymmetric stiffness that hardly gained.
  const sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 41);
  sim::Simulation simulation{config};
  std::string record = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
  for (int n = 0; n < 300 * sim::kSampleRateHz; ++n) {
    const sim::SimulatedSample sample = simulation.next();
    record += fmt::format("{:.6f}", sample.time_s);
    for (const double a : sample.accel_mps2) record += fmt::format(",{:.6f}", a);
    record += '\n';
  }
  const Explained found = numbers_of(record, config.truck.moving_mass_kg);
  EXPECT_EQ(found.explanation.conclusion, effect::Conclusion::kComplete) << summarize(found);
}

/// A dozen and a half of blocks: what a few of them gain is no effect, and what two steps of their
/// levels show is no change.
TEST(ATruckOfHalfAMinute, LacksNothingWhereNothingIsMissing) {
  struct Ride {
    std::uint64_t seed;
    double length_s;
    sim::Load load;
  };
  for (const Ride& ride : {Ride{1, 35.0, sim::Load::kLaden}, Ride{1, 36.0, sim::Load::kLaden},
                           Ride{5, 36.0, sim::Load::kEmpty}, Ride{39, 33.0, sim::Load::kLaden},
                           Ride{52, 36.0, sim::Load::kEmpty}}) {
    const sim::SimulationConfig config = sim::reference_run(ride.load, 80.0, ride.seed);
    sim::Simulation simulation{config};
    std::string text = "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
    for (int i = 0; i < static_cast<int>(300.0 * ride.length_s); ++i) {
      const Sample s = sim::to_sample(simulation.next());
      text += fmt::format("{:.6f},{},{},{}\n", static_cast<double>(i) / 300.0, s.accel_mps2[0],
                          s.accel_mps2[1], s.accel_mps2[2]);
    }
    const Explained found = numbers_of(text, config.truck.moving_mass_kg);
    EXPECT_TRUE(told(found).steps.empty()) << ride.seed << summarize(found);
  }
}

}  // namespace
}  // namespace dampline::app
