// SPDX-License-Identifier: MIT
#include "app/fleet/merged.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/error.hpp"
#include "app/identify/truck_result.hpp"
#include "app/run/provenance.hpp"
#include "app/run/tables.hpp"
#include "app/run/trust.hpp"
#include "app/text/format.hpp"
#include "app/text/summary.hpp"
#include "dampline/damping/estimator.hpp"
#include "dampline/damping/summary.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace dampline::app::fleet {
namespace {

MeasuredRate measured_rate(const StateAbout& about) {
  return {about.rate_hz.value, about.rate_hz.std, about.sequence};
}

TruckRecord record_of(const Statistics& sums, const StateAbout& about, const Snapshot& snapshot) {
  const double nominal_hz = sums.header.sample_rate_hz;
  const MeasuredRate rate = measured_rate(about);
  const RateCorrection correction = make_correction(rate, nominal_hz, "a merge");
  const auto samples = static_cast<std::int64_t>(sums.header.counts.samples);
  return {corrected(snapshot, correction), correction, rate,
          nominal_hz * correction.ratio,   0,          samples - 1};
}

Convergence empty_history() { return {{"coulomb", "stiffness"}, {"N", "N/m"}, {}}; }

/// A row for what the tree holds now.
void add_row(const Tree& tree, const StateAbout& about, Convergence& history) {
  const auto sums = tree.total();
  const Level level = summarise_level(*sums, {.moving_mass_kg = about.moving_mass_kg});
  if (!level.valid) return;
  const TruckRecord record = record_of(*sums, about, Snapshot{});
  const double factor = record.correction.stiffness();
  history.rows.push_back(
      {record.time_s(record.newest_tick + 1),
       {level.coulomb_n, {factor * level.stiffness_npm.value, factor * level.stiffness_npm.std}}});
}

std::string span_text(const StateAbout& about) {
  if (about.segment.start_ns == 0) return "";
  constexpr std::size_t kDate = 10;
  return fmt::format(", from {} to {}", utc_text(about.segment.start_ns).substr(0, kDate),
                     utc_text(about.end_ns).substr(0, kDate));
}

std::size_t trucks_in(std::span<const Leaf> leaves) {
  std::size_t count = 1;
  for (std::size_t i = 1; i < leaves.size(); ++i) {
    const Segment& a = leaves[i - 1].about.segment;
    const Segment& b = leaves[i].about.segment;
    if (a.vehicle != b.vehicle || a.truck != b.truck) ++count;
  }
  return count;
}

/// The name that all have; "": they differ.
template <class Name>
std::string common(std::span<const Leaf> leaves, const Name& name) {
  const std::string& first = name(leaves.front().about);
  const bool same = std::all_of(leaves.begin(), leaves.end(),
                                [&](const Leaf& leaf) { return name(leaf.about) == first; });
  return same ? first : "";
}

Estimate mean_rate(std::span<const Leaf> leaves) {
  double weight = 0.0;
  Estimate sum;
  for (const Leaf& leaf : leaves) {
    if (!(leaf.about.rate_hz.value > 0.0)) continue;
    const auto samples = static_cast<double>(leaf.about.sequence);
    weight += samples;
    sum.value += samples * leaf.about.rate_hz.value;
    sum.std = std::max(sum.std, leaf.about.rate_hz.std);
  }
  return weight > 0.0 ? Estimate{sum.value / weight, sum.std} : Estimate{};
}

/// What a reader of the run directory may load again; what a state does not hold is as by default.
Config config_of(const Merged& merged) {
  Config config;
  const StatisticsHeader& header = merged.sums->header;
  config.record = {merged.about.segment.vehicle, merged.about.segment.truck, merged.about.load, ""};
  config.car.moving_mass_kg = merged.about.moving_mass_kg;
  config.input.sample_rate_hz = header.sample_rate_hz;
  config.input.sample_rate_is_set = true;
  config.model.velocity_corner_hz = header.velocity_corner_hz;
  config.model.curve_nodes_mps = {header.curve_nodes_mps.begin(), header.curve_nodes_mps.end()};
  if (merged.about.viscous) config.model.base = {"coulomb", "viscous"};
  return config;
}

std::string cell(const std::string& text) { return without(text, ",\""); }

std::string utc_cell(std::int64_t time_ns) { return time_ns == 0 ? "" : utc_text(time_ns); }

}  // namespace

StateAbout about_of(std::span<const Leaf> leaves) {
  StateAbout out = leaves.front().about;
  if (leaves.size() == 1) return out;
  out.segment.vehicle =
      common(leaves, [](const StateAbout& a) -> const std::string& { return a.segment.vehicle; });
  out.segment.truck =
      common(leaves, [](const StateAbout& a) -> const std::string& { return a.segment.truck; });
  out.load = common(leaves, [](const StateAbout& a) -> const std::string& { return a.load; });
  out.segment.record = 0;
  out.alarms.clear();
  out.segments = static_cast<std::uint32_t>(leaves.size());
  out.sequence = 0;
  for (const Leaf& leaf : leaves) {
    const StateAbout& about = leaf.about;
    out.sequence += about.sequence;
    out.segment.start_ns = std::min(out.segment.start_ns, about.segment.start_ns);
    out.end_ns = std::max(out.end_ns, about.end_ns);
    out.viscous = out.viscous && about.viscous;
  }
  out.rate_hz = mean_rate(leaves);
  return out;
}

Merged merge_alike(std::span<const Leaf> leaves, const NextChunk& next) {
  Merged out;
  out.about = about_of(leaves);
  out.history = empty_history();
  out.sums =
      merge_leaves(leaves, next, [&](const Tree& tree) { add_row(tree, out.about, out.history); });
  return out;
}

RunResult describe(const Merged& merged, std::span<const Leaf> leaves) {
  const StateAbout& about = merged.about;
  const Snapshot snapshot = summarise(*merged.sums, {.moving_mass_kg = about.moving_mass_kg});
  if (!snapshot.valid)
    throw RunError{fmt::format(
        "{}: nothing can be identified: {} blocks of 2 s in {} groups from {} states{}; some ten "
        "usable blocks are needed, or four light states",
        leaves.front().file.string(), merged.sums->total.blocks, merged.sums->header.entry_count,
        leaves.size(), leaves.front().light ? ", light ones" : "")};
  const TruckRecord record = record_of(*merged.sums, about, snapshot);
  RunResult result = describe_truck(record, config_of(merged).model);
  result.origin.recorded = recorded_span(about.segment.start_ns, about.end_ns);
  result.convergence = merged.history;
  const std::size_t trucks = trucks_in(leaves);
  result.notes.insert(result.notes.begin(),
                      fmt::format("Merged from {} {} of {} {}{}.", leaves.size(),
                                  leaves.size() == 1 ? "segment" : "segments", trucks,
                                  trucks == 1 ? "truck" : "trucks", span_text(about)));
  if (trucks == 1)
    if (const ParameterDrift drift = find_parameter_drift(*merged.sums, Estimator::kBlockS);
        drift.found) {
      result.faults.drift = finding_of(drift);
      result.warnings.push_back(drift_warning(*result.faults.drift, "segments"));
    }
  judge_trust(nullptr, result);
  return result;
}

RunFiles files_of(const Merged& merged, std::span<const Leaf> leaves,
                  const std::vector<std::string>& sources, const std::vector<std::string>& notes) {
  RunResult result = describe(merged, leaves);
  for (const std::vector<std::string>& told : {notes, overlaps(leaves)})
    result.warnings.insert(result.warnings.end(), told.begin(), told.end());
  std::vector<InputFile> inputs;
  inputs.reserve(sources.size());
  for (const std::string& source : sources) inputs.push_back({source, "state", 0, ""});
  StateAbout about = merged.about;
  if (about.segments > 1) {
    about.trust = result.trust;
    about.coulomb_n = estimate_of(result.parameters, "coulomb");
    about.stiffness_npm = estimate_of(result.parameters, "stiffness");
  }
  RunFiles files = make_files(config_of(merged), std::move(result), inputs);
  files.state = encode_state(*merged.sums, about);
  files.segments = segments_csv(leaves);
  return files;
}

std::string segments_csv(std::span<const Leaf> leaves) {
  std::string out =
      "vehicle,truck,load,start_utc,end_utc,samples,moving_mass_kg,rate_hz,coulomb_n,coulomb_std_n,"
      "stiffness_npm,stiffness_std_npm,trust,file\n";
  for (const Leaf& leaf : leaves) {
    const StateAbout& a = leaf.about;
    out += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", cell(a.segment.vehicle),
                       cell(a.segment.truck), cell(a.load), utc_cell(a.segment.start_ns),
                       utc_cell(a.end_ns), a.sequence, a.moving_mass_kg, a.rate_hz.value,
                       a.coulomb_n.value, a.coulomb_n.std, a.stiffness_npm.value,
                       a.stiffness_npm.std, name_of(a.trust), cell(leaf.file.string()));
  }
  return out;
}

}  // namespace dampline::app::fleet
