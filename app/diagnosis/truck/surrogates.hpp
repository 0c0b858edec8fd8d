// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <optional>

#include "app/diagnosis/truck/explain.hpp"
#include "app/diagnosis/truck/pass.hpp"
#include "dampline/effect/explainer.hpp"
#include "dampline/effect/surrogate.hpp"
#include "dampline/motion/frame_noise.hpp"
#include "dampline/motion/reference_low_pass.hpp"

namespace dampline::app {

/// What the guards know of the sensors' noise.
struct GuardedNoise {
  std::array<double, kChannels> seen_mps2{};  ///< white, rms; what was put in included
  BridgeFigures bridged;
};
template <class Core>
[[nodiscard]] GuardedNoise guarded_noise(const Core& core) noexcept {
  GuardedNoise out;
  for (std::size_t c = 0; c < kChannels; ++c) out.seen_mps2[c] = core.guard().noise_mps2(c);
  out.bridged = core.faults().repairs.bridged;
  return out;
}

/// As a record shows it, rms, by channel.
struct RecordNoise {
  std::array<double, kChannels> sensors_mps2{};  ///< white; what the resolution makes included
  std::array<double, kChannels> bridged_mps2{};  ///< errors of values that were put in
};
[[nodiscard]] RecordNoise noise_of_record(const GuardedNoise& guarded, const FrameNoise& frame,
                                          const std::array<double, kChannels>& step_mps2);

/// The declared law beside the effects that were found, per unit of mass. With a mass on the frame
/// every coefficient of the fit is of all mass, and friction and spring are of the frame's own.
[[nodiscard]] effect::SurrogateConfig surrogate_config(const EstimatorConfig& core,
                                                       const effect::Explanation& e,
                                                       const RecordNoise& noise);

/// The same with what was found of the law: it moves otherwise then, and friction with a memory has
/// no leap that an error of the velocity could misplace.
[[nodiscard]] effect::SurrogateConfig with_found(effect::SurrogateConfig out,
                                                 const effect::Explanation& e);

/// What identifies it: the same, told that it is behind the reference low pass already.
[[nodiscard]] inline EstimatorConfig behind_low_pass(EstimatorConfig core) noexcept {
  core.anti_alias = ReferenceLowPass::seen_behind(core.anti_alias);
  return core;
}

[[nodiscard]] bool is_physical(const effect::SurrogateConfig& config);

/// The surrogate through the same estimator. Some 8 MB.
class SurrogatePass {
 public:
  SurrogatePass(const EstimatorConfig& core, const effect::SurrogateConfig& config,
                const effect::Grids& grids)
      : surrogate_{config}, run_{IdentifierConfig{.estimator = behind_low_pass(core)}, grids} {}
  void take(const Sample& sample) {
    if (const auto surrogate = surrogate_.next(sample)) run_.push(*surrogate);
  }
  /// No more samples.
  void finish() { run_.finish(); }
  /// What is gathered of all whole blocks; samples may follow.
  void gather() { run_.gather_effects(); }
  [[nodiscard]] const effect::Diagnosis& diagnosis() const noexcept { return run_.effects(); }

 private:
  effect::Surrogate surrogate_;
  DiagnosisRun run_;
};

/// The surrogates that an explanation is held against: one of the declared law; one that has what
/// was found, too, or else one with other noise. Some 16 MB, all of it this object's.
class Surrogates {
 public:
  /// What was taken before is forgotten. Of an impossible law there is no surrogate.
  void begin(const EstimatorConfig& core, const effect::SurrogateConfig& declared,
             const effect::Explanation& e);
  void take(const Sample& sample) {
    for (auto& pass : passes_)
      if (pass) pass->take(sample);
  }
  void finish() {
    for (auto& pass : passes_)
      if (pass) pass->finish();
  }
  void gather() {
    for (auto& pass : passes_)
      if (pass) pass->gather();
  }
  /// How much no effect can take away of what is left: fills floor and conclusion.
  /// `rows`: of the record that was explained, where the surrogates have seen only some of it; 0:
  /// they have seen all of it. False: they show the first effect as well, which is needless then;
  /// explain anew without it. Precondition: finish() or gather().
  [[nodiscard]] bool hold_against(effect::Explainer& explainer, double rows, Explained& out) const;

 private:
  std::array<std::optional<SurrogatePass>, 2> passes_;
  bool finds_{false};
  double unexplained_above_{effect::kUnexplainedAbove};
};

}  // namespace dampline::app
