// SPDX-License-Identifier: MIT
// Names of columns: one style in every table of a run.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "app/run/tables.hpp"
#include "tests/app/program.hpp"

namespace dampline::app {
namespace {

using testing::StartsWith;

Convergence one(const std::string& name, const std::string& unit) {
  return {{name}, {unit}, {{1.5, {{2.0, 0.25}}}}};
}

TEST(ColumnNames, EndInTheUnit) {
  EXPECT_THAT(to_csv(one("coulomb", "N")),
              StartsWith("time_s,coulomb_n,coulomb_std_n\n1.5,2,0.25\n"));
  EXPECT_THAT(to_csv(one("viscous", "N s/m")),
              StartsWith("time_s,viscous_nspm,viscous_std_nspm\n"));
  EXPECT_THAT(to_csv(one("stribeck_share", "")),
              StartsWith("time_s,stribeck_share,stribeck_share_std\n"));
  EXPECT_THAT(to_csv(one("coulomb_per_mass", "m/s^2")),
              StartsWith("time_s,coulomb_per_mass_mps2,coulomb_per_mass_std_mps2\n"));
}

TEST(ColumnNames, GiveTheUnitBack) {
  for (const char* unit :
       {"", "N", "N/m", "N s/m", "m/s", "kg", "m", "s", "Hz", "N/m^3", "N s^2/m^2", "N s^9/m^18",
        "1/s", "1/s^2", "m/s^2", "1/m s", "1/m^8 s^2", "s^7/m^8", "%"}) {
    const Convergence read = read_convergence(to_csv(one("a_std_of_it", unit)), "convergence.csv");
    EXPECT_EQ(read.units.at(0), unit);
    EXPECT_EQ(read.names.at(0), "a_std_of_it");
  }
}

/// Lower case, digits and underscores.
TEST(ColumnNames, AreOfOneStyleInEveryTable) {
  const Program program;
  ASSERT_EQ(program.run("simulate --duration 60 --quiet --out run.log --effect backlash").code, 0);
  ASSERT_EQ(program.run("identify run.log --methods all --no-report --quiet --out i").code, 0);
  ASSERT_EQ(program.run("explain run.log --no-report --quiet --out e").code, 0);
  const std::regex style{"[a-z][a-z0-9_]*(,[a-z][a-z0-9_]*)*"};
  int tables = 0;
  for (const char* run : {"i", "e"})
    for (const auto& entry : std::filesystem::directory_iterator{program.path(run)}) {
      if (entry.path().extension() != ".csv") continue;
      std::ifstream stream{entry.path()};
      std::string header;
      std::getline(stream, header);
      EXPECT_TRUE(std::regex_match(header, style)) << entry.path() << ": " << header;
      ++tables;
    }
  EXPECT_GE(tables, 10);
}

}  // namespace
}  // namespace dampline::app
