// SPDX-License-Identifier: MIT
#include "app/serve/view.hpp"

#include <fmt/format.h>
#include <nettle/base64.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/identify/truck_run.hpp"
#include "app/record/rate.hpp"
#include "dampline/identifier.hpp"

namespace dampline::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kShownHz = 75.0;
constexpr std::int64_t kHistoryMs = 2000;  // between two rows at first

/// Five digits: no plot shows more.
double rounded(double value) {
  if (!std::isfinite(value) || value == 0.0) return value;
  constexpr double kDigits = 1e4;
  const double scale = std::pow(10.0, std::floor(std::log10(std::fabs(value)))) / kDigits;
  return std::round(value / scale) * scale;
}

template <class Row>
Json column(const std::vector<Row>& rows, double Row::*member) {
  Json out = Json::array();
  for (const Row& row : rows) out.push_back(rounded(row.*member));
  return out;
}

Json curve_of(const std::vector<CurveRow>& rows) {
  Json samples = Json::array();
  for (const CurveRow& row : rows) samples.push_back(row.samples);
  return {{"velocity_mps", column(rows, &CurveRow::velocity_mps)},
          {"force_n", column(rows, &CurveRow::force_n)},
          {"std_n", column(rows, &CurveRow::std_n)},
          {"samples", std::move(samples)}};
}

Json history_of(const std::vector<ConvergenceHistory::Row>& rows) {
  constexpr double kMsPerS = 1000.0;
  Json out{{"time_s", Json::array()},
           {"coulomb_n", Json::array()},
           {"coulomb_std_n", Json::array()},
           {"stiffness_npm", Json::array()},
           {"stiffness_std_npm", Json::array()}};
  for (const ConvergenceHistory::Row& row : rows) {
    out["time_s"].push_back(static_cast<double>(row.tick) / kMsPerS);
    out["coulomb_n"].push_back(rounded(row.coulomb_n.value));
    out["coulomb_std_n"].push_back(rounded(row.coulomb_n.std));
    out["stiffness_npm"].push_back(rounded(row.stiffness_npm.value));
    out["stiffness_std_npm"].push_back(rounded(row.stiffness_npm.std));
  }
  return out;
}

/// Without the empty bins at both ends.
Json density_of(const DensityTable& table) {
  const auto holds = [](const DensityRow& row) { return row.density > 0.0; };
  const auto first = std::find_if(table.rows.begin(), table.rows.end(), holds);
  const auto last = std::find_if(table.rows.rbegin(), table.rows.rend(), holds).base();
  std::vector<DensityRow> rows;
  if (first < last) rows.assign(first, last);
  return {{"quantity", table.quantity},
          {"place", column(rows, &DensityRow::centre)},
          {"density", column(rows, &DensityRow::density)}};
}

/// One byte a cell, i along x outermost; 255 is the densest, and a cell of a hundredth of it has
/// still a tenth of the shade.
std::string shades_of(const PhasePicture& picture) {
  constexpr double kMostShade = 255.0;
  float most = 0.0F;
  for (const auto& along : picture.density)
    most = std::max(most, *std::max_element(along.begin(), along.end()));
  std::string bytes;
  for (const auto& along : picture.density)
    for (const float density : along)
      bytes += static_cast<char>(
          most > 0.0F ? std::lround(kMostShade * std::sqrt(double{density} / double{most})) : 0);
  std::string out(BASE64_ENCODE_RAW_LENGTH(bytes.size()), '\0');
  base64_encode_raw(out.data(), bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  return out;
}

Json plane_of(const char* x, const char* y, const PhasePicture& picture) {
  return {{"x", x},
          {"y", y},
          {"x_range", {rounded(picture.x_low), rounded(picture.x_high)}},
          {"y_range", {rounded(picture.y_low), rounded(picture.y_high)}},
          {"cells", kPictureCells},
          {"samples", picture.samples},
          {"shades", picture.state == PictureState::kGood || picture.state == PictureState::kClipped
                         ? shades_of(picture)
                         : ""}};
}

Json events_of(const std::vector<RunEvent>& events) {
  Json out = Json::array();
  for (const RunEvent& event : events)
    out.push_back(
        {{"time_s", rounded(event.time_s)}, {"name", event.name}, {"value", event.value}});
  return out;
}

template <class Iterator>
std::string motion_text(Iterator from, Iterator to) {
  std::string t;
  std::string y;
  std::string v;
  for (auto point = from; point != to; ++point) {
    const char* comma = point == from ? "" : ",";
    t += fmt::format("{}{:.3f}", comma, point->time_s);
    y += fmt::format("{}{:.4g}", comma, point->deflection_m);
    v += fmt::format("{}{:.4g}", comma, point->velocity_mps);
  }
  return fmt::format(R"({{"t":[{}],"y":[{}],"v":[{}]}})", t, y, v);
}

}  // namespace

LiveView::LiveView(const Config& config)
    : rate_hz_{truck_rate_hz(config.input)},
      stride_{std::max<std::int64_t>(1, std::llround(rate_hz_ / kShownHz))},
      phase_{std::make_unique<PhaseView>(PhaseViewConfig{.sample_rate_hz = rate_hz_})},
      density_{std::make_unique<FokkerPlanck>(density_config(estimator_config(config)))},
      history_{kHistoryMs, 0} {}

void LiveView::take(const Motion& motion, std::int64_t first_tick) {
  phase_->update(motion);
  density_->update(motion);
  motion_time_s_ = static_cast<double>(motion.tick - first_tick) / rate_hz_;
  if (any_ && motion.tick - last_tick_ < stride_) return;
  any_ = true;
  last_tick_ = motion.tick;
  shown_.push_back({motion_time_s_, motion.deflection_m, motion.velocity_mps});
  ++told_;
  while (shown_.front().time_s < motion_time_s_ - kShownS) shown_.pop_front();
  told_ = std::min(told_, shown_.size());
}

void LiveView::take(const RunResult& result) {
  constexpr double kMsPerS = 1000.0;
  result_ = result;
  const auto now_ms = std::llround(kMsPerS * result.duration_s);
  const Estimate coulomb = estimate_of(result.parameters, "coulomb");
  if (coulomb.value == 0.0 || !history_.due(now_ms)) return;
  history_.add(now_ms, {true, coulomb, estimate_of(result.parameters, "stiffness")});
}

std::string LiveView::document(std::uint64_t sequence) const {
  RunResult drawn;
  const TruckRecord record;  // nothing to correct
  fill_densities(*density_, record, drawn);
  fill_phase(*phase_, record, drawn);
  Json densities = Json::array();
  for (const DensityTable& table : drawn.densities) densities.push_back(density_of(table));
  const Json planes{
      plane_of("deflection_m", "velocity_mps", drawn.phase->velocity_over_deflection),
      plane_of("deflection_m", "acceleration_mps2", drawn.phase->accel_over_deflection),
      plane_of("velocity_mps", "acceleration_mps2", drawn.phase->accel_over_velocity)};
  const Json json{{"sequence", sequence},
                  {"duration_s", rounded(result_.duration_s)},
                  {"curve", curve_of(result_.curve)},
                  {"history", history_of(history_.rows())},
                  {"densities", std::move(densities)},
                  {"planes", planes},
                  {"events", events_of(result_.events)}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string LiveView::newest_motion() {
  const auto from = shown_.end() - static_cast<std::ptrdiff_t>(told_);
  told_ = 0;
  return motion_text(from, shown_.end());
}

std::string LiveView::shown_motion() const { return motion_text(shown_.begin(), shown_.end()); }

}  // namespace dampline::app
