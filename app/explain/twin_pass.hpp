// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <memory>

#include "app/explain/frame_noise.hpp"
#include "app/explain/truck_pass.hpp"
#include "app/explain/twin.hpp"
#include "dampline/effect/conclusion.hpp"

namespace dampline::app {

/// White noise of each channel, rms, what its resolution makes included, as a record shows it.
[[nodiscard]] std::array<double, kChannels> noise_of_record(
    const TruckPass& first, const FrameNoise& frame,
    const std::array<double, kChannels>& step_mps2);

/// The declared law beside the effects that were found, per unit of mass. With a mass on the frame
/// every coefficient of the fit is of all mass, and friction and spring are of the frame's own.
[[nodiscard]] TwinConfig twin_config(const EstimatorConfig& core, const effect::Explanation& e,
                                     const std::array<double, kChannels>& noise_mps2);

/// The same with friction's memory, where some was found: it has no leap that an error of the
/// velocity could misplace, so less is left of it.
[[nodiscard]] TwinConfig with_memory(TwinConfig out, const effect::Explanation& e);

[[nodiscard]] bool is_physical(const TwinConfig& config);

/// The twin through the same estimator.
class TwinPass {
 public:
  TwinPass(const EstimatorConfig& core, const TwinConfig& config, const effect::Grids& grids)
      : remembers_{config.memory.force_mps2 > 0.0},
        twin_{config},
        run_{std::make_unique<DiagnosisRun>(IdentifierConfig{.estimator = core}, grids)} {}
  void take(const Sample& sample) {
    if (const auto twin = twin_.next(sample)) run_->push(*twin);
  }
  [[nodiscard]] const effect::Diagnosis& finish() {
    run_->finish();
    return run_->effects();
  }

  [[nodiscard]] bool remembers() const { return remembers_; }

 private:
  bool remembers_;
  Twin twin_;
  std::unique_ptr<DiagnosisRun> run_;
};

}  // namespace dampline::app
