// SPDX-License-Identifier: MIT
#include "app/identify/truck_result.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/text/format.hpp"

namespace dampline::app {
namespace {

constexpr double kNotableShare = 0.02;  // of the level: a viscous part worth speaking of
constexpr double kNotableSigmas = 3.0;
constexpr double kRareSupport = 50.0;  // samples

std::string pair_text(const Estimate& estimate, double scale, const char* unit) {
  const QuantityText text = format_quantity(scale * estimate.value, scale * estimate.std);
  if (text.std.empty()) return fmt::format("{} {}", text.value, unit);
  return fmt::format("{} ± {} {}", text.value, text.std, unit);
}

bool has(const std::vector<std::string>& words, const char* word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

void add(RunResult& result, const char* name, const Estimate& estimate, const char* unit) {
  result.parameters.push_back({name, estimate.value, estimate.std, unit});
}

void fill_parameters(const Snapshot& s, const ModelConfig& model, RunResult& result) {
  const bool viscous = has(model.base, "viscous");
  add(result, "coulomb", viscous ? s.coulomb_with_viscous_n : s.coulomb_n, "N");
  add(result, "stiffness", viscous ? s.stiffness_with_viscous_npm : s.stiffness_npm, "N/m");
  if (viscous) add(result, "viscous", s.viscous_nspm, "N s/m");
  add(result, "law_width", viscous ? s.law_width_with_viscous_mps : s.law_width_mps, "m/s");
  result.model = {"linear spring"};
  result.model.insert(result.model.end(), model.base.begin(), model.base.end());
}

void fill_counts(const Counts& c, RunResult& result) {
  result.counts = {{"samples", c.samples},
                   {"gaps", c.gaps},
                   {"lost", c.lost},
                   {"saturated", c.saturated},
                   {"stuck", c.stuck},
                   {"not_finite", c.not_finite},
                   {"repeated", c.repeated},
                   {"blocks", c.blocks},
                   {"blocks_excluded", c.blocks_excluded},
                   {"blocks_still", c.blocks_still},
                   {"rows", c.rows},
                   {"rows_still", c.rows_still}};
}

/// The curve is odd: the branch v < 0 mirrors v > 0 but has its own support.
void fill_curve(const Snapshot& s, RunResult& result) {
  for (std::size_t i = kCurveSegments; i-- > 0;) {
    const CurvePoint& p = s.curve[i];
    result.curve.push_back({-p.velocity_mps, -p.force_n, p.std_n, s.samples_negative[i]});
  }
  result.curve.push_back({0.0, -s.curve_force_at_zero_n, s.curve_std_at_zero_n, 0});
  result.curve.push_back({0.0, s.curve_force_at_zero_n, s.curve_std_at_zero_n, 0});
  for (const CurvePoint& p : s.curve)
    result.curve.push_back({p.velocity_mps, p.force_n, p.std_n, p.samples});
}

std::string viscous_note(const Snapshot& s) {
  const double force = s.viscous_nspm.value * s.velocity_rms_mps;
  const double share = force / s.coulomb_n.value;
  const bool notable = std::fabs(share) > kNotableShare &&
                       std::fabs(s.viscous_nspm.value) > kNotableSigmas * s.viscous_nspm.std;
  const std::string what = fmt::format(
      "A viscous part, had the model one, would be {}: {:.2g} % of the dry friction at the "
      "rms velocity of {:.3g} mm/s.",
      pair_text(s.viscous_nspm, 1.0, "N s/m"), 100.0 * share, 1e3 * s.velocity_rms_mps);
  return what + (notable
                     ? " That is more than chance: consider base = [\"coulomb\", \"viscous\"] in "
                       "[model]."
                     : " That is not significant.");
}

void fill_notes(const Snapshot& s, const TruckRecord& record, const ModelConfig& model,
                RunResult& result) {
  if (!has(model.base, "viscous")) result.notes.push_back(viscous_note(s));
  result.notes.emplace_back(
      "Forces and stiffness scale with [car] moving_mass_kg, which accelerations "
      "cannot show: an error of 1 % there is an error of 1 % here.");
  result.notes.push_back(
      fmt::format("Sensor noise, estimated above 120 Hz: {:.3g} m/s^2 rms.", s.noise_mps2));
  const auto rare = std::count_if(s.curve.begin(), s.curve.end(), [](const CurvePoint& p) {
    return static_cast<double>(p.samples) < kRareSupport;
  });
  if (rare > 0)
    result.notes.push_back(fmt::format("{} of the curve's {} nodes have fewer than {:g} samples.",
                                       rare, kCurveSegments, kRareSupport));
  if (!(record.measured.rate_hz > 0.0))
    result.notes.emplace_back("The record's own time did not allow to measure the sample rate.");
}

}  // namespace

RunResult describe_truck(const TruckRecord& record, const ModelConfig& model) {
  const Snapshot& s = record.snapshot;
  RunResult result;
  result.kind = "truck";
  fill_parameters(s, model, result);
  fill_counts(s.counts, result);
  fill_curve(s, result);
  const bool viscous = has(model.base, "viscous");
  const double nmse = viscous ? s.nmse_with_viscous : s.nmse;
  result.fit = {nmse, std::sqrt(nmse), viscous ? s.held_out_nmse_with_viscous : s.held_out_nmse};
  result.std_is_lower_bound = viscous ? s.std_with_viscous_is_lower_bound : s.std_is_lower_bound;
  result.stick_share = s.stick_share;
  result.excitation = s.excitation;
  result.asymmetry = "not observable from accelerations";
  if (record.measured.rate_hz > 0.0)
    result.sample_rate_hz = Estimate{record.measured.rate_hz, record.measured.std_hz};
  result.duration_s = record.time_s(record.newest_tick + 1);
  const Parameter& coulomb = result.parameters[0];
  const Parameter& stiffness = result.parameters[1];
  result.headline = fmt::format(
      "Dry friction (Coulomb level) of {} and a spring of {}, identified from {} of record.",
      pair_text({coulomb.value, coulomb.std}, 1.0, "N"),
      pair_text({stiffness.value, stiffness.std}, 1e-6, "MN/m"),
      format_duration(result.duration_s));
  fill_notes(s, record, model, result);
  return result;
}

void fill_history(const std::vector<ConvergenceHistory::Row>& rows, const TruckRecord& record,
                  RunResult& result) {
  const double factor = record.correction.stiffness();
  result.convergence.names = {"coulomb", "stiffness"};
  result.convergence.units = {"N", "N/m"};
  for (const ConvergenceHistory::Row& row : rows) {
    const Estimate stiffness{factor * row.stiffness_npm.value, factor * row.stiffness_npm.std};
    result.convergence.rows.push_back({record.time_s(row.tick), {row.coulomb_n, stiffness}});
  }
}

void fill_motion(const std::vector<Motion>& motion, const TruckRecord& record, RunResult& result) {
  result.motion.reserve(motion.size());
  for (const Motion& m : motion)
    result.motion.push_back({record.time_s(m.tick), record.correction.deflection() * m.deflection_m,
                             record.correction.velocity() * m.velocity_mps});
}

}  // namespace dampline::app
