// SPDX-License-Identifier: MIT
// What a run directory keeps of an explanation, and what the page shows of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "app/error.hpp"
#include "app/report/page.hpp"
#include "app/report/plots.hpp"
#include "app/report/sections.hpp"
#include "app/run/directory.hpp"
#include "app/run/tables.hpp"
#include "tests/app/fake_result.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

Evidence some_evidence() {
  Evidence e;
  e.explanation = R"({"verdict": "partly_explained",
    "base": {"terms": ["coulomb"], "held_out_nmse": 0.2, "held_out_rrse": 0.447},
    "final": {"terms": ["coulomb", "cubic_stiffness"], "held_out_nmse": 0.03,
              "held_out_rrse": 0.173},
    "steps": [{"effect": "cubic_stiffness", "held_out_nmse_after": 0.03,
               "parameters": [{"name": "cubic_stiffness", "value": 3.1e11, "std": 2e10,
                               "unit": "N/m^3"}],
               "evidence": {"gain": 0.85, "block_t": 12.5},
               "note": "like cubic_stiffness, law incomplete",
               "runners_up": [{"effect": "bump_stop", "held_out_nmse": 0.05, "gain": 0.75,
                               "block_t": 9.1}]}],
    "rejected": [{"effect": "stribeck", "held_out_nmse": 0.0299, "gain": 0.003, "block_t": 0.7}],
    "floor_nmse": 0.01, "left_over_floor": 3.0,
    "validation": [{"record": "<other>.csv", "rrse_before": 0.61, "rrse_after": 0.22,
                    "rrse_reference": 0.4, "start_slip_m": 0.0031, "rrse_after_where_reference": 0.21}],
    "signature": {"text": "120 N rms; <memoryless>"}})";
  for (const char* over : {"deflection_m", "velocity_mps", "frequency_hz", "time_s"})
    for (int i = 1; i < 9; ++i)
      e.residual.push_back({over, 0.001 * i, 500, 12.5, 800.0, 1.5, 90.0});
  for (int i = 0; i < 50; ++i)
    e.loops.push_back({0.01 * i, 1e-3 * std::sin(0.3 * i), 0.02 * std::cos(0.3 * i),
                       8000.0 * std::cos(0.3 * i), 7000.0, 7900.0});
  e.law = {{-0.02, -8000.0, -8500.0}, {0.02, 8000.0, 8500.0}};
  for (int i = 0; i < 40; ++i) e.prediction.push_back({1, 0.1 * i, 100.0 * i, 90.0 * i, 50.0 * i});
  e.prediction[3].reference_n = 123.5;
  return e;
}

TEST(EvidenceTables, ComeBackAsTheyWere) {
  const Evidence e = some_evidence();
  const auto residual = read_table<ResidualRow>(to_csv(e.residual), "residual.csv");
  ASSERT_EQ(residual.size(), e.residual.size());
  EXPECT_EQ(residual[9].over, "velocity_mps");
  EXPECT_DOUBLE_EQ(residual[9].place, 0.002);
  EXPECT_EQ(residual[9].samples, 500U);
  EXPECT_DOUBLE_EQ(residual[9].before_mean_n, 12.5);
  EXPECT_DOUBLE_EQ(residual[9].after_rms_n, 90.0);
  const auto loops = read_table<LoopRow>(to_csv(e.loops), "loops.csv");
  ASSERT_EQ(loops.size(), e.loops.size());
  EXPECT_NEAR(loops[7].measured_n, e.loops[7].measured_n, 0.01);
  EXPECT_DOUBLE_EQ(loops[7].final_n, 7900.0);
  const auto law = read_table<LawRow>(to_csv(e.law), "law.csv");
  ASSERT_EQ(law.size(), 2U);
  EXPECT_DOUBLE_EQ(law[1].final_n, 8500.0);
  const auto prediction = read_prediction(to_csv(e.prediction), "prediction.csv");
  ASSERT_EQ(prediction.size(), 40U);
  EXPECT_DOUBLE_EQ(prediction[3].reference_n, 123.5);
  EXPECT_TRUE(std::isnan(prediction[4].reference_n));
  EXPECT_DOUBLE_EQ(prediction[4].base_n, 200.0);
  EXPECT_DOUBLE_EQ(prediction[4].predicted_n, 360.0);
}

TEST(EvidenceTables, NameTheLineThatIsDamaged) {
  try {
    static_cast<void>(read_table<LawRow>("velocity_mps,base_n,final_n\n1,2,3\n1,x,3\n", "law.csv"));
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("law.csv:3"), HasSubstr("\"x\"")));
  }
}

TEST(EvidencePage, ShowsVerdictCandidatesAndRecords) {
  RunResult result = fake_result();
  const std::string plain = make_page(result, {"0.1.0", {}}, "");
  EXPECT_THAT(plain, Not(HasSubstr("What the model lacked")));
  result.evidence = some_evidence();
  const std::string page = make_page(result, {"0.1.0", {}}, "");
  EXPECT_THAT(
      page, AllOf(HasSubstr("lacked something like cubic stiffness"), HasSubstr("310 000 000 000"),
                  HasSubstr("like cubic_stiffness, law incomplete"), HasSubstr("3.00 times"),
                  HasSubstr("&lt;memoryless&gt;"), HasSubstr("&lt;other&gt;.csv")));
  EXPECT_THAT(
      page,
      AllOf(
          HasSubstr("bump_stop</td><td role=\"cell\" class=\"number\" data-label=\"round\">1</td>"),
          HasSubstr("explains less"), HasSubstr("not enough to be added"), HasSubstr("0.400"),
          HasSubstr("(3.1 mm)")));
  EXPECT_THAT(page, AllOf(HasSubstr("rms before"), HasSubstr("frequency (Hz)"),
                          HasSubstr("deflection y (mm)"), HasSubstr("reference")));
}

TEST(EvidenceRun, IsReadBackForItsReport) {
  const auto place = std::filesystem::temp_directory_path() / "dampline_evidence_run";
  std::filesystem::remove_all(place);
  {
    RunDirectory directory{place, false};
    RunFiles files{fake_result(), "[car]\n", ""};
    files.result.evidence = some_evidence();
    stage_files(files, directory);
    directory.commit();
  }
  const RunFiles back = read_files(place);
  EXPECT_EQ(back.result.evidence.explanation, some_evidence().explanation);
  EXPECT_EQ(back.result.evidence.residual.size(), 32U);
  EXPECT_EQ(back.result.evidence.loops.size(), 50U);
  EXPECT_EQ(back.result.evidence.law.size(), 2U);
  EXPECT_EQ(back.result.evidence.prediction.size(), 40U);
  std::filesystem::remove_all(place);
}

}  // namespace
}  // namespace dampline::app
