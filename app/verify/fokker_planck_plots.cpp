// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "app/verify/fokker_planck_cases.hpp"

namespace dampline::app {
namespace {

constexpr double kKilonewton = 1e-3;
constexpr double kMillimetre = 1e3;

/// Ends of the published intervals of a side, magnitudes in m/s. One that passes its follower's is
/// a misprint ("-0.029" for -0.0029): the follower's beginning stands for it.
std::vector<double> printed_ends_mps(const std::vector<PaperLine>& lines) {
  std::vector<double> out;
  const auto printed = [&](std::size_t i, std::size_t column) {
    return std::abs(Printed{lines[i].published->figures.at(column)}.value);
  };
  for (std::size_t i = 0; i < kPaperSegments; ++i) {
    const double end = printed(i, 1);
    const bool follows = i + 1 < kPaperSegments;
    out.push_back(follows && end > printed(i + 1, 1) ? printed(i + 1, 0) : end);
  }
  return out;
}

/// From v = 0 outwards; the jump's line is the first point.
std::vector<svg::Point> published_points(const std::vector<PaperLine>& lines, double sign) {
  const std::vector<double> ends_mps = printed_ends_mps(lines);
  const auto force_kn = [&](std::size_t i) {
    return Printed{lines[i].published->figures[3]}.value;
  };
  std::vector<svg::Point> out{{0.0, force_kn(kPaperSegments)}};
  for (std::size_t i = 0; i < kPaperSegments; ++i)
    out.push_back({sign * kMillimetre * ends_mps[i], force_kn(i)});
  return out;
}

/// Ours, `deviations` standard deviations of a run off its mean.
std::vector<svg::Point> our_points(const std::vector<PaperLine>& lines, double deviations) {
  const auto force_kn = [&](const PaperLine& line) {
    return kKilonewton * (line.force_n.mean + deviations * line.force_n.std);
  };
  std::vector<svg::Point> out{{0.0, force_kn(lines[kPaperSegments])}};
  for (std::size_t i = 0; i < kPaperSegments; ++i)
    out.push_back({kMillimetre * lines[i].to_mps, force_kn(lines[i])});
  return out;
}

}  // namespace

Plot plot_table(const PaperTable& table) {
  constexpr double kDot = 3.0;
  constexpr double kTwice = 2.0;
  constexpr double kRoom = 1.05;  // beyond the last point
  double reach_mmps = 0.0;
  for (const auto& lines : table.lines)
    reach_mmps = kMillimetre * std::max({reach_mmps / kMillimetre, printed_ends_mps(lines).back(),
                                         std::abs(lines[kPaperSegments - 1].to_mps)});
  svg::Panel panel{
      {"v (mm/s)", -kRoom * reach_mmps, kRoom * reach_mmps}, {"damping force (kN)"}, 320.0};
  panel.title(table.caption);
  for (const std::size_t side : {std::size_t{1}, std::size_t{0}}) {
    const auto& lines = table.lines[side];
    const bool named = side == 1;
    const double sign = named ? 1.0 : -1.0;
    const double level_kn = sign * kKilonewton * table.simulated_n[side];
    const double end_mmps = kMillimetre * lines[kPaperSegments - 1].to_mps;
    panel.band(our_points(lines, -kTwice), our_points(lines, kTwice), svg::Ink::kBlue,
               named ? "two deviations of a run" : "");
    panel.line({{0.0, level_kn}, {end_mmps, level_kn}}, {svg::Ink::kGrey, 1.5, true},
               named ? "simulated" : "");
    panel.line(our_points(lines, 0.0), {svg::Ink::kBlue}, named ? "found, mean of 9" : "");
    panel.dots(published_points(lines, sign), svg::Ink::kOrange, kDot, named ? "published" : "");
  }
  return {{panel}, false};
}

}  // namespace dampline::app
