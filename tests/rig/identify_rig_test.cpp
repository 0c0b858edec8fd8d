// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "app/error.hpp"
#include "app/rig/identify.hpp"
#include "app/rig/record.hpp"
#include "simulated_rig.hpp"
#include "tests/shared_data.hpp"

namespace dampline::test {
namespace {

using app::Column;
using app::Config;
using app::RunResult;
using testing::HasSubstr;

/// A CSV file that goes away with the test.
class IdentifyRig : public testing::Test {
 protected:
  IdentifyRig() {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    file_ =
        std::filesystem::path{testing::TempDir()} / (std::string{"rig_"} + test->name() + ".csv");
  }
  ~IdentifyRig() override {
    std::error_code ignored;
    std::filesystem::remove(file_, ignored);
  }

  /// A damper, 500 N sign v + 2000 v, at 1 kHz; `change` may spoil a row.
  template <class Change>
  void write(std::size_t rows, Change change, const char* header = "time_s,deflection_m,force_n") {
    std::ofstream out{file_};
    out.precision(12);
    out << header << '\n';
    for (std::size_t i = 0; i < rows; ++i) {
      const double t = static_cast<double>(i) / 1000.0;
      const double v = 0.02 * 9.0 * std::cos(9.0 * t) + 0.01 * 17.0 * std::cos(17.0 * t);
      app::rig::Line line{i + 2, t, 0.02 * std::sin(9.0 * t) + 0.01 * std::sin(17.0 * t), 0.0,
                          std::copysign(500.0, v) + 2000.0 * v};
      if (change(i, line))
        out << line.time_s << ',' << line.deflection_m << ',' << line.force_n << '\n';
    }
  }
  void write(std::size_t rows) {
    write(rows, [](std::size_t, app::rig::Line&) { return true; });
  }

  [[nodiscard]] RunResult identify() const {
    return app::rig::identify(app::rig::csv_record(file_.string(), config_.input, false), config_);
  }
  [[nodiscard]] std::string error() const {
    try {
      (void)identify();
    } catch (const app::RunError& e) {
      return e.what();
    }
    return "no error";
  }

  std::filesystem::path file_;
  Config config_;
};

const app::Parameter& find(const RunResult& result, const std::string& name) {
  for (const auto& parameter : result.parameters)
    if (parameter.name == name) return parameter;
  ADD_FAILURE() << name << " is missing";
  static const app::Parameter none;
  return none;
}

std::uint64_t count(const RunResult& result, const std::string& name) {
  for (const auto& [key, value] : result.counts)
    if (key == name) return value;
  ADD_FAILURE() << name << " is missing";
  return 0;
}

TEST_F(IdentifyRig, WorksByTheHeaderAlone) {
  config_.model.base = {"coulomb", "viscous"};
  write(20000);
  const RunResult result = identify();
  EXPECT_EQ(result.kind, "rig");
  EXPECT_NEAR(find(result, "coulomb").value, 500.0, 5.0);
  EXPECT_EQ(find(result, "coulomb").unit, "N");
  EXPECT_NEAR(find(result, "viscous").value, 2000.0, 20.0);
  EXPECT_EQ(result.curve.size(), 18U);
  EXPECT_LT(*result.fit.rrse, 0.05);
  EXPECT_NEAR(result.duration_s, 20.0, 0.01);
  EXPECT_GT(result.convergence.rows.size(), 30U);
  EXPECT_FALSE(result.motion.empty());
  EXPECT_EQ(result.motion.size(), result.force.size());
  EXPECT_EQ(count(result, "samples"), 20000U);
}

TEST_F(IdentifyRig, MapsColumnsAndScales) {
  config_.model.base = {"coulomb", "viscous"};
  config_.input.columns[index(Column::kDeflection)] = "qm";
  config_.input.columns[index(Column::kForce)] = "volts";
  config_.input.scale[index(Column::kForce)] = 3.0;
  config_.input.scale[index(Column::kDeflection)] = 0.5;
  write(
      20000, [](std::size_t, app::rig::Line&) { return true; }, "time_s,qm,volts");
  const RunResult result = identify();
  EXPECT_NEAR(find(result, "coulomb").value, 1500.0, 15.0);
  EXPECT_NEAR(find(result, "viscous").value, 12000.0, 120.0);
}

TEST_F(IdentifyRig, ReportsBothLevelsWhereTheDirectionsDiffer) {
  config_.model.base = {"coulomb", "viscous"};
  write(20000, [](std::size_t, app::rig::Line& line) {
    line.force_n += 120.0;
    return true;
  });
  const RunResult result = identify();
  EXPECT_NEAR(find(result, "coulomb_positive").value, 620.0, 8.0);
  EXPECT_NEAR(find(result, "coulomb_negative").value, 380.0, 8.0);
}

TEST_F(IdentifyRig, SaysThatAModelIsPoorAndThatASpringWouldHelp) {
  write(20000, [](std::size_t, app::rig::Line& line) {
    line.force_n += 4e4 * line.deflection_m;
    return true;
  });
  const RunResult result = identify();
  EXPECT_GT(*result.fit.rrse, 0.3);
  EXPECT_EQ(result.trust, app::Trust::kModelIncomplete);
  EXPECT_THAT(result.headline, HasSubstr("does not fit"));
  EXPECT_THAT(result.notes, testing::Contains(HasSubstr("linear spring of")));
  config_.model.stiffness = "identify";
  config_.model.base = {"coulomb", "viscous"};
  EXPECT_NEAR(find(identify(), "stiffness").value, 4e4, 200.0);
}

TEST_F(IdentifyRig, ExcludesAndListsGapsAndValuesThatAreNoNumber) {
  config_.model.base = {"coulomb", "viscous"};
  write(20000, [](std::size_t i, app::rig::Line& line) {
    if (i == 9000) line.force_n = std::numeric_limits<double>::quiet_NaN();
    return i < 5000 || i >= 5500;
  });
  const RunResult result = identify();
  EXPECT_EQ(count(result, "gaps"), 1U);
  EXPECT_EQ(count(result, "lost"), 500U);
  EXPECT_EQ(count(result, "not_finite"), 1U);
  ASSERT_EQ(result.excluded.size(), 2U);
  EXPECT_NEAR(result.excluded[0].start_s, 5.0, 0.002);
  EXPECT_NEAR(result.excluded[0].end_s, 5.5, 0.002);
  EXPECT_NEAR(find(result, "coulomb").value, 500.0, 5.0);
}

TEST_F(IdentifyRig, NamesAMissingColumnAndThoseThatAreThere) {
  write(
      500, [](std::size_t, app::rig::Line&) { return true; }, "time_s,x,force_n");
  EXPECT_THAT(error(), testing::AllOf(HasSubstr("deflection_m"), HasSubstr("force_n")));
}

TEST_F(IdentifyRig, RefusesARecordWithTooFewRows) {
  write(60);
  EXPECT_THAT(error(), HasSubstr("expected at least 100"));
}

TEST_F(IdentifyRig, RefusesARecordThatIsTooShortForItsModel) {
  write(110);
  EXPECT_THAT(error(), HasSubstr("too few to determine the model"));
}

TEST_F(IdentifyRig, ResamplesTimeThatIsNotUniform) {
  write(5000, [](std::size_t i, app::rig::Line& line) {
    if (i > 2000 && i % 3 == 0) line.time_s += 0.0004;
    return true;
  });
  EXPECT_EQ(error(), "no error");
}

TEST_F(IdentifyRig, RefusesTimeThatRunsBackwards) {
  write(5000, [](std::size_t i, app::rig::Line& line) {
    if (i == 3000) line.time_s = 1.0;
    return true;
  });
  EXPECT_THAT(error(), HasSubstr(":3002"));
}

TEST_F(IdentifyRig, RefusesARecordWithoutMotion) {
  write(5000, [](std::size_t, app::rig::Line& line) {
    line.deflection_m = 0.25;
    return true;
  });
  EXPECT_THAT(error(), HasSubstr("found no motion"));
}

TEST_F(IdentifyRig, RefusesStandardInputBecauseItReadsTheRecordAgain) {
  EXPECT_THROW((void)app::rig::csv_record("-", {}, false), app::RunError);
}

TEST_F(IdentifyRig, RefusesAModelThatARigCannotHave) {
  write(5000);
  config_.model.base = {"time_skew"};
  EXPECT_THROW((void)identify(), app::UsageError);
  config_.model.base = {"asymmetric_coulomb", "offset_force"};
  EXPECT_THROW((void)identify(), app::UsageError);
  config_.model.base = {"coulomb", "asymmetric_coulomb"};
  EXPECT_THROW((void)identify(), app::UsageError);
  config_.model.base = {};
  EXPECT_THROW((void)identify(), app::UsageError);
}

TEST_F(IdentifyRig, RefusesACornerThatDoesNotFitTheRate) {
  write(5000);
  config_.model.rig_corner_hz = 300.0;
  EXPECT_THAT(error(), HasSubstr("rig_corner_hz"));
}

/// A shipped configuration on the record that it was written for.
RunResult shipped(const std::string& example, const std::string& record) {
  const std::filesystem::path file = test::shared_data(record);
  if (!std::filesystem::exists(file)) return {};
  const Config config = app::load_config(DAMPLINE_SOURCE_DIR "/app/examples/" + example);
  return app::rig::identify(app::rig::csv_record(file.string(), config.input, false), config);
}

TEST(ShippedExamples, EmpsGivesThePublishedParameters) {
  const RunResult result = shipped("emps.toml", "emps/emps_train.csv");
  if (result.kind.empty()) GTEST_SKIP() << "no emps/emps_train.csv in the shared data";
  EXPECT_NEAR(find(result, "moving_mass").value / 95.1089, 1.0, 0.015);
  EXPECT_NEAR(find(result, "viscous").value / 203.5034, 1.0, 0.015);
  EXPECT_NEAR(find(result, "coulomb").value / 20.3935, 1.0, 0.015);
  EXPECT_NEAR(find(result, "offset").value / -3.1648, 1.0, 0.05);
}

TEST(ShippedExamples, FrictionDamperIsSaidToBePoorlyExplained) {
  const RunResult result = shipped("friction_damper.toml", "friction_damper/harm_1Hz_1in.csv");
  if (result.kind.empty()) GTEST_SKIP() << "no friction_damper record in the shared data";
  EXPECT_GT(*result.fit.rrse, 0.60);
  EXPECT_LT(*result.fit.rrse, 0.66);
  EXPECT_EQ(result.trust, app::Trust::kModelIncomplete);
  EXPECT_THAT(result.trust_reasons, testing::Contains(HasSubstr("`dampline explain`")));
  for (const char* name : {"coulomb_positive", "coulomb_negative", "viscous_positive"})
    EXPECT_EQ(find(result, name).name, name);
}

}  // namespace
}  // namespace dampline::test
