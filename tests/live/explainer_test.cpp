// SPDX-License-Identifier: MIT
#include "app/live/explainer.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "app/diagnosis/truck/explanation.hpp"
#include "app/diagnosis/truck/verdict.hpp"
#include "sim_hw/effects/registry.hpp"
#include "sim_hw/simulation.hpp"
#include "tests/app/plain_truck.hpp"
#include "tests/explain/other_truck.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;

/// Beside the result of the moment, as live.json has it; no JSON while there is none.
json newest(const LiveExplainer& explainer, ExplainRun& run, const Config& settings) {
  RunResult beside;
  if (!run.empty()) beside = describe_view(run.view(), {}, settings, "simulated");
  beside.live.emplace();
  explainer.add_newest(beside, run.time_s());
  json out = json::parse(beside.evidence.explanation, nullptr, false);
  if (out.is_object()) out["age_s"] = beside.live->explanation_age_s.value();
  return out;
}

using Source = std::function<Sample()>;  // one sample after the other

struct Ride {
  const char* effect;  ///< as --effect takes it; empty: none
  const char* named;   ///< the first step; empty: none
  const char* trust;
  int length_s;
  std::function<void(Sample&)> spoil{};
  Source (*source)() = nullptr;  ///< null: the program's own simulation
};

Source simulated(const Ride& ride, const Config& settings) {
  sim::SimulationConfig config = sim::reference_run(sim::Load::kLaden, 80.0, 23);
  EXPECT_EQ(config.truck.moving_mass_kg, settings.car.moving_mass_kg);
  if (*ride.effect != '\0') {
    EXPECT_FALSE(sim::add_effect_text(config, ride.effect));
  }
  auto simulation = std::make_shared<sim::Simulation>(config);
  return [simulation] { return sim::to_sample(simulation->next()); };
}

/// By the other simulation; it is 440 s long.
Source beside_another_truck() {
  constexpr double kLengthS = 440.0;
  auto text = std::make_shared<std::istringstream>(
      test::record_of(test::coupled({5600.0, 0.43}, kLengthS), 1, kLengthS));
  std::string header;
  std::getline(*text, header);
  return [text, tick = std::int64_t{0}]() mutable {
    Sample out;
    char comma = ',';
    double time_s = 0.0;
    *text >> time_s;
    for (double& a : out.accel_mps2) *text >> comma >> a;
    out.tick = tick++;
    out.time_ns = std::llround(1e9 * time_s);
    return out;
  };
}

/// What `dampline explain` says of a file of these samples.
json explanation_of(const Config& settings, const std::vector<Sample>& samples) {
  const auto folder = std::filesystem::temp_directory_path() /
                      ("dampline_live_explainer_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto path = folder / "record.csv";
  {
    std::ofstream out{path};
    out << "time_s,frame_accel_mps2,wheelset1_accel_mps2,wheelset2_accel_mps2\n";
    for (const Sample& s : samples)
      out << fmt::format("{:.9f},{},{},{}\n", static_cast<double>(s.tick) / 300.0, s.accel_mps2[0],
                         s.accel_mps2[1], s.accel_mps2[2]);
  }
  const Explained found = explain_truck(settings, {{path.string()}, {}, false});
  std::filesystem::remove_all(folder);
  return json::parse(to_json(told(found)));
}

std::string first_step(const json& explanation) {
  const json& steps = explanation.at("steps");
  return steps.empty() ? "" : steps.at(0).at("effect").get<std::string>();
}

/// 0: it is unknown.
double floor_of(const json& explanation) {
  const json& floor = explanation.at("floor_nmse");
  return floor.is_number() ? floor.get<double>() : 0.0;
}

class LiveExplaining : public testing::TestWithParam<Ride> {};

/// Effects, a parameter that changed, and faults that look like an effect: what is said while the
/// run goes on is what a file of the same samples says that is read as often as needed, and so is
/// what its end says; the floor, too, although only the newest minutes are kept for it.
TEST_P(LiveExplaining, SaysAtAnyTimeWhatAFileOfTheSameFramesSays) {
  const Ride& ride = GetParam();
  Config settings;
  settings.car.moving_mass_kg = test::kMassKg;
  Source next = ride.source != nullptr ? ride.source() : simulated(ride, settings);
  ExplainRun run{settings};
  LiveExplainer explainer{settings, run, LiveExplainer::Pace::kWaits};
  EXPECT_TRUE(newest(explainer, run, settings).is_discarded());
  std::vector<Sample> samples;
  const auto ride_on = [&](int seconds) {
    for (int n = 0; n < seconds * 300; ++n) {
      samples.push_back(next());
      if (ride.spoil) ride.spoil(samples.back());
      run.take(samples.back());
    }
  };
  explainer.start();
  ride_on(ride.length_s);
  // As fast as samples came, the judge saw few of them: now it gets more time, and ever more.
  json live;
  const auto is_of_now = [&] { return live.is_object() && live.at("age_s") < 30.0; };
  const int pause_ms = ride.source == nullptr ? 200 : 1000;  // looking for a truck takes seconds
  for (int turn = 0; turn < 300 && !is_of_now(); ++turn) {
    ride_on(1);
    std::this_thread::sleep_for(std::chrono::milliseconds{pause_ms + 10 * turn});
    live = newest(explainer, run, settings);
  }
  explainer.stop();
  ASSERT_TRUE(is_of_now());
  const json file = explanation_of(settings, samples);
  RunResult end = run.finish({}, "simulated");
  explainer.conclude(end);
  const json concluded = json::parse(end.evidence.explanation);
  // Beside another truck it is explained from the newest minutes, the file from the whole of it:
  // after more of them, on a slow machine, what is left need not be the same.
  const bool same_samples =
      ride.source == nullptr || static_cast<double>(samples.size()) <= 300.0 * LiveFloor::kKeptS;
  for (const json& said : {live, concluded}) {
    EXPECT_EQ(first_step(said), ride.named);
    if (!same_samples) continue;
    // Of a wheelset that is a copy the noise is not known: the floor scatters more.
    EXPECT_NEAR(floor_of(said), floor_of(file), (ride.spoil ? 0.2 : 0.1) * floor_of(file));
    for (const char* key : {"verdict", "trust"}) EXPECT_EQ(said.at(key), file.at(key)) << key;
    EXPECT_EQ(said.at("trust"), ride.trust) << said.at("trust_reasons");
  }
  EXPECT_EQ(first_step(file), ride.named);
  // The result beside it keeps the law that it identified: it lacks what the explanation names.
  EXPECT_EQ(end.trust == Trust::kTrusted, *ride.named == '\0' && end.faults.list.empty());
}

std::string ride_name(const testing::TestParamInfo<Ride>& ride) {
  return ride.param.spoil            ? "CopiedChannel"
         : *ride.param.named == '\0' ? "Clean"
                                     : ride.param.named;
}

INSTANTIATE_TEST_SUITE_P(
    Rides, LiveExplaining,
    testing::Values(Ride{"", "", "trusted", 300},
                    Ride{"viscous:coefficient_nspm=120000", "viscous", "trusted", 120},
                    Ride{"time_drift", "time_drift", "trusted", 300},
                    Ride{"", "", "data_faulty", 120,
                         [](Sample& s) { s.accel_mps2[2] = s.accel_mps2[1]; }}),
    ride_name);
// What looks for the other truck takes minutes on a build that watches its threads.
INSTANTIATE_TEST_SUITE_P(OtherTruck, LiveExplaining,
                         testing::Values(Ride{
                             "", "other_truck", "trusted", 120, {}, beside_another_truck}),
                         ride_name);

struct SensorFault {
  const char* name;
  test::PlainSensors sensors;
};

class LiveFaultsOfSensors : public testing::TestWithParam<SensorFault> {};

/// The run's result names at its end what only an explanation finds, and is trusted no more: the
/// level is 6 and 3 % low.
TEST_P(LiveFaultsOfSensors, AreInItsResult) {
  const test::PlainTruck& truck = test::kPlainTrucks.back();
  const Config settings = test::plain_config(truck, {});
  const test::PlainMotion motion = test::plain_motion(truck, GetParam().sensors, 200.1, 8201);
  const test::PlainRows rows = test::plain_rows(motion, GetParam().sensors, 200.0);
  ExplainRun run{settings};
  LiveExplainer explainer{settings, run, LiveExplainer::Pace::kWaits};
  explainer.start();
  for (std::size_t i = 0; i < rows[0].size(); ++i) {
    Sample sample;
    sample.tick = static_cast<std::int64_t>(i);
    sample.accel_mps2 = {rows[0][i], rows[1][i], rows[2][i]};
    run.take(sample);
  }
  run.close();
  explainer.stop();
  RunResult result = describe_view(run.view(), {}, settings, "simulated");
  EXPECT_TRUE(result.faults.list.empty());
  explainer.conclude(result);
  ASSERT_EQ(result.faults.list.size(), 1U);
  EXPECT_EQ(result.faults.list[0].name, GetParam().name);
  EXPECT_EQ(result.faults.list[0].channel, "frame");
  EXPECT_EQ(result.trust, Trust::kDataFaulty);
  const json told = json::parse(result.evidence.explanation);
  EXPECT_EQ(told.at("faults").at(0).at("name"), GetParam().name);
  EXPECT_TRUE(told.at("steps").empty());
}

INSTANTIATE_TEST_SUITE_P(Kinds, LiveFaultsOfSensors,
                         testing::Values(SensorFault{"wrong_low_pass",
                                                     {.own_corner_hz = {60.0, 0.0, 0.0}}},
                                         SensorFault{"foreign_motion", {.off_centre_m = 0.1}}),
                         [](const auto& of) { return std::string{of.param.name}; });

}  // namespace
}  // namespace dampline::app
