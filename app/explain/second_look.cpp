// SPDX-License-Identifier: MIT
#include "app/explain/second_look.hpp"

#include <filesystem>
#include <memory>

#include "app/explain/evidence_meter.hpp"
#include "app/explain/truck_points.hpp"
#include "app/explain/twin_pass.hpp"

namespace dampline::app {
namespace {

constexpr double kLeastTurn = 0.05;  // of the deflection's rms: smaller ones are noise
constexpr double kLawReach = 2.5;    // of the velocity's rms

EvidenceScale scale_of(const EstimatorConfig& core, const TruckPass& first) {
  const double deflection_m = first.diagnosis().deflection_rms_m();
  return {deflection_m, first.diagnosis().velocity_rms_mps(), kLeastTurn * deflection_m,
          core.sample_rate_hz, first.run->time_s()};
}

/// One of the declared law; one that has friction's memory, too, or else one with other noise.
using Twins = std::array<std::unique_ptr<TwinPass>, 2>;

Twins twins_of(const EstimatorConfig& core, const TwinConfig& declared,
               const effect::Explanation& e) {
  Twins out;
  if (!is_physical(declared)) return out;
  out[0] = std::make_unique<TwinPass>(core, declared, e.grids);
  TwinConfig second = with_memory(declared, e);
  ++second.seed;
  out[1] = std::make_unique<TwinPass>(core, second, e.grids);
  return out;
}

/// The record again, with the twins.
void read_again(const Config& config, const ExplainOptions& options, const EstimatorConfig& core,
                const TruckPass& first, const Twins& twins, Explained& out) {
  EvidenceMeter meter{scale_of(core, first)};
  TruckPoints points{core.sample_rate_hz,
                     core.moving_mass_kg,
                     out.explanation,
                     {[&](const EvidencePoint& p) { meter.add(p); }, [&] { meter.gap(); }}};
  TruckPassOptions again{out.explanation.grids, out.lateness, options.show_progress, {}};
  again.watch = [&](const Sample& sample, const UpdateResult& result,
                    const effect::Diagnosis& diagnosis) {
    points.take(sample, result, diagnosis);
    for (const auto& twin : twins)
      if (twin) twin->take(sample);
  };
  static_cast<void>(pass_of(config, options.source, again));
  Evidence& evidence = out.identified.evidence;
  evidence = {};
  meter.fill(evidence);
  evidence.law = truck_law(out.explanation, core.moving_mass_kg,
                           kLawReach * first.diagnosis().velocity_rms_mps());
  out.signature = meter.signature();
}

}  // namespace

bool can_read_again(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored) ||
         std::filesystem::is_directory(path, ignored);
}

void look_again(const Config& config, const ExplainOptions& options, const TruckPass& first,
                const FrameNoise& noise, effect::Explainer& explainer, Explained& out) {
  if (!can_read_again(options.source.path)) return;
  EstimatorConfig core = estimator_config(config);
  core.screen = first.run->config().estimator.screen;
  const TwinConfig declared =
      twin_config(core, out.explanation, noise_of_record(first, noise, core.screen.step_mps2));
  const Twins twins = twins_of(core, declared, out.explanation);
  read_again(config, options, core, first, twins, out);
  if (!twins[0]) return;
  const std::size_t steps = out.explanation.step_count;
  const auto conclusion = out.explanation.conclusion;
  const effect::Diagnosis* const second = &twins[1]->finish();
  const bool remembers = twins[1]->remembers();
  explainer.apply_floor(
      {twins[0]->finish(), remembers ? nullptr : second, remembers ? second : nullptr},
      out.identified.faults.impacts, out.explanation);
  if (out.withheld || out.drifts) out.explanation.conclusion = conclusion;
  // A twin that shows the same effect has taken it back: what is left is the base's.
  if (out.explanation.step_count == steps) return;
  out.lateness = {};
  read_again(config, options, core, first, {}, out);
}

}  // namespace dampline::app
