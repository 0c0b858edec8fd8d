// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <functional>
#include <memory>

#include "app/config/config.hpp"
#include "app/identify/truck_run.hpp"
#include "app/record/feed.hpp"
#include "dampline/effect/conclusion.hpp"
#include "dampline/effect/diagnosis.hpp"
#include "dampline/effect/surrogate.hpp"
#include "dampline/motion/fractional_delay.hpp"
#include "dampline/motion/frame_noise.hpp"

namespace dampline::app {

/// A second way for samples that were set right: no frames, no guards, the sums alone.
using DiagnosisRun = BasicIdentifier<kDiagnosisParts>;

/// One record through the estimate and the diagnosis beside it.
struct TruckPass {
  std::unique_ptr<SampleFeed> feed;
  std::unique_ptr<ExplainRun> run;
  std::unique_ptr<DiagnosisRun> aligned;  ///< where a channel was set right; else null
  [[nodiscard]] const effect::Diagnosis& diagnosis() const noexcept {
    return aligned ? aligned->effects() : run->core().effects();
  }
};

struct TruckPassOptions {
  effect::Grids grids{};   ///< of candidates; their scale is learnt where it is 0
  LateChannel lateness{};  ///< of a channel that is set right for the diagnosis
  bool show_progress{false};
  /// Sees every sample that the diagnosis took.
  std::function<void(const Sample&, const UpdateResult&, const effect::Diagnosis&)> watch{};
};

/// Throws RunError when the record holds no sample, UsageError when it is no truck's.
[[nodiscard]] TruckPass pass_of(const Config& config, const SourceOptions& source,
                                const TruckPassOptions& options);

/// As a record shows it, rms, by channel.
struct RecordNoise {
  std::array<double, kChannels> sensors_mps2{};  ///< white; what the resolution makes included
  std::array<double, kChannels> bridged_mps2{};  ///< errors of values that were put in
};
[[nodiscard]] RecordNoise noise_of_record(const TruckPass& first, const FrameNoise& frame,
                                          const std::array<double, kChannels>& step_mps2);

/// The declared law beside the effects that were found, per unit of mass. With a mass on the frame
/// every coefficient of the fit is of all mass, and friction and spring are of the frame's own.
[[nodiscard]] effect::SurrogateConfig surrogate_config(const EstimatorConfig& core,
                                                       const effect::Explanation& e,
                                                       const RecordNoise& noise);

/// The same with friction's memory, where some was found: it has no leap that an error of the
/// velocity could misplace, so less is left of it.
[[nodiscard]] effect::SurrogateConfig with_memory(effect::SurrogateConfig out,
                                                  const effect::Explanation& e);

[[nodiscard]] bool is_physical(const effect::SurrogateConfig& config);

/// The surrogate through the same estimator.
class SurrogatePass {
 public:
  SurrogatePass(const EstimatorConfig& core, const effect::SurrogateConfig& config,
                const effect::Grids& grids)
      : remembers_{config.memory.force_mps2 > 0.0},
        surrogate_{config},
        run_{std::make_unique<DiagnosisRun>(IdentifierConfig{.estimator = core}, grids)} {}
  void take(const Sample& sample) {
    if (const auto surrogate = surrogate_.next(sample)) run_->push(*surrogate);
  }
  [[nodiscard]] const effect::Diagnosis& finish() {
    run_->finish();
    return run_->effects();
  }

  [[nodiscard]] bool remembers() const { return remembers_; }

 private:
  bool remembers_;
  effect::Surrogate surrogate_;
  std::unique_ptr<DiagnosisRun> run_;
};

}  // namespace dampline::app
