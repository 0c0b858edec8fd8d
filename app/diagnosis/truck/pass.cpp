// SPDX-License-Identifier: MIT
#include "app/diagnosis/truck/pass.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "app/error.hpp"
#include "app/identify/identify_source.hpp"
#include "app/record/source_kind.hpp"

namespace dampline::app {

namespace {

SourceKind truck_source(const Config& config, const SourceOptions& source) {
  const SourceKind kind = detect_source(config, source);
  if (kind == SourceKind::kInterface)
    throw UsageError{fmt::format(
        "{}: is an interface, expected a record: record it with identify first", source.path)};
  if (kind == SourceKind::kRigRows)
    throw UsageError{
        fmt::format("{}: has the columns of a rig, expected a truck's accelerations as the others",
                    source.path)};
  return kind;
}

/// Hands on what a pass's second way made of its samples.
struct AlignedWatch {
  const TruckPassOptions& options;
  const TruckPass& pass;
  void taken(const Sample& /*unused*/) const noexcept {}
  void judged(const Sample& sample, const UpdateResult& result) const {
    if (options.watch) options.watch(sample, result, pass.diagnosis());
  }
};

}  // namespace

TruckPass pass_of(const Config& config, const SourceOptions& source,
                  const TruckPassOptions& options) {
  TruckPass pass;
  static_cast<void>(estimator_config(config));  // wrong settings before a wrong source
  pass.feed = open_feed(config, source, truck_source(config, source));
  pass.run = std::make_unique<ExplainRun>(config, pass.feed->signals(), options.grids);
  const IdentifierConfig& core = pass.run->config();
  FractionalDelay alignment{options.lateness, core.estimator.sample_rate_hz};
  if (options.lateness.late_s != 0.0) {
    pass.aligned = std::make_unique<DiagnosisRun>(core, options.grids);
    AlignedWatch watch{options, pass};
    pass.run->watch([&alignment, &pass, watch](const Sample& sample, const UpdateResult&) mutable {
      if (const auto aligned = alignment.next(sample)) pass.aligned->push(*aligned, watch);
    });
  } else if (options.watch) {
    pass.run->watch([&options, &pass](const Sample& sample, const UpdateResult& result) {
      options.watch(sample, result, pass.diagnosis());
    });
  }
  pump(*pass.feed, source, options.show_progress, *pass.run);
  pass.run->close();
  pass.run->watch({});
  if (pass.aligned) pass.aligned->finish();
  return pass;
}

namespace {

constexpr double kOneKind = 3.0;      // of powers of noise
constexpr double kNoiseDoubt = 1.25;  // of the guards' median, which bursts do not lift

/// What the wheelsets do not share counts as their noise, and aliasing adds to it. Where sensors
/// may be of one kind, the frame's noise, which is measured apart from its motion, is that of all.
std::array<double, kChannels> noise_of(std::array<double, kChannels> seen_mps2,
                                       const std::array<double, kChannels>& step_mps2) {
  const auto rounding = [&](std::size_t c) { return step_mps2[c] * step_mps2[c] / 12.0; };
  const double frame = seen_mps2[0] * seen_mps2[0] - rounding(0);
  for (std::size_t c = 1; c < kChannels; ++c) {
    const double own = seen_mps2[c] * seen_mps2[c] - rounding(c);
    if (frame > 0.0 && own > frame && own < kOneKind * frame)
      seen_mps2[c] = std::sqrt(frame + rounding(c));
  }
  return seen_mps2;
}

}  // namespace

RecordNoise noise_of_record(const TruckPass& first, const FrameNoise& frame,
                            const std::array<double, kChannels>& step_mps2) {
  const BridgeFigures bridged = first.run->core().faults().repairs.bridged;
  const auto of_sensor = [&](double seen_mps2, std::size_t c) {
    const double added = bridged.noise_mps2[c];
    return added > 0.0 ? std::sqrt(std::max(seen_mps2 * seen_mps2 - added * added, 0.0))
                       : seen_mps2;
  };
  std::array<double, kChannels> seen{};
  for (std::size_t c = 0; c < kChannels; ++c)
    seen[c] = of_sensor(first.run->core().guard().noise_mps2(c), c);
  const double whole = of_sensor(frame.noise_mps2(), 0);
  if (seen[0] > 0.0 && whole > 0.0)
    seen[0] = std::clamp(whole, seen[0] / kNoiseDoubt, kNoiseDoubt * seen[0]);
  return {noise_of(seen, step_mps2), bridged.error_mps2};
}

effect::SurrogateConfig surrogate_config(const EstimatorConfig& core, const effect::Explanation& e,
                                         const RecordNoise& noise) {
  effect::SurrogateConfig out;
  out.sample_rate_hz = core.sample_rate_hz;
  out.stiffness_per_s2 = e.final.theta[effect::ModelFit::kStiffness];
  const double mass_kg = e.final_stiffness_npm.value / out.stiffness_per_s2;
  out.coulomb_mps2 = e.final_coulomb_n.value / mass_kg;
  if (e.base_count > 0)
    out.viscous_per_s = std::max(e.final.theta[effect::ModelFit::kFirstEffect], 0.0);
  out.anti_alias_hz = core.anti_alias.corner_hz;
  out.noise_mps2 = noise.sensors_mps2;
  out.bridged_mps2 = noise.bridged_mps2;
  out.step_mps2 = core.screen.step_mps2;
  return out;
}

effect::SurrogateConfig with_memory(effect::SurrogateConfig out, const effect::Explanation& e) {
  const double mass_kg = e.final_coulomb_n.value / out.coulomb_mps2;
  for (std::size_t i = 0; i < e.step_count; ++i) {
    if (!effect::has_memory(e.step[i].chosen.effect)) continue;
    const auto& parameter = e.step[i].parameter;  // force and length
    out.memory = {e.step[i].chosen.effect == effect::Effect::kBacklash,
                  parameter[0].estimate.value / mass_kg, parameter[1].estimate.value};
    out.coulomb_mps2 = std::max(out.coulomb_mps2 - out.memory.force_mps2, 0.0);
    return out;
  }
  return out;
}

bool is_physical(const effect::SurrogateConfig& c) {
  return c.stiffness_per_s2 > 0.0 && c.coulomb_mps2 > 0.0 && c.viscous_per_s >= 0.0;
}

}  // namespace dampline::app
