// SPDX-License-Identifier: MIT
// What the page tells a fitter: of everything that can be found.
#include "app/report/advice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "dampline/explanation.hpp"
#include "dampline/faults.hpp"
#include "tests/app/fake_result.hpp"

namespace dampline::app {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

const Advice* find(std::span<const Advice> table, std::string_view name) {
  for (const Advice& advice : table)
    if (advice.name == name) return &advice;
  return nullptr;
}

TEST(Advice, CoversEveryFaultInItsOrder) {
  ASSERT_GE(fault_advice().size(), kFaultKinds);
  for (std::size_t i = 0; i < kFaultKinds; ++i) {
    const Advice& advice = fault_advice()[i];
    EXPECT_EQ(advice.name, name_of(static_cast<FaultKind>(i)));
    EXPECT_GT(advice.truck.size(), 40U) << advice.name;
  }
  for (const char* of_rigs : {"wrong_value", "wrong_time"}) {
    ASSERT_NE(find(fault_advice(), of_rigs), nullptr);
    EXPECT_GT(find(fault_advice(), of_rigs)->rig.size(), 40U);
  }
}

TEST(Advice, CoversEveryEffect) {
  for (std::size_t i = 0; i < effect::kEffects; ++i) {
    const Advice* const advice =
        find(effect_advice(), effect::name_of(static_cast<effect::Effect>(i)));
    ASSERT_NE(advice, nullptr) << effect::name_of(static_cast<effect::Effect>(i));
    EXPECT_GT(advice->truck.size(), 40U) << advice->name;
    EXPECT_GT(advice->rig.size(), 20U) << advice->name;
  }
  for (const char* other : {"time_drift", "coulomb", "asymmetric_coulomb", "offset_force",
                            "cross_axis"}) {  // what the core does not look for in a truck
    ASSERT_NE(find(effect_advice(), other), nullptr) << other;
    EXPECT_GT(find(effect_advice(), other)->rig.size(), 20U) << other;
  }
}

TEST(Advice, SaysNothingTwice) {
  std::set<std::string_view> names;
  std::set<std::string_view> titles;
  std::set<std::string_view> texts;
  std::size_t all = 0;
  for (const auto& table : {fault_advice(), effect_advice()})
    for (const Advice& advice : table) {
      ++all;
      names.insert(advice.name);
      titles.insert(advice.title);
      if (!advice.truck.empty()) texts.insert(advice.truck);
    }
  EXPECT_EQ(names.size(), all);
  EXPECT_EQ(titles.size(), all);
  EXPECT_EQ(texts.size(), all - 5) << "five are of rigs only";
}

TEST(Advice, NamesFaultsFirstAndGapsInMillimetres) {
  RunResult result = fake_result();
  result.faults.list = {{"spikes", "wheelset1", 12.0, 61.0, 31.5, "m/s^2", 4, {}}};
  result.faults.drift = DriftFinding{"coulomb", true, 150.0, 16.0, 0.2, {12.0, 1.5}};
  result.evidence.explanation = R"({"verdict": "partly_explained",
    "steps": [{"effect": "backlash", "parameters": [
      {"name": "backlash_gap", "value": 0.0003, "std": 4e-6, "unit": "m"}]}],
    "signature": {"text": "<b>12 Hz"}})";
  const std::string html = advice_section(result);
  EXPECT_THAT(html, AllOf(HasSubstr("wheelset1, from 12 s to 1 min 1 s of the record, 31.5 m/s^2"),
                          HasSubstr("loose, a chafed cable"),
                          HasSubstr("gap: 0.3000 ± 0.0040 mm in y, 0.15 mm between"),
                          HasSubstr("feeler gauge"), HasSubstr("no name"),
                          HasSubstr("&lt;b&gt;12 Hz"), HasSubstr("coulomb changed by +12.0")));
  EXPECT_LT(html.find("Single wrong"), html.find("Free play"));
  EXPECT_LT(html.find("Free play"), html.find("changed during"));
  result.kind = "rig";
  EXPECT_THAT(advice_section(result),
              AllOf(HasSubstr("clamping and the joints"), Not(HasSubstr("between frame"))));
}

TEST(Advice, SaysWhetherSomebodyLooked) {
  RunResult result = fake_result();
  EXPECT_THAT(advice_section(result), HasSubstr("are looked for by dampline explain"));
  result.evidence.explanation = R"({"verdict": "complete", "steps": []})";
  EXPECT_THAT(advice_section(result), HasSubstr("has nothing that the model lacks"));
  result.evidence.explanation.clear();
  result.lacking = {"viscous"};  // live, beside the estimate
  EXPECT_THAT(advice_section(result), HasSubstr("hydraulic damper"));
}

}  // namespace
}  // namespace dampline::app
