// SPDX-License-Identifier: MIT
// The program's `predict`: a law found from one record moves another, whose motion is integrated
// here in steps of a fortieth.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/app/program.hpp"
#include "tests/shared_data.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::HasSubstr;

constexpr double kPredictedIntervalS = 0.004;
constexpr int kPredictedSamples = 7500;
constexpr int kPredictedFine = 40;
constexpr double kNoiseM = 3e-6;

double force_at(double t, double phase) {
  double out = 0.0;
  for (int tone = 0; tone < 12; ++tone)
    out += std::sin((2.0 + 5.3 * tone) * t + phase * tone + 0.3 * tone * tone);
  return 18.0 * out;
}

/// A mass of 20 kg on a hardening spring with viscous damping: time_s, deflection_m, force_n.
std::string record(double phase, bool with_motion) {
  const double h = kPredictedIntervalS / kPredictedFine;
  const auto accel = [&](double t, double x, double v) {
    return (force_at(t, phase) - 60.0 * v - 4e4 * x - 3e8 * x * x * x) / 20.0;
  };
  std::mt19937 random{7};
  std::normal_distribution<double> noise{0.0, kNoiseM};
  std::string out = with_motion ? "time_s,deflection_m,force_n\n" : "time_s,force_n\n";
  double x = 0.0;
  double v = 0.0;
  for (int i = 0; i < kPredictedSamples * kPredictedFine; ++i) {
    const double t = i * h;
    if (i % kPredictedFine == 0)
      out += with_motion
                 ? fmt::format("{:.6f},{:.9g},{:.9g}\n", t, x + noise(random), force_at(t, phase))
                 : fmt::format("{:.6f},{:.9g}\n", t, force_at(t, phase));
    const double a = accel(t, x, v);
    const double b = accel(t + 0.5 * h, x + 0.5 * h * v, v + 0.5 * h * a);
    const double c = accel(t + 0.5 * h, x + 0.5 * h * (v + 0.5 * h * a), v + 0.5 * h * b);
    const double d = accel(t + h, x + h * (v + 0.5 * h * b), v + h * c);
    x += h * v + h * h / 6.0 * (a + b + c);
    v += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
  }
  return out;
}

class Predict : public testing::Test {
 protected:
  void explain() const {
    program_.write("train.csv", record(0.7, true));
    const auto found = program_.run("explain train.csv --out found --no-report --quiet");
    ASSERT_EQ(found.code, 0) << found.error;
  }
  [[nodiscard]] json predict(const std::string& arguments) const {
    const auto out = program_.run("predict found --json --force --out p.csv " + arguments);
    EXPECT_EQ(out.code, 0) << out.error;
    return json::parse(out.output);
  }
  /// One column of a table.
  [[nodiscard]] std::vector<double> column(const std::string& file, std::size_t at) const {
    std::ifstream stream{program_.path(file)};
    std::string line;
    while (std::getline(stream, line) && line.starts_with('#')) {
    }
    std::vector<double> out;
    while (std::getline(stream, line)) {
      std::size_t from = 0;
      for (std::size_t c = 0; c < at; ++c) from = line.find(',', from) + 1;
      out.push_back(std::stod(line.substr(from)));
    }
    return out;
  }
  [[nodiscard]] std::size_t truth_column(const std::string& name) const {
    std::ifstream stream{program_.path("truth.csv")};
    std::string line;
    while (std::getline(stream, line) && line.starts_with('#')) {
    }
    const std::string before = line.substr(0, line.find(name));
    return static_cast<std::size_t>(std::count(before.begin(), before.end(), ','));
  }
  Program program_;
};

TEST_F(Predict, MovesAMassUnderAForceThatItNeverSaw) {
  explain();
  program_.write("other.csv", record(2.9, true));
  const json moved = predict("--input other.csv --free-run").at("errors").at(0);
  EXPECT_EQ(moved.at("quantity"), "deflection_m");
  EXPECT_LT(moved.at("rms"), 1.1 * kNoiseM) << "it is the measured deflection's own noise";
  EXPECT_LT(moved.at("nmse"), 1e-4);
  EXPECT_GT(moved.at("within_two_deviations"), 0.9);
  const json forced = predict("--input other.csv").at("errors").at(0);
  EXPECT_EQ(forced.at("quantity"), "force_n");
  EXPECT_LT(forced.at("nmse"), 1e-2);
  EXPECT_GT(forced.at("within_two_deviations"), 0.9);
}

TEST_F(Predict, BeginsInTheMidstOfMotionByWhatFollows) {
  explain();
  std::istringstream whole{record(2.9, true)};
  std::string line;
  std::getline(whole, line);
  std::string rest = line + '\n';
  for (int i = 0; std::getline(whole, line); ++i)
    if (i >= 2000) rest += line + '\n';
  program_.write("rest.csv", rest);
  const json moved = predict("--input rest.csv --free-run").at("errors").at(0);
  EXPECT_LT(moved.at("rms"), 1.1 * kNoiseM) << "the velocity of one sample has noise of its own";
}

/// A carriage of 95 kg without a spring, by steps of a fourth of a sample: viscous and dry
/// friction, and a force of 1.5 N below 20 Hz that nobody measured.
std::string carriage(unsigned seed) {
  constexpr double kStepS = 0.0005;
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  const double keep = std::exp(-4.0 * 20.0 * kStepS);
  double lacking_n = 0.0;
  double x = 0.0;
  double v = 0.0;
  std::string out = "time_s,deflection_m,force_n\n";
  for (int i = 0; i < 40000; ++i) {
    const double t = i * kStepS;
    const double force_n = 90.0 * std::sin(1.3 * t + seed) + 60.0 * std::sin(2.9 * t);
    if (i % 4 == 0) out += fmt::format("{:.6f},{:.9g},{:.9g}\n", t, x, force_n);
    lacking_n = keep * lacking_n + 1.5 * std::sqrt(1.0 - keep * keep) * normal(random);
    const double free_n = force_n + lacking_n - 200.0 * v;
    const double next = v + kStepS / 95.0 * (free_n - 20.0 * (v > 0.0 ? 1.0 : -1.0));
    const bool turns = v == 0.0 || next * v < 0.0;
    if (turns)
      v = std::abs(free_n) <= 20.0 ? 0.0 : kStepS / 95.0 * (free_n - std::copysign(20.0, free_n));
    else
      v = next;
    x += kStepS * v;
  }
  return out;
}

using PredictNightly = Predict;

TEST_F(PredictNightly, ItsBandHoldsWhatAForceThatNobodyMeasuredMakes) {
  program_.write("c.toml",
                 "[model]\nbase = [\"coulomb\", \"viscous\"]\ninertia = \"identify\"\n"
                 "stiffness = \"none\"\nrig_corner_hz = 20.0\n");
  program_.write("train.csv", carriage(1));
  const auto found =
      program_.run("explain train.csv --config c.toml --out found --no-report --quiet");
  ASSERT_EQ(found.code, 0) << found.error;
  // A first-order lag's: 4 n^2 tau, tau a fourth of the inverse corner.
  const double truth_n2_hz = 1.5 * 1.5 / 20.0;
  const auto residual = json::parse(std::ifstream{program_.path("found/law.json")}).at("residual");
  EXPECT_NEAR(residual.at("lacking_n2_hz"), truth_n2_hz, 0.5 * truth_n2_hz);
  double within = 0.0;
  for (unsigned seed = 2; seed < 12; ++seed) {
    program_.write("other.csv", carriage(seed));
    within += predict("--input other.csv --free-run")
                  .at("errors")
                  .at(0)
                  .at("within_two_deviations")
                  .get<double>();
  }
  EXPECT_GT(within, 8.8);
  const std::vector<double> std = column("p.csv", 2);
  EXPECT_LT(std[500], 0.5 * std.back()) << "what lacks adds up";
}

/// Noel and Schoukens' benchmark: five periods of 8,192 samples with noise of 7.4e-6 m. Noise of
/// two periods has nothing in common; an error of the law has.
TEST_F(Predict, BoucWensLawHasNoErrorInPeriodsThatItNeverSaw) {
  const auto file = test::shared_data() / "rigs/bouc_wen_multisine.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no rigs in the shared data";
  constexpr int kSeen = 6144;
  constexpr std::size_t kPeriod = 8192;
  std::ifstream stream{file};
  std::string line;
  std::getline(stream, line);
  std::string train = line + '\n';
  std::string other = train;
  for (int i = 0; std::getline(stream, line); ++i) (i < kSeen ? train : other) += line + '\n';
  program_.write("train.csv", train);
  program_.write("other.csv", other);
  const auto found = program_.run("explain train.csv --out found --no-report --quiet");
  ASSERT_EQ(found.code, 0) << found.error;
  const json moved = predict("--input other.csv --free-run").at("errors").at(0);
  EXPECT_LT(moved.at("rms"), 7.6e-6);
  EXPECT_NEAR(moved.at("within_two_deviations"), 0.954, 0.02);
  const std::vector<double> predicted = column("p.csv", 1);
  const std::vector<double> measured = column("p.csv", 3);
  double products = 0.0;
  for (std::size_t a = 1; a < 4; ++a)
    for (std::size_t b = 0; b < a; ++b)
      for (std::size_t i = 0; i < kPeriod; ++i) {
        const std::size_t one = a * kPeriod + i;
        const std::size_t two = b * kPeriod + i;
        products += (predicted[one] - measured[one]) * (predicted[two] - measured[two]);
      }
  EXPECT_LT(products / (6.0 * kPeriod), 1e-6 * 1e-6);
}

TEST_F(Predict, NeedsNoMoreThanTheForce) {
  explain();
  program_.write("force.csv", record(2.9, false));
  const json out = predict("--input force.csv --free-run");
  EXPECT_TRUE(out.at("errors").empty());
  EXPECT_THAT(out.at("notes").dump(), HasSubstr("at rest"));
  program_.write("other.csv", record(2.9, true));
  const std::vector<double> moved = column("p.csv", 1);
  const std::vector<double> truth = column("other.csv", 1);
  ASSERT_EQ(moved.size(), truth.size());
  double left = 0.0;
  for (std::size_t i = 0; i < moved.size(); ++i) left += std::pow(moved[i] - truth[i], 2);
  EXPECT_LT(std::sqrt(left / static_cast<double>(moved.size())), 2.0 * kNoiseM);
}

TEST_F(Predict, TenLinesOfPythonMoveTheSameLaw) {
  if (std::system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0)  // NOLINT(cert-env33-c)
    GTEST_SKIP() << "python3-numpy is not installed";
  explain();
  program_.write("force.csv", record(2.9, false));
  static_cast<void>(predict("--input force.csv --free-run"));
  std::ifstream guide{DAMPLINE_SOURCE_DIR "/app/docs/guide.md"};
  const std::string text{std::istreambuf_iterator<char>{guide}, {}};
  const std::size_t begin = text.find("    import json, numpy as np\n");
  ASSERT_NE(begin, std::string::npos);
  std::string script;
  std::size_t at = begin;
  while (text.compare(at, 4, "    ") == 0) {
    const std::size_t end = text.find('\n', at) + 1;
    script += text.substr(at + 4, end - at - 4);
    at = end;
  }
  program_.write("script.py", script + "np.savetxt('x.csv', x, header='x', comments='')\n");
  ASSERT_EQ(std::system(("cd '" + program_.path("").string() +  // NOLINT(cert-env33-c)
                         "' && /usr/bin/python3 script.py")
                            .c_str()),
            0);
  const std::vector<double> theirs = column("x.csv", 0);
  const std::vector<double> ours = column("p.csv", 1);
  ASSERT_EQ(theirs.size(), ours.size());
  double left = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    left += std::pow(theirs[i] - ours[i], 2);
    all += std::pow(ours[i], 2);
  }
  EXPECT_LT(left / all, 1e-4) << "the script takes the force as straight between samples";
}

/// The simulator's own frame, on wheelsets that the law never saw; what is left is sensors and
/// rounding, as explain has them.
TEST_F(PredictNightly, MovesATrucksFrameByItsWheelsets) {
  for (const char* effect : {"", "--effect presliding_hysteresis", "--effect progressive_friction",
                             "--effect viscoelastic"}) {
    const std::string simulate = fmt::format("simulate --quiet --force {} ", effect);
    ASSERT_EQ(program_.run(simulate + "--duration 120 --seed 5 --out train.log").code, 0);
    ASSERT_EQ(
        program_.run(simulate + "--duration 60 --seed 9 --out other.log --truth truth.csv").code,
        0);
    const auto found = program_.run("explain train.log --out found --force --no-report --quiet");
    ASSERT_EQ(found.code, 0) << found.error;
    const json law = json::parse(program_.read("found/law.json"));
    EXPECT_EQ(law.at("subject"), "truck");
    EXPECT_EQ(law.at("mass_kg"), 0.5 * 37200.0);
    const json moved = predict("--input other.log").at("errors").at(0);
    EXPECT_EQ(moved.at("quantity"), "frame_accel_mps2");
    const json explained = json::parse(program_.read("found/explanation.json"));
    EXPECT_LT(moved.at("nmse"), 1.5 * explained.at("final").at("held_out_nmse").get<double>())
        << effect;
    EXPECT_GT(moved.at("within_two_deviations"), 0.9) << effect;
    // The deflection is in no record: the simulator tells it.
    std::vector<double> apart = column("p.csv", 1);
    const std::vector<double> truth = column("truth.csv", truth_column("deflection_m"));
    ASSERT_LE(apart.size(), truth.size());
    const std::size_t settled = 1500;
    double mean = 0.0;
    for (std::size_t i = 0; i < apart.size(); ++i) apart[i] -= truth[i];
    for (std::size_t i = settled; i < apart.size(); ++i) mean += apart[i];
    mean /= static_cast<double>(apart.size() - settled);
    double left = 0.0;
    double all = 0.0;
    for (std::size_t i = settled; i < apart.size(); ++i) {
      left += std::pow(apart[i] - mean, 2);
      all += std::pow(truth[i], 2);
    }
    EXPECT_LT(left / all, 0.05) << effect << ": where friction holds it, it rests elsewhere";
  }
}

TEST_F(Predict, NamesWhatATrucksLawDoesNotHold) {
  ASSERT_EQ(
      program_.run("simulate --quiet --effect backlash --duration 120 --seed 5 --out train.log")
          .code,
      0);
  ASSERT_EQ(program_.run("explain train.log --out found --no-report --quiet").code, 0);
  EXPECT_THAT(predict("--input train.log").at("notes").dump(), HasSubstr("backlash"));
  program_.write("rig.csv", "time_s,deflection_m,force_n\n0,0,0\n0.01,0.1,3\n0.02,0.2,4\n");
  const auto rig = program_.run("predict found --input rig.csv");
  EXPECT_EQ(rig.code, 2);
  EXPECT_THAT(rig.error, HasSubstr("no truck's record"));
}

TEST_F(Predict, RefusesWhatCannotBePredicted) {
  program_.write("damper.csv", [] {
    std::string out = "time_s,deflection_m,force_n\n";
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.004 * i;
      const double v = 0.05 * std::cos(9.0 * t) + 0.03 * std::cos(23.0 * t);
      const double x = 0.05 / 9.0 * std::sin(9.0 * t) + 0.03 / 23.0 * std::sin(23.0 * t);
      out += fmt::format("{:.6f},{:.9g},{:.9g}\n", t, x, 300.0 * v + 0.01 * std::sin(977.0 * t));
    }
    return out;
  }());
  ASSERT_EQ(program_.run("explain damper.csv --out found --no-report --quiet").code, 0);
  const auto moved = program_.run("predict found --input damper.csv --free-run");
  EXPECT_EQ(moved.code, 2);
  EXPECT_THAT(moved.error, HasSubstr("damper"));
  EXPECT_LT(predict("--input damper.csv").at("errors").at(0).at("nmse"), 1e-3);
  ASSERT_EQ(program_.run("identify damper.csv --out plain --no-report --quiet").code, 0);
  const auto lawless = program_.run("predict plain --input damper.csv");
  EXPECT_EQ(lawless.code, 1);
  EXPECT_THAT(lawless.error, HasSubstr("law.json"));
  program_.write("found/law.json", "{}");
  const auto broken = program_.run("predict found --input damper.csv");
  EXPECT_EQ(broken.code, 1);
  EXPECT_THAT(broken.error, HasSubstr("law.json: schema"));
}

}  // namespace
}  // namespace dampline::app
