// SPDX-License-Identifier: MIT
// The figures of the phase mappings that need few runs, with bounds written out here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/verify/phase/pictures.hpp"
#include "app/verify/phase/rows.hpp"
#include "app/verify/phase/studies.hpp"

namespace dampline::app {
namespace {

const PhaseRow& row_of(const std::vector<PhaseRow>& rows, const std::string& what) {
  const auto at =
      std::find_if(rows.begin(), rows.end(), [&](const PhaseRow& row) { return row.what == what; });
  if (at == rows.end()) throw std::runtime_error{"no row " + what};
  return *at;
}

TEST(PhaseFigures, ResonancesAreFoundOrExplained) {
  const std::vector<PhaseRow> rows = resonance_rows();
  EXPECT_NEAR(*row_of(rows, "viscous damping, c = 1").found, std::sqrt(0.5), 1e-4);
  for (const PhaseRow& row : rows) {
    EXPECT_TRUE(row.found || row.remark.rfind("none: ", 0) == 0) << row.what;
    EXPECT_EQ(row.found.has_value(), row.deviation.has_value()) << row.what;
  }
  // A swing that never exceeds the friction moves nothing.
  for (const char* what : {"Coulomb friction, P1 = 0.5", "Coulomb friction, P1 = 1"})
    EXPECT_FALSE(row_of(rows, what).found) << what;
  EXPECT_NEAR(*row_of(rows, "Coulomb friction, P1 = 1.005").found, 0.12, 0.01);
  EXPECT_NEAR(*row_of(rows, "structural friction, magnitude |1 + y / y_c|, P1 = 1.005").found, 0.16,
              0.02);
}

TEST(PhaseFigures, FrictionIsFoundFromNoisySections) {
  for (const std::uint64_t seed : {71U, 72U}) {
    const FrictionStudy slight = study_friction(0.01, seed);
    EXPECT_LT(slight.friction_error, 0.015);
    EXPECT_NEAR(slight.law.friction_mps2.value, 1.0, 0.005);
    EXPECT_NEAR(slight.law.reversal_m.value, kStudyReversalM, 0.02 * kStudyReversalM);
    EXPECT_LT(study_friction(0.05, seed).friction_error, 0.035);
  }
}

// At the publication's own inputs the mass sticks, unless it is started elsewhere.
TEST(PhaseFigures, OwnInputsAreTriedAndSticking) {
  const PublishedInputs inputs{{0.5, 1.0, 2.0}, {0.1}, {-0.1, 0.1}};
  const FrictionStudy rest = study_published_inputs(inputs, 0.0, 0.0, 91);
  EXPECT_EQ(rest.points, 0U);
  EXPECT_EQ(rest.stuck_share(), 1.0);
  EXPECT_EQ(rest.nodes, 0);
  const FrictionStudy started = study_published_inputs(inputs, 3.0, 0.0, 91);
  EXPECT_GT(started.nodes, 5);
  EXPECT_LT(started.friction_error, 0.03);
}

// Only the linear system's section is a plane; each has its three planes and the view along the
// fourth.
TEST(PhaseFigures, PicturesShowThePlaneOfTheLinearSystem) {
  const std::vector<PhasePictures> all = phase_pictures();
  ASSERT_EQ(all.size(), 4U);
  EXPECT_LT(all[0].off_plane, 1e-9) << all[0].name;
  for (std::size_t i = 1; i < all.size(); ++i) EXPECT_GT(all[i].off_plane, 0.05) << all[i].name;
  for (const PhasePictures& one : all) {
    EXPECT_EQ(one.plot.panels.size(), 4U) << one.name;
    EXPECT_GE(one.points, 10U) << one.name;
    const std::string drawn = one.plot.panels[2].draw("plane", "plane");
    EXPECT_NE(drawn.find("y'' (m/s²) over y' (m/s)"), std::string::npos);
  }
}

// A curve per value of the publication's inputs, each the law away from its kink at -0.5.
TEST(PhaseFigures, CurvesOfEveryFamilyAreTheLaw) {
  const std::vector<FrictionFamily> families = friction_families();
  ASSERT_EQ(families.size(), 3U);
  EXPECT_EQ(plot_families(families).panels.size(), 6U);
  for (const FrictionFamily& family : families) {
    ASSERT_EQ(family.curves.size(), 3U) << family.name;
    for (const FrictionFamily::Curve& curve : family.curves) {
      int compared = 0;
      for (const FrictionNode& node : curve.started.curve.nodes) {
        if (!node.resolved || std::abs(node.deflection_m + kStudyReversalM) < 0.5) continue;
        EXPECT_NEAR(node.friction_mps2.value, std::abs(1.0 + 2.0 * node.deflection_m), 0.02)
            << family.name << " = " << curve.value << ", y = " << node.deflection_m;
        ++compared;
      }
      EXPECT_GT(compared, 5) << family.name << " = " << curve.value;
    }
  }
}

TEST(PhaseFigures, SystemsAreDeclaredWhatTheyAre) {
  for (const std::uint64_t seed : {81U, 82U, 83U}) {
    EXPECT_EQ(study_planarity({.viscous_per_s = 0.3}, 0.01, seed).state, PlanarityState::kLinear);
    for (const sim::OscillatorLaw& law :
         {sim::OscillatorLaw{.viscous_per_s = 0.3, .friction_mps2 = 0.2},
          sim::OscillatorLaw{.friction_mps2 = 1.0, .reversal_m = kStudyReversalM},
          sim::OscillatorLaw{.viscous_per_s = 0.3, .cubic_per_m2s2 = 0.1}})
      EXPECT_EQ(study_planarity(law, 0.01, seed).state, PlanarityState::kNonlinear);
  }
}

}  // namespace
}  // namespace dampline::app
