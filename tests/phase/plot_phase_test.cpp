// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "app/report/phase_plot.hpp"

namespace dampline::app {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::unique_ptr<PhaseSnapshot> circle(const PhaseViewConfig& config = {}) {
  auto view = std::make_unique<PhaseView>(PhaseView::check(config).value());
  const double w = 2.0 * std::numbers::pi / 0.371;
  for (int i = 0; i < 60000; ++i) {
    const double angle = w * i / 300.0;
    view->update({.tick = i,
                  .deflection_m = 1e-3 * std::sin(angle),
                  .velocity_mps = 1e-3 * w * std::cos(angle),
                  .relative_mps2 = -1e-3 * w * w * std::sin(angle)});
  }
  auto out = std::make_unique<PhaseSnapshot>();
  view->snapshot(*out);
  return out;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

std::string drawn(const PhaseSnapshot& snapshot) {
  return figure(plot_phase(snapshot), "phase", "");
}

TEST(PlotPhase, DrawsThreePlanesWithUnitsAndSectionPoints) {
  const auto snapshot = circle();
  const std::string svg = drawn(*snapshot);
  EXPECT_EQ(count(svg, "<svg"), 3U);
  EXPECT_EQ(count(svg, "</svg>"), 3U);
  EXPECT_THAT(svg, HasSubstr("y (mm)"));
  EXPECT_THAT(svg, HasSubstr("v (mm/s)"));
  EXPECT_THAT(svg, HasSubstr("m/s\u00b2"));
  EXPECT_EQ(count(svg, "h0M") + count(svg, "h0\""), 3 * kSectionPhases * kSectionPoints);
  EXPECT_EQ(count(svg, "<g"), count(svg, "</g>"));
  EXPECT_EQ(count(svg, "<text"), count(svg, "</text>"));
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(describe_period(*snapshot), HasSubstr("0.371 s"));
}

/// Left edges of the cells of the first panel, between which the circle must span the panel.
TEST(PlotPhase, FillsThePanelWithTheMotion) {
  const std::string svg = drawn(*circle());
  EXPECT_THAT(svg, HasSubstr(">1</text>"));  // mm
  EXPECT_THAT(svg, HasSubstr(">-1</text>"));
  EXPECT_THAT(svg, HasSubstr(">10</text>"));  // mm/s, of 16.9
  EXPECT_THAT(svg, Not(HasSubstr(">40</text>")));
}

TEST(PlotPhase, SaysWhyThereIsNoPicture) {
  const auto view = std::make_unique<PhaseView>(PhaseViewConfig{});
  const auto empty = std::make_unique<PhaseSnapshot>();
  view->snapshot(*empty);
  const std::string svg = drawn(*empty);
  EXPECT_EQ(count(svg, ">no motion in the record</text>"), 3U);
  EXPECT_EQ(count(svg, "h0M"), 0U);
  EXPECT_THAT(describe_period(*empty), HasSubstr("too short"));
}

TEST(PlotPhase, SaysHowMuchARangeClips) {
  const auto clipped = circle({.deflection_low_m = -9.5e-4, .deflection_high_m = 9.5e-4});
  const std::string svg = drawn(*clipped);
  EXPECT_EQ(count(svg, " % of the samples outside</text>"), 2U);  // both planes with y
  EXPECT_NE(
      svg.find(fmt::format("{:.1f} %", 100.0 * clipped->velocity_over_deflection.outside_share)),
      std::string::npos);
}

}  // namespace
}  // namespace dampline::app
