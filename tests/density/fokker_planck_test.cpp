// SPDX-License-Identifier: MIT
#include "dampline/density/fokker_planck.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <limits>
#include <utility>

#include "tests/density/white_run.hpp"

namespace dampline {
namespace {

constexpr std::uint64_t kFirstSeed = 101;  // 1...12 served to choose limits and bandwidths
constexpr std::uint64_t kSeeds = 12;

struct Worst {
  double weak{0.0}, weak_curve{0.0}, paper{0.0}, known{0.0}, known_curve{0.0};
};

void note(double& worst, double error) { worst = std::max(worst, std::abs(error)); }

TEST(FokkerPlanck, FindsTheLevelAndTheCurveOfWhiteInput) {
  Worst worst;
  double weak_mean = 0.0;
  double paper_mean = 0.0;
  double pulls = 0.0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + kSeeds; ++seed) {
    const auto run = white_run({.seed = seed}, 300.0);
    const auto found = run->estimates(kMassKg, kStiffnessNpm);
    ASSERT_TRUE(found.weak.verdict.trusted) << seed;
    ASSERT_TRUE(found.paper.verdict.trusted) << seed;
    ASSERT_TRUE(found.known_input.verdict.trusted) << seed;
    const double weak = found.weak.level_n.value / kLevelN - 1.0;
    const double paper = found.paper.level_n.value / kLevelN - 1.0;
    weak_mean += weak / kSeeds;
    paper_mean += paper / kSeeds;
    pulls += std::pow((found.weak.level_n.value - kLevelN) / found.weak.level_n.std, 2) / kSeeds;
    note(worst.weak, weak);
    note(worst.paper, paper);
    note(worst.known, found.known_input.level_n.value / kLevelN - 1.0);
    note(worst.weak_curve, curve_error(found.weak, run->velocities()));
    note(worst.known_curve, curve_error(found.known_input, run->velocities()));
    for (std::size_t i = 0; i < found.weak.points; ++i)
      EXPECT_GT(found.weak.curve[i].std_n, 0.0) << seed << ' ' << i;
  }
  std::cout << "weak: mean " << 100.0 * weak_mean << " %, worst " << 100.0 * worst.weak
            << " %, curve " << 100.0 * worst.weak_curve << " %; paper: mean " << 100.0 * paper_mean
            << " %, worst " << 100.0 * worst.paper << " %; pulls " << std::sqrt(pulls) << '\n';
  EXPECT_LT(worst.weak, 0.03);
  EXPECT_LT(worst.weak_curve, 0.10);
  EXPECT_LT(worst.paper, 0.05);
  EXPECT_LT(worst.known, 1e-3);
  EXPECT_LT(worst.known_curve, 1e-3);
  EXPECT_GT(std::sqrt(pulls), 0.5);  // stated deviations are those that are found
  EXPECT_LT(std::sqrt(pulls), 1.6);
}

TEST(FokkerPlanck, ShowsTheAsymmetryOnlyOfAnAbsoluteDeflection) {
  const sim::WhiteInputConfig white{
      .seed = 5, .friction_positive_n = 9150.0, .friction_negative_n = 7562.0};
  for (const bool absolute : {true, false}) {
    const auto run = white_run(white, 300.0, {.deflection_is_absolute = absolute});
    const auto found = run->estimates(kMassKg, kStiffnessNpm);
    double sum = 0.0;  // of F(v) over both signs: twice the constant, over the nodes
    std::size_t nodes = 0;
    for (std::size_t i = 0; i < found.known_input.points; ++i) {
      if (std::abs(found.known_input.curve[i].velocity_mps) < 3e-3) continue;
      sum += found.known_input.curve[i].force_n;
      ++nodes;
    }
    EXPECT_NEAR(sum / static_cast<double>(nodes), absolute ? 0.5 * (9150.0 - 7562.0) : 0.0, 30.0);
    EXPECT_NEAR(found.weak.level_n.value / kLevelN, 1.0, 0.03);
  }
}

// The whole: a viscous part appears as a slope of the curve.
TEST(FokkerPlanck, FindsAViscousSlope) {
  const auto run = white_run({.seed = 6, .viscous_nspm = 3.0e5, .input_level = 2.0e-2}, 1'000.0);
  const auto found = run->estimates(kMassKg, kStiffnessNpm);
  const MethodResult& weak = found.weak;
  ASSERT_TRUE(weak.verdict.has_number);
  ASSERT_EQ(weak.points, 2 * (kCurveSegments + 1));
  const auto force_n = [&](std::size_t node) {  // odd part; node 6: 19 mm/s, node 8: 40 mm/s
    return 0.5 * (weak.curve[9 + node].force_n - weak.curve[8 - node].force_n);
  };
  const double slope = (force_n(8) - force_n(6)) / 21.0e-3;
  EXPECT_NEAR(slope / 3.0e5, 1.0, 0.25);
}

TEST(FokkerPlanck, ForgetsWhatWasBefore) {
  FokkerPlanck now{{.memory_s = 40.0}};
  const auto ride = [&](double friction_n, std::uint64_t seed, double length_s,
                        std::int64_t from_tick) {
    sim::WhiteInput source{
        {.seed = seed, .friction_positive_n = friction_n, .friction_negative_n = friction_n}};
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(300.0 * length_s); ++i) {
      Motion m = source.next();
      m.tick += from_tick;
      now.update(m);
    }
  };
  ride(8000.0, 1, 200.0, 0);
  ride(4000.0, 2, 400.0, 60'000);
  const auto found = now.estimates(kMassKg, kStiffnessNpm);
  ASSERT_TRUE(found.known_input.verdict.has_number);
  EXPECT_NEAR(found.known_input.level_n.value, 4000.0, 10.0);
  EXPECT_NEAR(found.weak.level_n.value, 4000.0, 0.15 * 4000.0);
  EXPECT_NEAR(found.paper.level_n.value, 4000.0, 0.15 * 4000.0);
}

TEST(FokkerPlanck, StatesTheLevelOfItsInput) {
  double squares = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto found = white_run({.seed = seed}, 120.0)->estimates(kMassKg, kStiffnessNpm);
    const double level = sim::WhiteInputConfig{}.input_level;
    EXPECT_NEAR(found.input_level.value / level, 1.0, 0.1);
    squares += std::pow((found.input_level.value - level) / found.input_level.std, 2) / 40.0;
  }
  EXPECT_GT(std::sqrt(squares), 0.75);
  EXPECT_LT(std::sqrt(squares), 1.3);
  constexpr double kFaint = 1e-12;
  const auto faint = white_run({.seed = 1, .input_level = kFaint}, 120.0);
  EXPECT_NEAR(faint->estimates(kMassKg, kStiffnessNpm).input_level.value / kFaint, 1.0, 0.1);
  const auto brief = white_run({.seed = 1}, 1.0)->estimates(kMassKg, kStiffnessNpm);
  EXPECT_EQ(brief.input_level.value, 0.0) << "no transform is complete";
  EXPECT_EQ(FokkerPlanck{FokkerPlanckConfig{}}.velocity_rms_mps(), 0.0) << "nothing has come";
}

// A kernel of a quarter of the rms velocity, three of them left out, as far as 99 % of the mass.
TEST(FokkerPlanck, DrawsThePublishedFormFromEndToEnd) {
  for (const bool absolute : {true, false}) {
    const auto run =
        white_run({.seed = 9, .friction_positive_n = 9150.0, .friction_negative_n = 7562.0}, 200.0,
                  {.deflection_is_absolute = absolute});
    const auto& curve = run->estimates(kMassKg, kStiffnessNpm).paper.curve;
    const double reach_mps = speed_quantile(run->velocities(), 0.99);
    const double width_mps = 0.25 * run->velocity_rms_mps();
    const PaperForm form =
        run->paper_form(kMassKg, kStiffnessNpm, width_mps, 3.0 * width_mps, reach_mps);
    const double constant = absolute ? 0.0 : form.offset();
    double samples = 0.0;
    for (std::size_t i = 0; i < 22; ++i) {
      const bool positive = i >= 11;
      const std::size_t node = positive ? i - 11 : 10 - i;
      EXPECT_NEAR(curve[i].velocity_mps,
                  (positive ? 0.1 : -0.1) * static_cast<double>(node) * reach_mps, 1e-12);
      const double alpha = node == 0 ? form.offset_mps2[positive ? 1 : 0]
                                     : form.segments[positive ? 1 : 0][node - 1].alpha_mps2;
      EXPECT_NEAR(curve[i].force_n, 0.5 * kMassKg * (alpha - constant), 1e-6) << i;
      samples += static_cast<double>(curve[i].samples);
    }
    EXPECT_NEAR(samples, static_cast<double>(run->velocities().samples()), 25.0);
    double about_third = 0.0;  // of the positive nodes: nearer to it than to any other
    for (std::size_t b = 0; b < VelocityHistogram::kBins; ++b)
      if (std::abs(run->velocities().axis().centre(b) - curve[14].velocity_mps) < 0.05 * reach_mps)
        about_third += run->velocities().mass(b);
    EXPECT_NEAR(static_cast<double>(curve[14].samples), about_third, 20.0);
  }
}

// The curve's nodes, with the samples of their hats: on a broken line each sample is shared by two.
TEST(FokkerPlanck, CountsTheSamplesOfANode) {
  FokkerPlanck run{{}};
  std::int64_t tick = 0;
  const auto give = [&](double velocity_mps, int samples) {
    for (int i = 0; i < samples; ++i, ++tick)
      run.update({.tick = tick,
                  .deflection_m = 1e-3 * std::sin(0.7 * static_cast<double>(tick)),
                  .velocity_mps = velocity_mps,
                  .frame_mps2 = std::sin(0.2 * static_cast<double>(tick)),
                  .relative_mps2 = std::cos(0.3 * static_cast<double>(tick))});
  };
  for (const double sign : {-1.0, 1.0}) {
    for (const auto& [speed_mps, samples] :
         {std::pair{0.75e-3, 4000}, std::pair{2.25e-3, 800}, std::pair{4.25e-3, 1000},
          std::pair{6.75e-3, 1200}, std::pair{9.5e-3, 1000}, std::pair{12.75e-3, 1000},
          std::pair{16.75e-3, 1000}, std::pair{22.5e-3, 1000}, std::pair{40.0e-3, 1000}})
      give(sign * speed_mps, samples);
  }
  const auto found = run.estimates(kMassKg, kStiffnessNpm);
  const MethodResult& weak = found.weak;
  ASSERT_EQ(weak.points, 18U);
  for (std::size_t i = 0; i < 18; ++i) {
    const std::size_t node = i < 9 ? 8 - i : i - 9;
    const double speed = node == 0 ? 0.0 : kDefaultCurveNodesMps[node - 1];
    EXPECT_NEAR(weak.curve[i].velocity_mps, i < 9 ? -speed : speed, 1e-15);
    // 0.75 and 2.25 mm/s lie a quarter and three quarters on the way to 3 mm/s.
    const std::array<double, 9> expected{
        3000.0 + 200.0, 1000.0 + 600.0 + 500.0, 500.0 + 600.0, 600.0 + 500.0, 500.0 + 500.0,
        500.0 + 500.0,  500.0 + 500.0,          500.0,         1000.0};
    EXPECT_NEAR(static_cast<double>(weak.curve[i].samples), expected[node], 4.0) << node;
  }
}

TEST(FokkerPlanck, TwoHalvesMergeToTheWhole) {
  const FokkerPlanckConfig config{.velocity_mps = {.low = -0.1, .high = 0.1},
                                  .deflection_m = {.low = -5e-3, .high = 5e-3}};
  FokkerPlanck whole{config};
  FokkerPlanck first{config};
  FokkerPlanck second{config};
  sim::WhiteInput source{{.seed = 8}};
  for (int i = 0; i < 60'000; ++i) {
    const Motion m = source.next();
    whole.update(m);
    (i < 30'000 ? first : second).update(m);
  }
  const auto merged = first.merge(second);
  ASSERT_TRUE(merged.ok());
  EXPECT_EQ(merged.value(), 60'000U);
  for (std::size_t b = 0; b < kVelocityBins; ++b) {
    EXPECT_EQ(first.velocities().mass(b), whole.velocities().mass(b));
  }
  const auto a = first.estimates(kMassKg, kStiffnessNpm);
  const auto b = whole.estimates(kMassKg, kStiffnessNpm);
  EXPECT_NEAR(a.known_input.level_n.value, b.known_input.level_n.value, 1e-6);
  // The periodograms that the cut goes through are lost.
  EXPECT_NEAR(a.weak.level_n.value / b.weak.level_n.value, 1.0, 0.01);
  EXPECT_NEAR(a.weak.verdict[Reason::kShortRecord].size, 200.0, 1e-6) << "s, and all of them count";
  EXPECT_NEAR(first.velocity_rms_mps() / whole.velocity_rms_mps(), 1.0, 1e-12);
  for (const Reason reason :
       {Reason::kNoMotion, Reason::kConstantChannel, Reason::kRangeClips, Reason::kDependence}) {
    const Finding& merged_finding = a.paper.verdict[reason];
    EXPECT_NEAR(merged_finding.size, b.paper.verdict[reason].size, 1e-4) << text(reason);
    EXPECT_EQ(merged_finding.checked, b.paper.verdict[reason].checked) << text(reason);
  }
}

TEST(FokkerPlanck, MergesWhatHasTheSameSettings) {
  const FokkerPlanckConfig config{.velocity_mps = {.low = -0.1, .high = 0.1},
                                  .deflection_m = {.low = -5e-3, .high = 5e-3}};
  FokkerPlanck first{config};
  FokkerPlanck still{config};
  still.update({.tick = 1, .still = true});
  still.update({.tick = 2, .velocity_mps = std::numeric_limits<double>::quiet_NaN()});
  ASSERT_TRUE(first.merge(still).ok());
  EXPECT_EQ(first.still(), 1U);
  EXPECT_EQ(first.not_finite(), 1U);
  for (int setting = 0; setting < 6; ++setting) {
    FokkerPlanckConfig other = config;
    if (setting == 0) other.velocity_mps.high = 0.2;
    if (setting == 1) other.deflection_m.high = 6e-3;
    if (setting == 2) other.sample_rate_hz = 200.0;
    if (setting == 3) other.curve_nodes_mps[4] += 1e-4;
    if (setting == 4) other.memory_s = 40.0;
    if (setting == 5) other.anti_alias_corner_hz = 50.0;
    const auto refused = first.merge(FokkerPlanck{other});
    ASSERT_FALSE(refused.ok()) << setting;
    EXPECT_EQ(refused.error(), Errc::kMismatch);
  }
}

/// White motion from tick `first` on.
void ride_white(FokkerPlanck& run, std::uint64_t seed, int samples, std::int64_t first) {
  sim::WhiteInput source{{.seed = seed}};
  for (int i = 0; i < samples; ++i) {
    Motion motion = source.next();
    motion.tick = first + i;
    run.update(motion);
  }
}

constexpr std::array kOfAnyMemory{Reason::kNoMotion,      Reason::kConstantChannel,
                                  Reason::kShortRecord,   Reason::kRangeClips,
                                  Reason::kColouredInput, Reason::kDependence};

void expect_same_answer(const FokkerPlanck& one, const FokkerPlanck& other, double tolerance) {
  const auto a = one.estimates(kMassKg, kStiffnessNpm);
  const auto b = other.estimates(kMassKg, kStiffnessNpm);
  ASSERT_TRUE(a.known_input.verdict.has_number);
  EXPECT_NEAR(one.velocity_rms_mps() / other.velocity_rms_mps(), 1.0, tolerance);
  EXPECT_NEAR(a.input_level.value / b.input_level.value, 1.0, tolerance);
  EXPECT_NEAR(a.known_input.level_n.value / b.known_input.level_n.value, 1.0, tolerance);
  EXPECT_NEAR(a.weak.level_n.value / b.weak.level_n.value, 1.0, tolerance);
  EXPECT_NEAR(a.paper.level_n.value / b.paper.level_n.value, 1.0, tolerance);
  for (const Reason reason : kOfAnyMemory) {
    const Finding& finding = b.paper.verdict[reason];
    EXPECT_NEAR(a.paper.verdict[reason].size, finding.size, tolerance * (1.0 + finding.size))
        << text(reason);
  }
}

constexpr FokkerPlanckConfig kForgetting{.velocity_mps = {.low = -0.1, .high = 0.1},
                                         .deflection_m = {.low = -5e-3, .high = 5e-3},
                                         .memory_s = 40.0};

// Both are seen at their own newest sample, so that it is all one which takes in which.
TEST(FokkerPlanck, MergesRecordsThatForgetEitherWay) {
  FokkerPlanck early{kForgetting};
  FokkerPlanck late{kForgetting};
  ride_white(early, 8, 30'000, 0);
  ride_white(late, 9, 60'000, 30'000);
  FokkerPlanck other = late;
  const double rms_mps =
      std::sqrt((std::pow(early.velocity_rms_mps(), 2) * (1.0 - std::exp(-100.0 / 40.0)) +
                 std::pow(late.velocity_rms_mps(), 2) * (1.0 - std::exp(-200.0 / 40.0))) /
                (2.0 - std::exp(-100.0 / 40.0) - std::exp(-200.0 / 40.0)));
  ASSERT_TRUE(other.merge(early).ok());
  ASSERT_TRUE(early.merge(late).ok());
  EXPECT_NEAR(early.velocity_rms_mps() / rms_mps, 1.0, 1e-9);
  expect_same_answer(early, other, 1e-7);
}

// Weights grow by the block, and are scaled back every 208 memories.
TEST(FokkerPlanck, ForgetsAlikeForever) {
  FokkerPlanck fresh{kForgetting};
  FokkerPlanck old{kForgetting};
  constexpr std::int64_t kBlocks = 208 * 20 + 96;
  for (std::int64_t block = 0; block < kBlocks; ++block)
    old.update({.tick = 600 * block,
                .deflection_m = 3e-3,
                .velocity_mps = block % 2 == 0 ? 0.09 : -0.09,
                .frame_mps2 = 0.3,
                .relative_mps2 = 2.0});
  for (FokkerPlanck* run : {&fresh, &old}) ride_white(*run, 8, 400 * 600, 600 * kBlocks);
  expect_same_answer(fresh, old, 1e-5);
  for (std::size_t line = 0; line < InputSpectrum::kLines; ++line)
    EXPECT_NEAR(fresh.input_spectrum(line) / old.input_spectrum(line), 1.0, 1e-5) << line;
}

TEST(FokkerPlanck, ItsSpectrumIsThatOfItsInput) {
  FokkerPlanck run{{}};
  InputSpectrum spectrum{300.0};
  InputSpectrum::Sums sums;
  sim::WhiteInput source{{.seed = 3}};
  for (int i = 0; i < 20'000; ++i) {
    const Motion motion = source.next();
    run.update(motion);
    spectrum.update(motion.input_mps2(), 1.0, sums);
  }
  for (std::size_t line = 0; line < InputSpectrum::kLines; ++line) {
    EXPECT_EQ(run.spectrum_frequency_hz(line), spectrum.frequency_hz(line));
    EXPECT_NEAR(run.input_spectrum(line) / (sums.power[line] / sums.weight), 1.0, 1e-9) << line;
  }
  EXPECT_EQ(FokkerPlanck{{}}.input_spectrum(3), 0.0);
}

// A transform is of 512 samples in a row.
TEST(FokkerPlanck, NoTransformGoesAcrossAGap) {
  for (const std::int64_t gap : {0, 1}) {
    FokkerPlanck run{{}};
    ride_white(run, 1, 500, 0);
    ride_white(run, 2, 500, 500 + gap);
    EXPECT_EQ(run.estimates(kMassKg, kStiffnessNpm).input_level.value > 0.0, gap == 0) << gap;
  }
}

TEST(FokkerPlanck, LearnsOneRangeForADensityAndTheJointOne) {
  const auto run = white_run({.seed = 4}, 30.0);
  EXPECT_NEAR(run->joint().x_axis().high() / run->deflections().axis().high(), 1.0, 1e-12);
  EXPECT_NEAR(run->joint().y_axis().high() / run->velocities().axis().high(), 1.0, 1e-12);
  EXPECT_EQ(run->joint().samples(), 9000U);
  FokkerPlanck brief{{}};
  ride_white(brief, 4, 5999, 0);
  EXPECT_TRUE(brief.velocities().axis().learning() && brief.deflections().axis().learning());
  ride_white(brief, 5, 1, 5999);
  EXPECT_FALSE(brief.velocities().axis().learning() || brief.deflections().axis().learning())
      << "twenty seconds";
}

// Friction of both signs is mixed within 1.5 ms of a reversal: at 6 m/s^2 within 9 mm/s.
TEST(FokkerPlanck, LeavesOutWhatIsBesideAReversalWhereTheInputIsKnown) {
  const auto samples_of = [](double relative_mps2, double corner_hz) {
    FokkerPlanck run{{.anti_alias_corner_hz = corner_hz}};
    for (std::int64_t tick = 0; tick < 20'000; ++tick) {
      const double speed = (tick % 2 == 0 ? 5e-3 : 20e-3);
      run.update({.tick = tick,
                  .deflection_m = 1e-3 * std::sin(0.7 * static_cast<double>(tick)),
                  .velocity_mps = tick % 4 < 2 ? speed : -speed,
                  .frame_mps2 = std::sin(0.2 * static_cast<double>(tick)),
                  .relative_mps2 = relative_mps2});
    }
    double samples = 0.0;
    for (const CurvePoint& point : run.estimates(kMassKg, kStiffnessNpm).known_input.curve)
      samples += static_cast<double>(point.samples);
    return samples;
  };
  EXPECT_NEAR(samples_of(3.3, 100.0), 20'000.0, 20.0);
  EXPECT_NEAR(samples_of(3.4, 100.0), 10'000.0, 20.0);
  EXPECT_NEAR(samples_of(-3.4, 100.0), 10'000.0, 20.0);
  EXPECT_NEAR(samples_of(3.4, 200.0), 20'000.0, 20.0);
  EXPECT_NEAR(samples_of(6.0, 0.0), 20'000.0, 20.0) << "no filter, nothing mixed";
}

TEST(FokkerPlanck, ChecksItsConfiguration) {
  EXPECT_TRUE(FokkerPlanck::check({}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.sample_rate_hz = 100.0}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.velocity_mps = {}}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.memory_s = 0.5}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.anti_alias_corner_hz = -1.0}).ok());
  FokkerPlanckConfig nodes;
  nodes.curve_nodes_mps[3] = nodes.curve_nodes_mps[2];
  EXPECT_FALSE(FokkerPlanck::check(nodes).ok());
  EXPECT_FALSE(FokkerPlanck::check({.memory_s = std::numeric_limits<double>::quiet_NaN()}).ok());
  EXPECT_TRUE(FokkerPlanck::check({.sample_rate_hz = 150.0}).ok());
  EXPECT_TRUE(FokkerPlanck::check({.sample_rate_hz = 400.0}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.sample_rate_hz = 400.1}).ok());
  EXPECT_FALSE(FokkerPlanck::check({.deflection_m = {}}).ok());
  EXPECT_TRUE(FokkerPlanck::check({.memory_s = 2.0}).ok());
  EXPECT_TRUE(FokkerPlanck::check({.anti_alias_corner_hz = 0.0}).ok());
  EXPECT_FALSE(
      FokkerPlanck::check({.anti_alias_corner_hz = std::numeric_limits<double>::infinity()}).ok());
  nodes = {};
  nodes.curve_nodes_mps[7] = 10.0;
  EXPECT_FALSE(FokkerPlanck::check(nodes).ok());
  nodes.curve_nodes_mps[0] = 0.0;
  EXPECT_FALSE(FokkerPlanck::check(nodes).ok());
}

}  // namespace
}  // namespace dampline
