// SPDX-License-Identifier: MIT
// phase.json: planes, period and sections of a run.
#include <fmt/format.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "app/error.hpp"
#include "app/run/json.hpp"

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<const char*, 4> kPictureStates{"empty", "constant", "clipped", "good"};
constexpr std::array<const char*, 4> kPeriodStates{"not_enough", "no_motion", "none", "found"};

struct Plane {
  const char* x;
  const char* y;
  PhasePicture PhaseSnapshot::*picture;
};
constexpr std::array<Plane, 3> kPlanes{
    Plane{"deflection_m", "velocity_mps", &PhaseSnapshot::velocity_over_deflection},
    Plane{"deflection_m", "accel_mps2", &PhaseSnapshot::accel_over_deflection},
    Plane{"velocity_mps", "accel_mps2", &PhaseSnapshot::accel_over_velocity}};

/// The state that is written as `word`.
template <class State, std::size_t N>
State state_of(const std::array<const char*, N>& words, const std::string& word) {
  for (std::size_t i = 0; i < N; ++i)
    if (word == words[i]) return static_cast<State>(i);
  throw RunError{fmt::format("no such state: {}", word)};
}

double five_digits(float value) { return std::stod(fmt::format("{:.5g}", value)); }

Json cells_of(const PhasePicture& picture) {
  Json cells = Json::array();
  for (std::size_t i = 0; i < kPictureCells; ++i) {
    for (std::size_t j = 0; j < kPictureCells; ++j) {
      const float density = picture.density[i][j];
      if (density > 0.0F) cells.push_back({i, j, five_digits(density)});
    }
  }
  return cells;
}

Json plane_of(const Plane& plane, const PhaseSnapshot& phase) {
  const PhasePicture& picture = phase.*plane.picture;
  return {{"x", plane.x},
          {"y", plane.y},
          {"state", kPictureStates[static_cast<std::size_t>(picture.state)]},
          {"x_range", {picture.x_low, picture.x_high}},
          {"y_range", {picture.y_low, picture.y_high}},
          {"cells_per_axis", kPictureCells},
          {"samples", picture.samples},
          {"outside_share", picture.outside_share},
          {"density", cells_of(picture)}};
}

void read_plane(const Json& json, PhasePicture& picture) {
  picture.state = state_of<PictureState>(kPictureStates, json.at("state"));
  picture.x_low = json.at("x_range").at(0);
  picture.x_high = json.at("x_range").at(1);
  picture.y_low = json.at("y_range").at(0);
  picture.y_high = json.at("y_range").at(1);
  picture.samples = json.at("samples");
  picture.outside_share = json.at("outside_share");
  for (const Json& cell : json.at("density"))
    picture.density.at(cell.at(0)).at(cell.at(1)) = cell.at(2);
}

Json sections_of(const PhaseSnapshot& phase) {
  Json sections = Json::array();
  for (std::size_t p = 0; p < kSectionPhases; ++p) {
    Json points = Json::array();
    for (std::size_t i = 0; i < phase.section_count[p]; ++i) {
      const PhasePoint& point = phase.section[p][i];
      points.push_back({point.deflection_m, point.velocity_mps, point.accel_mps2});
    }
    sections.push_back(std::move(points));
  }
  return sections;
}

void read_sections(const Json& json, PhaseSnapshot& phase) {
  for (std::size_t p = 0; p < json.size(); ++p) {
    for (const Json& point : json.at(p)) {
      phase.section.at(p).at(phase.section_count.at(p)) = {point.at(0), point.at(1), point.at(2)};
      ++phase.section_count.at(p);
    }
  }
}

Json period_of(const PhaseSnapshot& phase) {
  const Period& p = phase.period;
  return {{"state", kPeriodStates[static_cast<std::size_t>(p.state)]},
          {"given", phase.period_is_known},
          {"value", p.period_s},
          {"std", p.period_std_s},
          {"unit", "s"},
          {"height", p.height},
          {"persistence", p.persistence},
          {"confidence", p.confidence}};
}

void read_period(const Json& json, PhaseSnapshot& phase) {
  phase.period_is_known = json.at("given");
  phase.period = {state_of<PeriodState>(kPeriodStates, json.at("state")),
                  json.at("value"),
                  json.at("std"),
                  json.at("height"),
                  json.at("persistence"),
                  json.at("confidence")};
}

}  // namespace

std::string to_json(const PhaseSnapshot& phase) {
  Json planes = Json::array();
  for (const Plane& plane : kPlanes) planes.push_back(plane_of(plane, phase));
  const Json json{{"planes", planes},
                  {"period", period_of(phase)},
                  {"section_columns", {"deflection_m", "velocity_mps", "accel_mps2"}},
                  {"sections", sections_of(phase)},
                  {"still", phase.still},
                  {"not_finite", phase.not_finite}};
  return json.dump() + "\n";
}

std::shared_ptr<const PhaseSnapshot> read_phase(std::string_view text, const std::string& origin) {
  try {
    const Json json = Json::parse(text);
    auto phase = std::make_shared<PhaseSnapshot>();
    for (std::size_t i = 0; i < kPlanes.size(); ++i)
      read_plane(json.at("planes").at(i), (*phase).*kPlanes[i].picture);
    read_period(json.at("period"), *phase);
    read_sections(json.at("sections"), *phase);
    phase->still = json.at("still");
    phase->not_finite = json.at("not_finite");
    return phase;
  } catch (const std::exception& error) {
    throw RunError{fmt::format("{}: not the phase planes of a run: {}", origin, error.what())};
  }
}

}  // namespace dampline::app
