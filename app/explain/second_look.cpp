// SPDX-License-Identifier: MIT
#include "app/explain/second_look.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "app/explain/evidence_meter.hpp"
#include "app/explain/truck_points.hpp"
#include "app/explain/twin.hpp"
#include "dampline/identifier.hpp"

namespace dampline::app {
namespace {

constexpr double kLeastTurn = 0.05;   // of the deflection's rms: smaller ones are noise
constexpr double kOneKind = 3.0;      // of powers of noise
constexpr double kLawReach = 2.5;     // of the velocity's rms
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

std::array<double, kChannels> noise_of_record(const TruckPass& first, const FrameNoise& frame,
                                              const std::array<double, kChannels>& step_mps2) {
  std::array<double, kChannels> seen = first.run->noise_mps2();
  const double whole = frame.noise_mps2();
  if (seen[0] > 0.0 && whole > 0.0)
    seen[0] = std::clamp(whole, seen[0] / kNoiseDoubt, kNoiseDoubt * seen[0]);
  return noise_of(seen, step_mps2);
}

/// The declared law beside the effects that were found, per unit of mass. With a mass on the frame
/// every coefficient of the fit is of all mass, and friction and spring are of the frame's own.
TwinConfig twin_config(const IdentifierConfig& core, const effect::Explanation& e,
                       const std::array<double, kChannels>& noise_mps2) {
  TwinConfig out;
  out.sample_rate_hz = core.sample_rate_hz;
  out.stiffness_per_s2 = e.final.theta[effect::ModelFit::kStiffness];
  const double mass_kg = e.final_stiffness_npm.value / out.stiffness_per_s2;
  out.coulomb_mps2 = e.final_coulomb_n.value / mass_kg;
  if (e.base_count > 0) out.viscous_per_s = e.final.theta[effect::ModelFit::kFirstEffect];
  out.anti_alias_hz = core.anti_alias.corner_hz;
  out.noise_mps2 = noise_mps2;
  out.step_mps2 = core.screen.step_mps2;
  return out;
}

/// The same with friction's memory, where some was found: it has no leap that an error of the
/// velocity could misplace, so less is left of it.
TwinConfig with_memory(TwinConfig out, const effect::Explanation& e) {
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

bool is_physical(const TwinConfig& c) {
  return c.stiffness_per_s2 > 0.0 && c.coulomb_mps2 > 0.0 && c.viscous_per_s >= 0.0;
}

/// The twin through the same estimator.
class TwinPass {
 public:
  TwinPass(const IdentifierConfig& core, const TwinConfig& config, double scale_m)
      : remembers_{config.memory.force_mps2 > 0.0},
        twin_{config},
        identifier_{std::make_unique<Identifier>(core)},
        diagnosis_{std::make_unique<effect::Diagnosis>(core, scale_m)} {}
  void take(const Sample& sample) {
    const auto twin = twin_.next(sample);
    if (twin) diagnosis_->update(*twin, identifier_->update(*twin));
  }
  [[nodiscard]] const effect::Diagnosis& finish() {
    diagnosis_->finish();
    return *diagnosis_;
  }

  [[nodiscard]] bool remembers() const { return remembers_; }

 private:
  bool remembers_;
  Twin twin_;
  std::unique_ptr<Identifier> identifier_;
  std::unique_ptr<effect::Diagnosis> diagnosis_;
};

EvidenceScale scale_of(const IdentifierConfig& core, const TruckPass& first) {
  const double deflection_m = first.diagnosis->deflection_rms_m();
  return {deflection_m, first.diagnosis->velocity_rms_mps(), kLeastTurn * deflection_m,
          core.sample_rate_hz, first.run->time_s()};
}

/// One of the declared law; one that has friction's memory, too, or else one with other noise.
using Twins = std::array<std::unique_ptr<TwinPass>, 2>;

Twins twins_of(const IdentifierConfig& core, const TwinConfig& declared, double scale_m,
               const effect::Explanation& e) {
  Twins out;
  if (!is_physical(declared)) return out;
  out[0] = std::make_unique<TwinPass>(core, declared, scale_m);
  TwinConfig second = with_memory(declared, e);
  ++second.seed;
  out[1] = std::make_unique<TwinPass>(core, second, scale_m);
  return out;
}

/// The record again, with the twins.
void read_again(const Config& config, const ExplainOptions& options, const IdentifierConfig& core,
                const TruckPass& first, const Twins& twins, Explained& out) {
  EvidenceMeter meter{scale_of(core, first)};
  TruckPoints points{core.sample_rate_hz,
                     core.moving_mass_kg,
                     out.explanation,
                     {[&](const EvidencePoint& p) { meter.add(p); }, [&] { meter.gap(); }}};
  TruckPassOptions again{first.diagnosis->scale_m(), options.show_progress, {}};
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
                           kLawReach * first.diagnosis->velocity_rms_mps());
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
  IdentifierConfig core = identifier_config(config);
  core.screen = first.feed->screen();
  const TwinConfig declared =
      twin_config(core, out.explanation, noise_of_record(first, noise, core.screen.step_mps2));
  const Twins twins = twins_of(core, declared, first.diagnosis->scale_m(), out.explanation);
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
  if (out.explanation.step_count != steps) read_again(config, options, core, first, {}, out);
}

}  // namespace dampline::app
