// SPDX-License-Identifier: MIT
// The figures of Kisilowski and Urbanski (1987) as `verify fokker-planck` prints them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

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
// the level without the region around zero is the simulated one.
TEST(FokkerPlanckFigures, TablesHoldTogether) {
  const FokkerPlanckCases& cases = all_cases();
  EXPECT_EQ(cases.tables[0].half_mass_kg, 18600.0);
  EXPECT_EQ(cases.tables[1].half_mass_kg, 4850.0);
  const std::array<double, 2> levels_n{8356.0, 2937.0};
  for (std::size_t t = 0; t < 2; ++t) {
    const PaperTable& table = cases.tables[t];
    ASSERT_TRUE(table.excluded.ok);
    EXPECT_NEAR(table.half_mass_kg * table.excluded.level_mps2() / levels_n[t], 1.0, 0.05);
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

TEST(FokkerPlanckFigures, RefuseATableThatIsNotThere) {
  EXPECT_ANY_THROW(static_cast<void>(verify_fokker_planck({.quiet = true, .tables = {"3"}})));
}

}  // namespace
}  // namespace dampline::app
