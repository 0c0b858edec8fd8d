// SPDX-License-Identifier: MIT
// What a result says about where it comes from.
#include "app/run/provenance.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "app/run/json.hpp"
#include "tests/app/fake_result.hpp"
#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using nlohmann::json;
using testing::MatchesRegex;

constexpr std::int64_t kSecondNs = 1'000'000'000;

TEST(Utc, IsWrittenAsDatePrintsIt) {
  // `date -u -d @SECONDS +%FT%TZ` of GNU coreutils, with the fraction in between.
  EXPECT_EQ(utc_text(1'700'000'000 * kSecondNs + 190'499), "2023-11-14T22:13:20.000190Z");
  EXPECT_EQ(utc_text(951'782'399 * kSecondNs + 999'999'999), "2000-02-28T23:59:59.999999Z");
  EXPECT_EQ(utc_text(951'782'400 * kSecondNs), "2000-02-29T00:00:00.000000Z");
  EXPECT_EQ(utc_text(4'102'444'799 * kSecondNs), "2099-12-31T23:59:59.000000Z");
  EXPECT_EQ(utc_text(-1), "1969-12-31T23:59:59.999999Z");
}

TEST(Utc, IsReadAsItIsWritten) {
  for (const std::int64_t second : {631'152'000L, 951'782'400L, 1'700'000'000L, 4'102'444'799L}) {
    const std::int64_t time_ns = second * kSecondNs + 123'456'000;
    EXPECT_EQ(utc_ns(utc_text(time_ns)), time_ns);
  }
  for (const char* text : {"", "2023-11-14", "2023-11-14T22:13:20Z", "2023-11-14T22:13:20.000190",
                           "2023-11-14 22:13:20.000190Z", "2023-11-14T22:-3:20.000190Z"})
    EXPECT_EQ(utc_ns(text), std::nullopt) << text;
}

TEST(RecordedTime, IsADateFrom1990On) {
  EXPECT_EQ(recorded_span_s(1.7e9, 1.7e9 + 0.5).end_ns, 1'700'000'000'500'000'000);
  EXPECT_EQ(recorded_span_s(0.0, 60.0).start_ns, std::nullopt);
  EXPECT_EQ(recorded_span_s(3.0e8, 3.0e8 + 60.0).start_ns, std::nullopt) << "ten years of uptime";
  EXPECT_EQ(recorded_span_s(1.7e9, 1.6e9).start_ns, std::nullopt);
  EXPECT_EQ(recorded_span_s(1.7e12, 1.7e12).start_ns, std::nullopt);
  EXPECT_EQ(recorded_span_s(std::nan(""), 1.7e9).end_ns, std::nullopt);
}

TEST(OriginOfAResult, SurvivesItsFile) {
  RunResult result = fake_result();
  Origin& origin = result.origin;
  origin.version = "9.8.7";
  origin.commit = "0123456789ab";
  origin.source = "a \"b\".log";
  origin.sha256 = "ff";
  origin.recorded = recorded_span(1'700'000'000 * kSecondNs, 1'700'000'060 * kSecondNs);
  origin.vehicle = "31 80 4567 123-4";
  origin.truck = "A";
  origin.other_inputs = {{"car.dbc", "dbc", 7, "ee"}, {"can0", "interface", 0, ""}};
  const std::string text = to_json(result);
  EXPECT_EQ(json::parse(text).at("note"), nullptr);
  EXPECT_EQ(json::parse(text).at("other_inputs").at(1).at("sha256"), nullptr);
  const RunResult read = from_json(text, "parameters.json");
  EXPECT_EQ(read.origin.recorded.end_ns, 1'700'000'060 * kSecondNs);
  EXPECT_EQ(read.origin.other_inputs.at(0).bytes, 7U);
  EXPECT_EQ(to_json(read), text);
}

class Origins : public testing::Test {
 protected:
  json identify(const std::string& arguments, const std::string& before = "") const {
    const auto outcome = program_.run("identify --no-report --json " + arguments, before);
    EXPECT_EQ(outcome.code, 0) << outcome.error;
    return json::parse(outcome.output);
  }
  void simulate(const std::string& name) const {
    ASSERT_EQ(program_.run("simulate --duration 60 --quiet --out " + name).code, 0);
  }
  Program program_;
};

TEST_F(Origins, OfACandumpLogAreDatedAndLabelled) {
  simulate("run.log");
  program_.write("car.toml", "[record]\nvehicle = \"V\"\ntruck = \"B\"\nnote = \"laden\"\n");
  const json found = identify("run.log --config car.toml --out a");
  EXPECT_EQ(found.at("schema"), "dampline.parameters/1");
  EXPECT_EQ(found.at("version"), version());
  EXPECT_EQ(found.at("start_utc"), "2023-11-14T22:13:20.000190Z")
      << program_.read("run.log").substr(0, 30);
  EXPECT_THAT(found.at("end_utc").get<std::string>(),
              MatchesRegex("2023-11-14T22:14:19[.]99[0-9]+Z"));
  EXPECT_EQ(found.at("vehicle"), "V");
  EXPECT_EQ(found.at("truck"), "B");
  EXPECT_EQ(found.at("note"), "laden");
  ASSERT_EQ(
      std::system(("cd '" + program_.path("").string() + "' && sha256sum run.log > sum").c_str()),
      0);
  EXPECT_EQ(found.at("sha256"), program_.read("sum").substr(0, 64));
  const json explained =
      json::parse(program_.run("explain run.log --out e --quiet --no-report").code == 0
                      ? program_.read("e/parameters.json")
                      : "{}");
  EXPECT_EQ(explained.at("start_utc"), found.at("start_utc"));
  EXPECT_EQ(explained.at("sha256"), found.at("sha256"));
}

TEST_F(Origins, WithoutAnEpochSayNullAndAPipeIsSummedAsItPasses) {
  simulate("run.csv");
  const json csv = identify("run.csv --out a");
  for (const char* key : {"start_utc", "end_utc", "vehicle", "truck", "note"})
    EXPECT_EQ(csv.at(key), nullptr) << key;
  EXPECT_EQ(csv.at("source"), "run.csv");
  simulate("run.log");
  const json piped = identify("- --out b", "cat run.log |");
  EXPECT_EQ(piped.at("sha256"), describe_input(program_.path("run.log"), "record").sha256);
  EXPECT_EQ(piped.at("start_utc"), "2023-11-14T22:13:20.000190Z");
}

TEST_F(Origins, OfACsvFileCountedFrom1970AreDated) {
  simulate("run.csv");
  ASSERT_EQ(std::system(("cd '" + program_.path("").string() +
                         "' && awk -F, 'BEGIN{OFS=\",\"} NR>1 && /^[0-9]/ {$1=sprintf(\"%.6f\", "
                         "$1+1700000000)} {print}' run.csv > dated.csv")
                            .c_str()),
            0);
  const json plain = identify("run.csv --out a");
  const json dated = identify("dated.csv --out b");
  EXPECT_THAT(dated.at("start_utc").get<std::string>(), MatchesRegex("2023-11-14T22:13:20[.]0.*Z"));
  const double level = plain.at("parameters").at(0).at("value");
  EXPECT_NEAR(dated.at("parameters").at(0).at("value"), level, 1e-3 * level);
}

}  // namespace
}  // namespace dampline::app
