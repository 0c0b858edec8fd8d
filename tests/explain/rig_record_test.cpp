// SPDX-License-Identifier: MIT
// Rigs that other people measured, and like ones that are simulated here: each a case on which a
// diagnosis goes wrong easily.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "tests/explain/explained_rig.hpp"
#include "tests/shared_data.hpp"

namespace dampline::test {
namespace {

using app::rig::Explanation;

struct StoredRow {
  double time_s, deflection_m, force_n;
};

/// A stored record's rows; empty where the shared data have none.
std::vector<StoredRow> stored(const std::string& name) {
  std::ifstream in{shared_data() / "rigs" / (name + ".csv")};
  std::vector<StoredRow> out;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    StoredRow row{};
    if (std::sscanf(line.c_str(), "%lf,%lf,%lf", &row.time_s, &row.deflection_m, &row.force_n) == 3)
      out.push_back(row);
  }
  return out;
}

std::string text_of(const std::vector<StoredRow>& rows, double force = 1.0, double cut_s = 0.0) {
  std::string out = "time_s,deflection_m,force_n\n";
  for (const StoredRow& r : rows)
    if (r.time_s >= rows.front().time_s + cut_s && r.time_s <= rows.back().time_s - cut_s)
      out += fmt::format("{:.7f},{:.9g},{:.9g}\n", r.time_s, r.deflection_m, force * r.force_n);
  return out;
}

std::vector<std::string> effects_of(const Explanation& found) {
  std::vector<std::string> out;
  for (const app::Step& s : found.steps) out.push_back(s.effect);
  return out;
}

bool names(const Explanation& found, const std::string& effect) {
  const auto effects = effects_of(found);
  return std::find(effects.begin(), effects.end(), effect) != effects.end();
}

bool has_term(const app::rig::Model& model, const std::string& term) {
  return std::find(model.terms.begin(), model.terms.end(), term) != model.terms.end();
}

/// Nothing declared.
Explanation told(const std::string& text) { return explained(text, {}); }

void expect_the_car_damper(const Explanation& found) {
  EXPECT_STRNE(found.verdict(), "complete") << summarize(found);
  ASSERT_FALSE(found.steps.empty());
  EXPECT_EQ(found.steps[0].effect, "presliding_hysteresis") << summarize(found);
  EXPECT_LE(std::sqrt(found.final.fit.held_out_nmse), 0.05);
  EXPECT_LE(found.final.floor_nmse, found.final.fit.held_out_nmse);
  EXPECT_GT(value_of(found, "coulomb"), 0.0);
}

TEST(ACarDamper, HasFrictionThatBuildsUpWhateverStandsAtTheEndsOfTheRecord) {
  const auto rows = stored("car_damper_dynamometer");
  if (rows.empty()) GTEST_SKIP() << "no rigs in the shared data";
  const Explanation whole = told(text_of(rows));
  const Explanation cut = told(text_of(rows, 1.0, 0.7));
  expect_the_car_damper(whole);
  expect_the_car_damper(cut);
  EXPECT_NEAR(std::sqrt(whole.final.fit.held_out_nmse), std::sqrt(cut.final.fit.held_out_nmse),
              0.01);
}

TEST(ACarDamper, MayBeStoredAsTheReaction) {
  const auto rows = stored("car_damper_dynamometer");
  if (rows.empty()) GTEST_SKIP() << "no rigs in the shared data";
  const Explanation found = told(text_of(rows, -1.0));
  expect_the_car_damper(found);
  const auto turned = [](const std::string& note) {
    return note.find("its sign was turned") != std::string::npos;
  };
  EXPECT_TRUE(std::any_of(found.notes.begin(), found.notes.end(), turned)) << summarize(found);
}

TEST(AFrictionDamper, WhoseBandIsTightenedHasPlayAndChanges) {
  const auto file = shared_data() / "rigs/friction_damper_band_tightened_inch.csv";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no rigs in the shared data";
  const app::RecognisedColumns seen = app::recognise_columns({}, {file.string(), false});
  const Explanation found = app::rig::explain(seen.config, {{file.string()}, {}, "", false});
  EXPECT_EQ(effects_of(found), (std::vector<std::string>{"backlash", "time_drift"}))
      << summarize(found);
  EXPECT_NEAR(value_of(found, "time_drift_coulomb_positive"), 34.0, 8.0);
}

void expect_a_plausible_friction(const Explanation& found, double level_n) {
  ASSERT_FALSE(found.steps.empty()) << summarize(found);
  EXPECT_EQ(effects_of(found), std::vector<std::string>{"presliding_hysteresis"})
      << summarize(found);
  for (const app::Parameter& p : found.steps[0].parameters) {
    if (p.name.find("_force") != std::string::npos) {
      EXPECT_GT(std::abs(p.value), 0.3 * level_n) << p.name;
      EXPECT_LT(std::abs(p.value), 1.2 * level_n) << p.name;
    }
    if (p.name.find("_travel") != std::string::npos) {
      EXPECT_GT(p.value, 2e-4) << p.name;
      EXPECT_LT(p.value, 1e-2) << p.name;
    }
    if (p.name.find("_stiffness") == std::string::npos) continue;
    EXPECT_LT(p.value, level_n / 1e-4) << p.name;
  }
}

TEST(AMagnetorheologicalDamperNightly, AtConstantCurrentHasFrictionWithAMemory) {
  for (const auto& [name, level_n] :
       {std::pair{"mr_damper_press_0A", 190.0}, std::pair{"mr_damper_press_1A", 1450.0}}) {
    const auto rows = stored(name);
    if (rows.empty()) GTEST_SKIP() << "no rigs in the shared data";
    expect_a_plausible_friction(told(text_of(rows)), level_n);
  }
}

TEST(AHystereticOscillatorNightly, IsFoundWithoutADeclaration) {
  const auto rows = stored("bouc_wen_multisine");
  if (rows.empty()) GTEST_SKIP() << "no rigs in the shared data";
  const Explanation found = told(text_of({rows.begin(), rows.begin() + 16384}));
  EXPECT_EQ(effects_of(found), std::vector<std::string>{"presliding_hysteresis"})
      << summarize(found);
  EXPECT_FALSE(has_term(found.final, "coulomb")) << summarize(found);
  EXPECT_NEAR(value_of(found, "moving_mass"), 2.0, 0.004);
  EXPECT_NEAR(value_of(found, "stiffness"), 5e4, 300.0);
  EXPECT_NEAR(value_of(found, "viscous"), 10.0, 0.3);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_travel"), 1.25e-3, 1e-5);
  EXPECT_NEAR(value_of(found, "presliding_hysteresis_shape"), -1.375, 0.003);
}

/// Force of a motion of three tones.
using Force = std::function<double(double t, double x, double v)>;

std::string simulated(const Force& force, double noise_n, double length_s = 40.0) {
  std::mt19937_64 random{91};
  std::normal_distribution<double> noise;
  std::string out = "time_s,deflection_m,force_n\n";
  for (int i = 0; i < static_cast<int>(400.0 * length_s); ++i) {
    const double t = i / 400.0;
    double x = 0.0;
    double v = 0.0;
    const double tones[][3] = {{0.006, 0.47, 0.3}, {0.004, 1.23, 1.0}, {0.0015, 2.7, 2.0}};
    for (const auto& [amplitude, hz, phase] : tones) {
      x += amplitude * std::sin(2.0 * M_PI * hz * t + phase);
      v += amplitude * 2.0 * M_PI * hz * std::cos(2.0 * M_PI * hz * t + phase);
    }
    out += fmt::format("{:.6f},{:.9f},{:.5f}\n", t, x + 2e-7 * noise(random),
                       force(t, x, v) + noise_n * noise(random));
  }
  return out;
}

TEST(AViscousDamper, IsNoFrictionWhereNobodyDeclaresABase) {
  const Explanation found =
      told(simulated([](double, double, double v) { return 3000.0 * v; }, 2.0));
  EXPECT_TRUE(found.steps.empty()) << summarize(found);
  EXPECT_STREQ(found.verdict(), "complete") << summarize(found);
  EXPECT_FALSE(has_term(found.final, "coulomb"));
  EXPECT_NEAR(value_of(found, "viscous"), 3000.0, 10.0);
}

TEST(AFrictionAndADamper, AreBothTheBaseWhereNobodyDeclaresOne) {
  const Explanation found = told(simulated(
      [](double, double, double v) { return (v < 0.0 ? -120.0 : 120.0) + 3000.0 * v; }, 2.0));
  EXPECT_TRUE(found.steps.empty()) << summarize(found);
  EXPECT_NEAR(value_of(found, "viscous"), 3000.0, 30.0);
  EXPECT_NEAR(value_of(found, "coulomb"), 120.0, 3.0);
}

TEST(AFrictionAndADamper, AreBothTheBaseWhereTheDamperTakesATenthOfTheError) {
  // 660 N s/m take a tenth of what friction alone leaves of this motion and noise.
  const auto base_is_both = [](double viscous_nspm) {
    const Explanation found = told(simulated(
        [=](double, double, double v) { return (v < 0.0 ? -300.0 : 300.0) + viscous_nspm * v; },
        30.0));
    return !found.notes.empty() && found.notes[0].starts_with("Nobody declared a base");
  };
  EXPECT_FALSE(base_is_both(540.0));
  EXPECT_TRUE(base_is_both(800.0));
}

TEST(ASpring, ThatIsSaidNotToBeThereIsNotAdded) {
  app::Config config;
  config.model.base = {"coulomb"};
  config.model.base_is_set = true;
  config.model.stiffness = "none";
  const Explanation found = explained(
      simulated([](double, double x, double v) { return (v < 0.0 ? -300.0 : 300.0) + 9e4 * x; },
                2.0),
      config);
  EXPECT_FALSE(has_term(found.final, "linear spring")) << summarize(found);
  EXPECT_FALSE(has_term(found.base, "linear spring"));
}

TEST(ASpringBelowNothing, IsNeverAnExplanation) {
  const Explanation found = told(simulated(
      [](double, double x, double v) { return (v < 0.0 ? -300.0 : 300.0) - 6e4 * x; }, 2.0));
  EXPECT_STRNE(found.verdict(), "complete") << summarize(found);
  EXPECT_STRNE(found.verdict(), "explained");
  EXPECT_FALSE(found.impossible.empty()) << summarize(found);
}

TEST(ADamper, WhoseVoltageVariesChanges) {
  // A friction that builds up over 0.8 mm; its level follows a voltage that somebody turns.
  double z = 0.0;
  double last_m = 0.0;
  const auto level_n = [](double t) {
    return 400.0 + 250.0 * std::sin(0.31 * t) + 150.0 * std::sin(0.73 * t);
  };
  std::mt19937_64 random{92};
  std::normal_distribution<double> noise;
  std::string text = "time_s,deflection_m,force_n\n";
  for (int i = 0; i < 16 * 250 * 40; ++i) {
    const double t = i / 4000.0;
    const double x = 0.0125 * std::sin(2.0 * M_PI * 0.5 * t);
    const double v = 0.0125 * M_PI * std::cos(M_PI * t);
    z += (x - last_m) / 0.0008 * (1.0 - z * (v < 0.0 ? -1.0 : 1.0));
    last_m = x;
    if (i % 20 == 0)
      text += fmt::format("{:.6f},{:.9f},{:.5f}\n", t, x + 2e-7 * noise(random),
                          level_n(t) * z + 1500.0 * v + 2.0 * noise(random));
  }
  const Explanation found = told(text);
  EXPECT_TRUE(names(found, "time_drift")) << summarize(found);
  for (const app::Parameter& p : found.final.parameters)
    if (p.name.find("hysteresis_stiffness") != std::string::npos ||
        p.name.find("contact_stiffness") != std::string::npos) {
      EXPECT_LT(p.value, 1e7) << summarize(found);
    }
}

TEST(ALateness, OfASpringIsNoForceOfTheOtherSign) {
  const Explanation found =
      told(simulated([](double, double x, double v) { return 1e5 * x - 50.0 * v; }, 2.0));
  for (const std::string& note : found.notes)
    EXPECT_EQ(note.find("sign was turned"), std::string::npos) << note;
}

}  // namespace
}  // namespace dampline::test
