// SPDX-License-Identifier: MIT
#include "app/live/live_explainer.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "app/diagnosis/truck/explanation.hpp"
#include "app/diagnosis/truck/verdict.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;

/// Beside the result of the moment, as live.json has it; no JSON while there is none.
json newest(const LiveExplainer& explainer, ExplainRun& run, const Config& settings) {
  RunResult beside;
  if (!run.empty()) beside = describe_view(run.view(), {}, settings, "simulated");
  explainer.add_newest(beside);
  return json::parse(beside.evidence.explanation, nullptr, false);
}

struct Ride {
  const char* effect;  ///< as --effect takes it; empty: none
  const char* named;   ///< the first step; empty: none
  const char* trust;
  int length_s;
  std::function<void(Sample&)> spoil{};
};

/// The judged explanation of the samples so far as of a file that can be read once.
json explanation_of(const Config& settings, const std::vector<Sample>& samples) {
  ExplainRun run{settings};
  for (const Sample& sample : samples) run.take(sample);
  Explained found;
  found.identified = run.finish({}, "simulated");
  found.circumstances = run.circumstances();
  const auto explainer = std::make_unique<effect::Explainer>();
  EXPECT_TRUE(judge_sums(settings, run.core().effects(), *explainer, found));
  return json::parse(to_json(found));
}

std::string first_step(const json& explanation) {
  const json& steps = explanation.at("steps");
  return steps.empty() ? "" : steps.at(0).at("effect").get<std::string>();
}

class LiveExplaining : public testing::TestWithParam<Ride> {};

/// Effects, a parameter that changed, and faults that look like an effect: what is said while the
/// run goes on is what a file of the same frames says, and so is what its end says.
TEST_P(LiveExplaining, SaysAtAnyTimeWhatAFileOfTheSameFramesSays) {
  const Ride& ride = GetParam();
  sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 23);
  if (*ride.effect != '\0') {
    ASSERT_FALSE(sim::add_effect_text(config, ride.effect));
  }
  sim::Simulation simulation{config};
  Config settings;
  settings.car.moving_mass_kg = config.truck.moving_mass_kg;
  ExplainRun run{settings};
  LiveExplainer explainer{settings, run};
  EXPECT_TRUE(newest(explainer, run, settings).is_discarded());
  std::vector<Sample> samples;
  const auto ride_on = [&](int seconds) {
    for (int n = 0; n < seconds * 300; ++n) {
      samples.push_back(sim::to_sample(simulation.next()));
      if (ride.spoil) ride.spoil(samples.back());
      run.take(samples.back());
    }
  };
  ride_on(ride.length_s);
  // As fast as samples came, the judge would have seen few of them: now it has the time it wants.
  explainer.start();
  json live;
  for (int tenth = 0; tenth < 300 && !live.is_object(); ++tenth) {
    ride_on(1);
    std::this_thread::sleep_for(std::chrono::milliseconds{100});
    live = newest(explainer, run, settings);
  }
  explainer.stop();
  ASSERT_TRUE(live.is_object());
  const json file = explanation_of(settings, samples);
  RunResult end = run.finish({}, "simulated");
  explainer.conclude(end);
  const json concluded = json::parse(end.evidence.explanation);
  EXPECT_EQ(concluded, file);
  for (const char* key : {"verdict", "trust"}) EXPECT_EQ(live.at(key), file.at(key)) << key;
  EXPECT_EQ(first_step(live), ride.named);
  EXPECT_EQ(first_step(file), ride.named);
  EXPECT_EQ(live.at("trust"), ride.trust) << live.at("trust_reasons");
  // The result beside it keeps the law that it identified: it lacks what the explanation names.
  EXPECT_EQ(end.trust == Trust::kTrusted, *ride.named == '\0' && end.faults.list.empty());
}

INSTANTIATE_TEST_SUITE_P(
    Rides, LiveExplaining,
    testing::Values(Ride{"", "", "trusted", 120},
                    Ride{"viscous:coefficient_nspm=120000", "viscous", "trusted", 120},
                    Ride{"time_drift", "time_drift", "model_incomplete", 300},
                    Ride{"", "", "data_faulty", 120,
                         [](Sample& s) { s.accel_mps2[2] = s.accel_mps2[1]; }}),
    [](const auto& ride) {
      return std::string{ride.param.spoil            ? "CopiedChannel"
                         : *ride.param.named == '\0' ? "Clean"
                                                     : ride.param.named};
    });

}  // namespace
}  // namespace dampline::app
