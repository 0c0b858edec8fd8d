// SPDX-License-Identifier: MIT
// The figures of Kisilowski and Urbanski (1987) as `verify fokker-planck` prints them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "app/verify/fokker_planck_cases.hpp"
#include "app/verify/subjects.hpp"

namespace dampline::app {
namespace {

const FokkerPlanckCases& all_cases() {
  static const FokkerPlanckCases cases = fokker_planck_cases();
  return cases;
}

TEST(FokkerPlanckFigures, AreMetOrHaveAReason) {
  const FokkerPlanckCases& cases = all_cases();
  int promised = 0;
  for (const FokkerPlanckFigure& figure : cases.figures) {
    promised += figure.promised ? 1 : 0;
    EXPECT_TRUE(figure.met) << figure.quantity << ": " << figure.computed;
    EXPECT_FALSE(figure.remark.empty()) << figure.quantity;
    EXPECT_FALSE(figure.computed.empty()) << figure.quantity;
  }
  EXPECT_GE(promised, 3);
}

// A force's slope over a segment leads from its one end to its other, on both sides of zero, and
// the level without the region around zero is the simulated one: the table's own.
TEST(FokkerPlanckFigures, TablesHoldTogether) {
  const FokkerPlanckCases& cases = all_cases();
  EXPECT_EQ(cases.tables[0].half_mass_kg, 18600.0);
  EXPECT_EQ(cases.tables[1].half_mass_kg, 4850.0);
  const std::array<double, 2> levels_n{5632.54, 1710.03};
  for (std::size_t t = 0; t < 2; ++t) {
    const PaperTable& table = cases.tables[t];
    ASSERT_TRUE(table.excluded.ok);
    EXPECT_NEAR(0.5 * (table.simulated_n[0] + table.simulated_n[1]), levels_n[t], 1e-6);
    EXPECT_NEAR(table.half_mass_kg * table.excluded.level_mps2() / levels_n[t], 1.0, 0.08);
    for (std::size_t side = 0; side < 2; ++side) {
      double alpha = table.excluded.offset_mps2[side];
      double from_mps = 0.0;
      ASSERT_EQ(table.excluded.used, 10U);  // k = 20 in all, page 386
      ASSERT_EQ(table.lines[side].size(), 11U);
      for (std::size_t i = 0; i < table.excluded.used; ++i) {
        const PaperSegment& s = table.excluded.segments[side][i];
        EXPECT_EQ(s.from_mps, from_mps);
        from_mps = s.to_mps;
        alpha += s.slope_ps * (s.to_mps - s.from_mps);
        EXPECT_NEAR(std::abs(s.alpha_mps2), std::abs(alpha), 1e-9 * std::abs(alpha) + 1e-12)
            << "segment to " << s.to_mps;
      }
    }
  }
}

// Nine runs know the force before its curve widens: within 8 % of what the table prints.
TEST(FokkerPlanckFigures, ForcesOfTheTablesAreFound) {
  for (const PaperTable& table : all_cases().tables) {
    for (const std::vector<PaperLine>& lines : table.lines) {
      for (const std::size_t line : {std::size_t{0}, std::size_t{3}, kPaperSegments}) {
        const double published_n = 1e3 * Printed{lines[line].published->figures[3]}.value;
        EXPECT_NEAR(lines[line].force_n.mean / published_n, 1.0, 0.08) << table.name << line;
      }
    }
  }
}

// Every published end is on the drawing where the table has it, misprints where they belong.
TEST(FokkerPlanckFigures, AreDrawnOverThePublishedPoints) {
  const PaperTable& table = all_cases().tables[1];
  const Plot plot = plot_table(table);
  ASSERT_EQ(plot.panels.size(), 1U);
  const std::string drawn = plot.panels[0].draw("table", "forces");
  EXPECT_NE(drawn.find("published"), std::string::npos);
  EXPECT_NE(drawn.find("damping force (kN)"), std::string::npos);
  std::size_t dots = 0;
  for (std::size_t at = drawn.find("h0"); at != std::string::npos; at = drawn.find("h0", at + 1))
    ++dots;
  EXPECT_EQ(dots, 22U);  // the jump and ten ends on each side
  EXPECT_NE(drawn.find("v (mm/s) from -32.55 to 32.55"), std::string::npos);  // 31 and some room
}

TEST(FokkerPlanckFigures, RefuseATableThatIsNotThere) {
  EXPECT_ANY_THROW(static_cast<void>(verify_fokker_planck({.quiet = true, .tables = {"3"}})));
}

}  // namespace
}  // namespace dampline::app
