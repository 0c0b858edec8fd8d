// SPDX-License-Identifier: MIT
// `dampline identify --method wavelet`, run as a person runs it.
#include "tests/app/program.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/rows/simulated.hpp"

namespace dampline::app::wavelet {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class Method : public testing::Test {
 protected:
  Program::Outcome identify(const std::string& arguments) const {
    return program_.run("identify --method wavelet " + arguments);
  }
  /// Values by name, each with the deviation that is stated.
  void expect_parameter(const std::string& run, const std::string& name, double truth) const {
    const auto json = nlohmann::json::parse(program_.read(run + "/parameters.json"));
    for (const auto& p : json.at("parameters")) {
      if (p.at("name") != name) continue;
      EXPECT_NEAR(p.at("value").get<double>(), truth, 3.0 * p.at("std").get<double>()) << name;
      EXPECT_NEAR(p.at("t").get<double>(), p.at("value").get<double>() / p.at("std").get<double>(),
                  1e-9 * std::abs(p.at("t").get<double>()));
      return;
    }
    ADD_FAILURE() << name;
  }
  Measured duffing(std::size_t samples = 4000) const {
    return test::measured_of(test::driven(test::duffing(), 1.0, samples), {2e-5, 0.05}, 3);
  }
  Program program_;
};

TEST_F(Method, ARecordBecomesARunDirectoryWithTermsAndTheirTimeCourse) {
  program_.write("rig.csv", test::csv_of(duffing(), "time_s,deflection_m,force_n"));
  const auto outcome = identify("rig.csv --terms 'v, x, x^3' --mass 1 --wavelet d12 --out run");
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.error, IsEmpty());
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("x^3"), HasSubstr("N/m^3"), HasSubstr("held out"), HasSubstr("COV"),
                    HasSubstr("D12 at level "), HasSubstr("run/report.html")));
  expect_parameter("run", "viscous", 0.6);
  expect_parameter("run", "stiffness", 25.0);
  expect_parameter("run", "cubic_stiffness", 40.0);
  EXPECT_THAT(program_.read("run/convergence.csv"),
              StartsWith("time_s,viscous_nspm,viscous_std_nspm,stiffness_npm,stiffness_std_npm,"
                         "cubic_stiffness_npm3,"));
  EXPECT_THAT(program_.read("run/cov.csv"),
              StartsWith("time_s,viscous_cov,stiffness_cov,cubic_stiffness_cov\n"));
  EXPECT_THAT(program_.read("run/report.html"),
              AllOf(HasSubstr("Coefficients of variation"), HasSubstr("How the estimate settled"),
                    HasSubstr("x^3")));
  EXPECT_FALSE(program_.exists("run/windows.csv"));
}

TEST_F(Method, AReportIsDrawnAgainFromTheFilesAlone) {
  program_.write("rig.csv", test::csv_of(duffing(), "time_s,deflection_m,force_n"));
  ASSERT_EQ(
      identify("rig.csv --terms 'v, x, x^3' --mass 1 --windows 64 --choose-terms --out run").code,
      0);
  EXPECT_TRUE(program_.exists("run/windows.csv"));
  EXPECT_THAT(program_.read("run/term_sets.csv"),
              AllOf(StartsWith("change,t,mse_percent,held_out_mse_percent\nas asked,"),
                    HasSubstr("\nwithout x^3,"), HasSubstr("\nwith sign(v),")));
  const auto page_without_digits = [&] {
    std::string page = program_.read("run/report.html");
    std::erase_if(page, [](unsigned char c) { return std::isdigit(c) != 0 || c == '.'; });
    return page;
  };
  const std::string page = page_without_digits();
  EXPECT_THAT(page, AllOf(HasSubstr("Other sets of terms"), HasSubstr("<h>Windows</h>")));
  ASSERT_EQ(program_.run("report run").code, 0);
  EXPECT_TRUE(page_without_digits() == page) << "the tables round the last digits of drawings";
}

TEST_F(Method, JsonNamesTheMethodAndItsErrors) {
  program_.write("rig.csv", test::csv_of(duffing(), "time_s,deflection_m,force_n"));
  const auto outcome = identify("rig.csv --terms 'v,x,x^3' --mass 1 --level 1 --json --out run");
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_EQ(outcome.output, program_.read("run/parameters.json"));
  const auto method = nlohmann::json::parse(outcome.output).at("method");
  EXPECT_EQ(method.at("wavelet"), "D8");
  EXPECT_EQ(method.at("level"), 1);
  EXPECT_DOUBLE_EQ(method.at("step_s"), 0.04);
  EXPECT_GT(method.at("held_out_mse_percent").at(0), method.at("mse_percent").at(0));
}

TEST_F(Method, OtherHeadersAreUnderstoodAsForRigs) {
  Measured record = duffing();
  for (double& x : record.deflection_m[0]) x *= 1e3;
  program_.write("rig.csv", test::csv_of(record, "time (s),Displacement [mm],Load (N)"));
  ASSERT_EQ(identify("rig.csv --terms 'a, v, x, x^3' --out run").code, 0);
  expect_parameter("run", "stiffness", 25.0);
  expect_parameter("run", "moving_mass", 1.0);
}

TEST_F(Method, TwoMassesAreToldApartByTheNumbersInTheHeader) {
  const Measured record = test::measured_of(test::driven_chain(6000), {1e-5, 0.05}, 5);
  program_.write("chain.csv", test::csv_of(record, "time_s,deflection1_m,x2 [m],force1_n,F2 (N)"));
  const auto outcome =
      identify("chain.csv --masses 2 --mass 2,1 --terms 'v,x,x^3' --terms 'v,x' --out run");
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("x^3 of element 1"), HasSubstr("MSE of mass 2")));
  expect_parameter("run", "element1_stiffness", 60.0);
  expect_parameter("run", "element2_stiffness", 20.0);
  expect_parameter("run", "element2_viscous", 0.4);
}

TEST_F(Method, RowsThatAreNoNumbersAndGapsAreCountedAndLeftOut) {
  std::string text = test::csv_of(duffing(), "time_s,deflection_m,force_n");
  const auto spoil = [&](int row, const std::string& with) {
    std::size_t at = 0;
    for (int i = 0; i <= row; ++i) at = text.find('\n', at) + 1;
    const std::size_t end = text.find('\n', at);
    text.replace(at, end + 1 - at, with);
  };
  spoil(3000, "");                   // a gap
  spoil(1000, "20.000000,nan,0\n");  // no number
  program_.write("rig.csv", text);
  const auto outcome = identify("rig.csv --terms 'v,x,x^3' --mass 1 --json --out run");
  ASSERT_EQ(outcome.code, 0) << outcome.error;
  const auto counts = nlohmann::json::parse(outcome.output).at("counts");
  EXPECT_EQ(counts.at("not_finite"), 1);
  EXPECT_EQ(counts.at("gaps"), 1);
  EXPECT_THAT(program_.read("run/excluded.csv"), HasSubstr("a value that is no number"));
  expect_parameter("run", "stiffness", 25.0);
}

TEST_F(Method, ErrorsSayWhatWasFoundAndWhatIsExpected) {
  program_.write("rig.csv", test::csv_of(duffing(), "time_s,deflection_m,force_n"));
  struct Case {
    const char* arguments;
    int code;
    const char* text;
  };
  for (const Case& c :
       std::vector<Case>{{"rig.csv --terms 'v, sin(x)'", 2, "found 'sin(x)', expected terms"},
                         {"rig.csv", 2, "--terms is required"},
                         {"rig.csv --terms v --wavelet D10", 2, "D10"},
                         {"rig.csv --terms v --level 9", 2, "9 not in range"},
                         {"rig.csv --terms v --windows 32 --recursive", 2, "excludes"},
                         {"rig.csv --terms 'a,v' --mass 1", 2, "beside the term 'a'"},
                         {"rig.csv --terms v --mass 1,2", 2, "found 2 values, expected 1"},
                         {"rig.csv --terms v --terms x", 2, "found 2 sets, expected 1"},
                         {"rig.csv --terms v --masses 2", 1,
                          "no column for deflection1_m, deflection2_m, force1_n or force2_n"},
                         {"none.csv --terms v", 1, "none.csv"}}) {
    const auto outcome = identify(std::string{c.arguments} + " --out run");
    EXPECT_EQ(outcome.code, c.code) << c.arguments;
    EXPECT_THAT(outcome.error + outcome.output, HasSubstr(c.text)) << c.arguments;
    EXPECT_FALSE(program_.exists("run/run.toml")) << c.arguments;
  }
  EXPECT_EQ(program_.run("identify rig.csv --terms v --method spline").code, 2);
}

TEST_F(Method, TheVerbsHelpLeadsToTheMethods) {
  EXPECT_THAT(program_.run("identify --help").output, HasSubstr("--method"));
  const auto help = identify("--help");
  EXPECT_EQ(help.code, 0);
  EXPECT_THAT(help.output, AllOf(HasSubstr("--choose-terms"), HasSubstr("exp(-A*|v|)*sign(v)")));
}

}  // namespace
}  // namespace dampline::app::wavelet
