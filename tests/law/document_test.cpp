// SPDX-License-Identifier: MIT
#include "app/law/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "app/error.hpp"

namespace dampline::app::law {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using Part = Unknown::Part;

/// A mass with damping, a spring, sticking friction that fades, and Dahl's element.
Document example() {
  Document out;
  out.subject = Subject::kDrivenMass;
  out.law = {2.0,
             {{{Kind::kVelocity}, 5.0},
              {{Kind::kDeflection}, 500.0},
              {{Kind::kFading, 1e-4, 0.02}, 3.0, true},
              {{Kind::kBoucWen, 1e-3, 0.25}, 4000.0}}};
  out.unknowns = {{"m", Part::kMass, {}},          {"c1", Part::kCoefficient, {0}},
                  {"c2", Part::kCoefficient, {1}}, {"c3", Part::kCoefficient, {2}},
                  {"c4", Part::kCoefficient, {3}}, {"b3", Part::kB, {2}},
                  {"a4", Part::kA, {3}},           {"b4", Part::kB, {3}}};
  out.covariance = Eigen::MatrixXd::Identity(8, 8) * 1e-4;
  out.covariance(1, 2) = out.covariance(2, 1) = 5e-5;
  out.initial = {1e-3, -0.2};
  out.initial.memory_m[0] = 7e-4;
  out.zero_m = 0.5;
  out.force_sign = -1.0;
  out.sample_rate_hz = 500.0;
  out.filter_hz = 27.0;
  out.residual_n = 0.1;
  out.residual_m = 1e-6;
  out.not_in_it = {"time_skew: the force was late by 2 ms"};
  out.record = "run.csv";
  return out;
}

TEST(Document, ComesBackFromItsFile) {
  const Document law = example();
  const std::string text = to_json(law);
  const Document read = read_document(text, "law.json");
  EXPECT_EQ(to_json(read), text);
  EXPECT_EQ(read.values(), law.values());
  EXPECT_EQ(read.initial.memory_m[0], 7e-4);
  EXPECT_TRUE(read.law.terms[2].sharp);
  EXPECT_EQ(read.covariance, law.covariance);
}

TEST(Document, BringsItsFiguresForAFreeRun) {
  Document law = example();
  EXPECT_EQ(law.for_free_run().values(), law.values());
  Eigen::VectorXd values = law.values();
  values[0] = 2.1;
  values[6] = 2e-3;
  State start{2e-3, 0.1};
  start.memory_m[0] = 1e-4;
  law.free_run = {values, 4.0 * law.covariance, start, "0a1b", 3e-6};
  const std::string text = to_json(law);
  const Document read = read_document(text, "law.json");
  EXPECT_EQ(to_json(read), text);
  EXPECT_EQ(read.values(), law.values());
  ASSERT_TRUE(read.free_run);
  EXPECT_EQ(read.free_run->record_sha256, "0a1b");
  const Document moves = read.for_free_run();
  EXPECT_EQ(moves.values(), values);
  EXPECT_EQ(moves.covariance, 4.0 * law.covariance);
  EXPECT_EQ(moves.initial.memory_m[0], 1e-4);
  EXPECT_EQ(moves.residual_m, 3e-6);
  json one_less = json::parse(text);
  one_less["free_run"]["unknowns"].erase(0);
  EXPECT_THROW((void)read_document(one_less.dump(), "law.json"), RunError);
  json earlier = json::parse(text);
  earlier.erase("free_run");
  EXPECT_FALSE(read_document(earlier.dump(), "law.json").free_run);
}

TEST(Document, SaysTheEquation) {
  EXPECT_EQ(example().equation(),
            "m x'' + c1 v + c2 x + c3 sign(v) exp(-|v| / b3) + "
            "c4 z4, z4' = v - (|v| z4 + b4 v |z4|) / a4 = f");
}

TEST(Document, NamesUnitsOfEveryUnknown) {
  const json unknowns = json::parse(to_json(example())).at("unknowns");
  std::string units;
  for (const json& u : unknowns) units += u.at("unit").get<std::string>() + ";";
  EXPECT_EQ(units, "kg;N s/m;N/m;N;N/m;m/s;m;;");
  EXPECT_DOUBLE_EQ(unknowns[1].at("std"), 0.01);
}

TEST(Document, PutsOtherNumbersWhereTheyBelong) {
  const Document law = example();
  Eigen::VectorXd values = law.values();
  values[0] = 3.0;
  values[6] = -1.0;  // a travel stays above 0
  values[7] = -1.5;  // a shape need not
  const Law other = law.with(values);
  EXPECT_EQ(other.mass_kg, 3.0);
  EXPECT_GT(other.terms[3].column.a, 0.0);
  EXPECT_EQ(other.terms[3].column.b, -1.5);
  EXPECT_EQ(other.terms[1].coefficient, 500.0);
}

/// What reading says of the example with one member changed.
std::string refusal(const std::function<void(json&)>& change) {
  json text = json::parse(to_json(example()));
  change(text);
  try {
    static_cast<void>(read_document(text.dump(), "law.json"));
  } catch (const RunError& error) {
    return error.what();
  }
  return "taken";
}

TEST(Document, NamesWhatIsWrongInAFile) {
  EXPECT_EQ(refusal([](json&) {}), "taken");
  EXPECT_THAT(refusal([](json& j) { j["schema"] = "other/1"; }), HasSubstr("other/1"));
  EXPECT_THAT(refusal([](json& j) { j.erase("terms"); }), HasSubstr("terms is missing"));
  EXPECT_THAT(refusal([](json& j) { j["terms"][1]["function"] = "x; rm"; }),
              HasSubstr("terms[1]: function"));
  EXPECT_THAT(refusal([](json& j) { j["terms"][3]["a"] = 0.0; }), HasSubstr("not above 0"));
  EXPECT_THAT(refusal([](json& j) { j["terms"][0]["coefficient"] = nullptr; }),
              HasSubstr("coefficient"));
  EXPECT_THAT(refusal([](json& j) { j["unknowns"][2]["terms"][0] = 9; }), HasSubstr("not there"));
  EXPECT_THAT(refusal([](json& j) { j["covariance"].erase(0); }), HasSubstr("8 by 8"));
  EXPECT_THAT(refusal([](json& j) { j["covariance"][1][2] = 1.0; }), HasSubstr("covariance"));
  EXPECT_THAT(
      refusal([](json& j) { j["initial_state"]["memory_m"] = std::vector<double>(99, 0.0); }),
      HasSubstr("memory_m"));
  EXPECT_THROW(static_cast<void>(read_document("{\"schema\":", "law.json")), RunError);
}

}  // namespace
}  // namespace dampline::app::law
