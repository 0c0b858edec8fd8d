// SPDX-License-Identifier: MIT
// How the page begins.
#include "app/report/answer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "app/error.hpp"
#include "app/law/document.hpp"
#include "app/report/page.hpp"
#include "app/report/sections.hpp"
#include "tests/app/fake_result.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kRun = "[car]\nmoving_mass_kg = 37200.0\n[input]\nspeed_mps = 22.2222\n";

TEST(Answer, StatesLevelsWithBandsTrustLoadAndSpeed) {
  const std::string html = answer_section(fake_result(), kRun);
  // 8351.2 ± 14.3 N: two deviations to both sides.
  EXPECT_THAT(html, AllOf(HasSubstr("8351 ± 14 N"), HasSubstr("8323 to 8380 N in 19 of 20 cases"),
                          HasSubstr("5.262 ± 0.016 MN/m"), HasSubstr("at one wheelset"),
                          HasSubstr("37.2 t"), HasSubstr("80 km/h"), HasSubstr("5 min")));
  EXPECT_THAT(html, HasSubstr("trusted</dd>"));
}

TEST(Answer, LeavesOutWhatIsNotKnown) {
  RunResult result = fake_result();
  EXPECT_THAT(answer_section(result, "[run]\n"),
              AllOf(Not(HasSubstr("Load")), Not(HasSubstr("km/h")), HasSubstr("mm/s")));
  result.densities.clear();
  EXPECT_THAT(answer_section(result, "no TOML = ="), Not(HasSubstr("Speed")));
}

TEST(Answer, StatesNoNumberThatIsNotToBeTrusted) {
  RunResult result = fake_result();
  result.trust = Trust::kDataFaulty;
  result.trust_reasons = {"The data have faults: <spikes>."};
  result.headline = "The data are faulty.";
  EXPECT_THAT(answer_section(result, kRun),
              AllOf(HasSubstr("data faulty"), HasSubstr("&lt;spikes&gt;"), HasSubstr("not stated"),
                    Not(HasSubstr("8351")), Not(HasSubstr("5.262"))));
}

TEST(Answer, SaysThatABandIsALowerBound) {
  RunResult result = fake_result();
  result.std_is_lower_bound = true;
  EXPECT_THAT(answer_section(result, kRun), HasSubstr("8323 to 8380 N, at least"));
}

TEST(Identity, SaysWhichVehicleAndWhenWhereThatIsKnown) {
  RunResult result = fake_result();
  EXPECT_EQ(identity_section(result, {"0.1.0", {{"a<b.log", "record", 1, ""}}}, "[run]\n"),
            "<h1>dampline: a&lt;b.log</h1>\n");
  result.origin.recorded = {1'700'000'000'000'190'000, 1'700'000'300'500'000'000};
  EXPECT_THAT(identity_section(
                  result, {}, "[record]\nvehicle = \"31 80 <5>\"\ntruck = \"B\"\nnote = \"wet\"\n"),
              HasSubstr("Vehicle 31 80 &lt;5&gt; \u00b7 truck B \u00b7 2023-11-14 22:13:20 to "
                        "22:18:20 UTC \u00b7 wet"));
}

TEST(Identity, NamesBothDaysOfARecordAcrossMidnight) {
  RunResult result = fake_result();
  result.origin.recorded = {1'700'000'000'000'000'000, 1'700'010'000'000'000'000};
  EXPECT_THAT(identity_section(result, {}, ""),
              HasSubstr("2023-11-14 22:13:20 to 2023-11-15 01:00:00 UTC"));
}

/// The same order for a record, a live run and an explanation.
TEST(Answer, StandsAboveCurveAndAdviceOnEveryPage) {
  RunResult live = fake_result();
  make_live(live);
  live.evidence.explanation = R"({"verdict": "complete", "steps": []})";
  for (const RunResult& result : {fake_result(), live}) {
    const std::string page = make_page(result, {"0.1.0", {{"can0", "record", 0, ""}}}, kRun);
    std::size_t last = 0;
    for (const char* part :
         {"dampline: can0</h1>", "class=\"lead\"", "Friction level", "Stiffness", "Trust", "Load",
          "Speed", ">Damping curve<", ">What to check on the truck<", ">Parameters<"}) {
      const std::size_t at = page.find(part, last);
      ASSERT_NE(at, std::string::npos) << part;
      last = at;
    }
  }
  EXPECT_THAT(make_page(live, {}, kRun),
              AllOf(HasSubstr("identified live"), HasSubstr("The model is complete"),
                    Not(HasSubstr("Verdict:"))));
}

/// A mass that is given, a stop on both sides at one gap, and Dahl's element.
law::Document example_law() {
  using law::Kind;
  using Part = law::Unknown::Part;
  law::Document out;
  out.subject = law::Subject::kDrivenMass;
  out.law = {2.0,
             {{{Kind::kDeflection}, 5.26e6},
              {{Kind::kBumpUp, 0.0014}, 9e6},
              {{Kind::kBumpDown, 0.0014}, 9e6},
              {{Kind::kStop, 1e-4}, 812.0}}};
  out.unknowns = {{"c1", Part::kCoefficient, {0}},
                  {"c2", Part::kCoefficient, {1, 2}},
                  {"a2", Part::kA, {1, 2}},
                  {"c4", Part::kCoefficient, {3}}};
  out.covariance = Eigen::MatrixXd::Zero(4, 4);
  out.covariance.diagonal() << 1e8, 1e10, 1e-10, 4.0;
  out.residual_n = 1.25;
  out.residual_m = 3.0e-3;
  out.filter_hz = 20.0;
  out.not_in_it = {"time_skew: the force was late by <2> ms"};
  return out;
}

TEST(LawAsAnEquation, HasItsUnknownsWhatIsGivenAndWhatItLeaves) {
  RunResult result = fake_result();
  EXPECT_EQ(law_section(result), "");
  law::Document law = example_law();
  result.law = law::to_json(law);
  const std::string html = law_section(result);
  EXPECT_THAT(html, HasSubstr("<code>m x'' + c1 x + c2 max(x - a2, 0)"));
  EXPECT_THAT(html, AllOf(HasSubstr("5.260 ± 0.010 MN/m"), HasSubstr("c2 = c3"),
                          HasSubstr("a2 = a3"), HasSubstr("1.400 ± 0.010 mm")));
  EXPECT_THAT(html, HasSubstr("Given: m = 2 kg, a4 = 0.1 mm."));
  EXPECT_THAT(html, AllOf(HasSubstr("1.25 N rms of the force behind a low pass of 20 Hz"),
                          HasSubstr("3 mm rms of the motion"), HasSubstr("late by &lt;2&gt; ms"),
                          HasSubstr("z follows x"), Not(HasSubstr("for a free run"))));
  Eigen::VectorXd values = law.values();
  values[3] = 790.0;
  law.free_run = {values, 4.0 * law.covariance, {}, "", 1.5e-3};
  result.law = law::to_json(law);
  EXPECT_THAT(law_section(result),
              AllOf(HasSubstr("for a free run"), HasSubstr("790.0 ± 4.0 N"),
                    HasSubstr("1.5 mm rms of that motion by the figures for a free run")));
  EXPECT_THAT(make_page(result, {}, kRun), HasSubstr(">The law as an equation<"));
  result.law = "{}";
  EXPECT_THROW((void)law_section(result), RunError);
}

TEST(Counters, ThatAreZeroAreFolded) {
  RunResult result = fake_result();
  result.counts = {{"samples", 90000}, {"gaps", 0}, {"lost", 0}};
  const std::string page = make_page(result, {}, kRun);
  const std::size_t folded = page.find("<summary>2 counters that are 0</summary>");
  ASSERT_NE(folded, std::string::npos);
  EXPECT_LT(page.find("samples read"), folded);
  EXPECT_GT(page.find("gaps in the sequence"), folded);
}

}  // namespace
}  // namespace dampline::app
