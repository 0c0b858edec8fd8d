// SPDX-License-Identifier: MIT
// The JSON files of real runs against the schema that is shipped, by Debian's python3-jsonschema.
#include <gmock/gmock.h>

#include <chrono>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "app/live/run.hpp"
#include "app/record/frames.hpp"
#include "app/run/directory.hpp"
#include "app/run/json.hpp"
#include "drivers/os/system_clock.hpp"
#include "sim_hw/simulated_source.hpp"
#include "tests/run_files/run_test.hpp"

namespace dampline::app {
namespace {

using testing::HasSubstr;

class Schema : public RunFilesTest {
 protected:
  void SetUp() override {
    if (!has_module("jsonschema")) GTEST_SKIP() << "no python3-jsonschema";
  }
  Program::Outcome validate(const std::string& file) const {
    return shell("/usr/bin/python3 -W ignore -m jsonschema -i '" + file +
                 "' '" DAMPLINE_SOURCE_DIR "/app/run/schema/dampline.schema.json'");
  }
  void expect_valid(const std::string& file) const {
    const auto outcome = validate(file);
    EXPECT_EQ(outcome.code, 0) << file << '\n' << outcome.output << outcome.error;
  }
  /// `change` makes the file wrong.
  template <class Change>
  void expect_refused(const std::string& file, const char* what, Change change) const {
    auto parameters = nlohmann::json::parse(program_.read(file));
    change(parameters);
    program_.write("changed.json", parameters.dump());
    EXPECT_EQ(validate("changed.json").code, 1) << what;
  }
};

TEST_F(Schema, HoldsForATruck) {
  simulate("run.log", "--effect backlash");
  program_.write("car.toml", "[record]\nvehicle = \"V\"\n");
  expect_success("identify run.log --config car.toml --methods all --quiet --no-report --out i");
  expect_valid("i/parameters.json");
  expect_success("explain run.log --quiet --no-report --out e --validate run.log");
  expect_valid("e/parameters.json");
  expect_valid("e/explanation.json");
  expect_valid("e/law.json");
  EXPECT_THAT(program_.read("e/explanation.json"), HasSubstr("\"backlash\""));
}

TEST_F(Schema, HoldsForFaultyData) {
  simulate("run.log",
           "--fault stuck:channel=wheelset1,start_s=10,end_s=16 --fault "
           "loss:fraction=0.0001 --effect time_drift");
  expect_success("identify run.log --quiet --no-report --out i");
  expect_valid("i/parameters.json");
  const auto parameters = nlohmann::json::parse(program_.read("i/parameters.json"));
  EXPECT_FALSE(parameters.at("faults").empty());
  program_.run("explain run.log --quiet --no-report --out e");
  expect_valid("e/explanation.json");
}

TEST_F(Schema, HoldsForARig) {
  write_rig("rig.csv");
  write_rig("other.csv", 1300.0);
  expect_success("identify rig.csv --quiet --no-report --out i");
  expect_valid("i/parameters.json");
  expect_success("explain rig.csv --quiet --no-report --out e --validate other.csv");
  expect_valid("e/parameters.json");
  expect_valid("e/explanation.json");
  expect_valid("e/law.json");
  expect_refused("e/law.json", "no covariance",
                 [](nlohmann::json& law) { law.erase("covariance"); });
  expect_success("explain rig.csv other.csv --quiet --no-report --out both");
  expect_valid("both/parameters.json");
  expect_valid("both/explanation.json");
}

TEST_F(Schema, HoldsForTheMethodOfWaveletRows) {
  write_rig("rig.csv");
  expect_success(
      "identify rig.csv --method wavelet --terms 'sign(v), x, v' --windows 64 "
      "--choose-terms --quiet --no-report --out w");
  expect_valid("w/parameters.json");
}

/// Some 60,000 frames a second, so that there is time to publish.
class Paced final : public hal::FrameSource {
 private:
  Result<std::size_t> do_read(std::span<CanFrame> out) noexcept override {
    std::this_thread::sleep_for(std::chrono::milliseconds{1});
    return inner_.read(out);
  }
  Result<bool> do_wait(std::chrono::nanoseconds /*timeout*/) noexcept override { return true; }
  [[nodiscard]] hal::SourceHealth do_health() const noexcept override { return inner_.health(); }
  sim::SimulatedSource inner_{sim::reference_run(sim::Load::kLaden, 80.0, 5), 120 * 300};
};

class VoidSink final : public hal::RecordSink {
  void do_write(const CanFrame& /*frame*/) noexcept override {}
  void do_write(const hal::Event& /*event*/) noexcept override {}
  void do_tick(std::int64_t /*monotonic_ns*/) noexcept override {}
  void do_rotate() noexcept override {}
  void do_close() noexcept override {}
  [[nodiscard]] hal::RecordHealth do_health() const noexcept override { return {}; }
};

/// Without a bus: a simulated source through the threads of a live run.
TEST_F(Schema, HoldsForALiveRun) {
  const drivers::SystemClock clock;
  VoidSink sink;
  Paced source;
  std::vector<std::string> published;
  LiveOutlets outlets;
  outlets.publish = [&](const RunResult& result) { published.push_back(to_json(result)); };
  const LiveParts parts{
      "can0", &source, &sink, &clock, hal::RunTime::start(clock), {{"can0", "interface", 0, ""}}};
  const LiveOptions options{.publish_every_s = 0.2, .realtime_priority = 0};
  Config config;
  config.record.vehicle = "V";
  const Identified found =
      LiveRun{config, can_channels(config), parts, options, std::move(outlets)}.run();
  ASSERT_GE(published.size(), 3U);
  program_.write("first.json", published.front());
  program_.write("live.json", published.back());
  program_.write("parameters.json", to_json(make_files(config, found.result, found.inputs).result));
  expect_valid("first.json");
  expect_valid("live.json");
  expect_valid("parameters.json");
  const auto live = nlohmann::json::parse(published.back());
  EXPECT_EQ(live.at("schema"), "dampline.live/1");
  EXPECT_EQ(live.at("vehicle"), "V");
  EXPECT_EQ(live.at("source"), "can0");
  const auto written_ns = utc_ns(live.at("written_utc").get<std::string>());
  ASSERT_TRUE(written_ns.has_value());
  EXPECT_LT(std::abs(clock.realtime_ns() - *written_ns), 60'000'000'000);
  expect_refused("live.json", "no time stamp", [](auto& state) { state.erase("written_utc"); });
}

TEST_F(Schema, RefusesWhatIsNone) {
  using nlohmann::json;
  simulate("run.log");
  expect_success("identify run.log --quiet --no-report --out i");
  const char* file = "i/parameters.json";
  expect_valid(file);
  expect_refused(file, "another schema", [](json& j) { j["schema"] = "dampline.parameters/2"; });
  expect_refused(file, "no schema", [](json& j) { j.erase("schema"); });
  expect_refused(file, "a member gone", [](json& j) { j.erase("trust"); });
  expect_refused(file, "a truck's member gone", [](json& j) { j.erase("repair"); });
  expect_refused(file, "an unknown member", [](json& j) { j["trusted"] = true; });
  expect_refused(file, "another word", [](json& j) { j["trust"] = "yes"; });
  expect_refused(file, "text for a number", [](json& j) { j["parameters"][0]["value"] = "1"; });
  expect_refused(file, "no unit", [](json& j) { j["parameters"][0].erase("unit"); });
  expect_refused(file, "a local time", [](json& j) { j["start_utc"] = "2023-11-14 22:13:20"; });
  expect_refused(file, "a count below 0", [](json& j) { j["counts"]["gaps"] = -1; });
  expect_refused(file, "no checksum", [](json& j) { j["sha256"] = "abc"; });
  expect_refused(file, "live without live", [](json& j) { j["schema"] = "dampline.live/1"; });
}

}  // namespace
}  // namespace dampline::app
