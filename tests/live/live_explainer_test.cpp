// SPDX-License-Identifier: MIT
#include "app/live/live_explainer.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

TEST(LiveExplainer, NamesAnEffectBesideTheRunningEstimate) {
  sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 17);
  ASSERT_FALSE(sim::add_effect_text(config, "viscous:coefficient_nspm=120000"));
  sim::Simulation simulation{config};
  Config settings;
  settings.car.moving_mass_kg = config.truck.moving_mass_kg;
  ExplainRun run{settings};
  LiveExplainer explainer{settings, run};
  explainer.start();
  EXPECT_EQ(explainer.newest(), "");
  for (int n = 0; n < 120 * 300; ++n) run.take(sim::to_sample(simulation.next()));
  // As fast as samples came, the judge saw few of them; from here on it has the time it wants.
  std::string verdict;
  for (int second = 0; second < 60 && verdict != "explained"; ++second) {
    for (int n = 0; n < 300; ++n) run.take(sim::to_sample(simulation.next()));
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
    const auto json = nlohmann::json::parse(explainer.newest(), nullptr, false);
    if (!json.is_object()) continue;
    verdict = json.at("verdict").get<std::string>();
    if (verdict == "explained") {
      EXPECT_EQ(json.at("steps").at(0).at("effect"), "viscous");
    }
  }
  explainer.stop();
  EXPECT_EQ(verdict, "explained");
}

/// What is said while the run goes on is what its end says: a parameter that changed is no effect.
TEST(LiveExplainer, HoldsFaultsAndDriftAgainstTheSumsAsTheEndDoes) {
  sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 23);
  ASSERT_FALSE(sim::add_effect_text(config, "time_drift"));
  sim::Simulation simulation{config};
  Config settings;
  settings.car.moving_mass_kg = config.truck.moving_mass_kg;
  ExplainRun run{settings};
  LiveExplainer explainer{settings, run};
  for (int n = 0; n < 300 * 300; ++n) run.take(sim::to_sample(simulation.next()));
  explainer.start();
  std::string effect;
  for (int tenth = 0; tenth < 300 && effect.empty(); ++tenth) {
    for (int n = 0; n < 300; ++n) run.take(sim::to_sample(simulation.next()));
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
    const auto json = nlohmann::json::parse(explainer.newest(), nullptr, false);
    if (json.is_object() && !json.at("steps").empty())
      effect = json.at("steps").at(0).at("effect").get<std::string>();
  }
  explainer.stop();
  const RunResult end = run.finish({}, "simulated");
  const auto concluded = nlohmann::json::parse(explainer.conclude(end));
  EXPECT_EQ(effect, concluded.at("steps").at(0).at("effect").get<std::string>());
  EXPECT_EQ(effect, "time_drift");
}

}  // namespace
}  // namespace dampline::app
