// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <functional>
#include <memory>

#include "app/config/config.hpp"
#include "app/diagnosis/truck/other_truck.hpp"
#include "app/identify/truck_run.hpp"
#include "app/record/feed.hpp"
#include "dampline/effect/conclusion.hpp"
#include "dampline/effect/diagnosis.hpp"
#include "dampline/motion/fractional_delay.hpp"

namespace dampline::app {

/// A second way for samples that were set right: no frames, no guards, the sums alone.
using DiagnosisRun = BasicIdentifier<kDiagnosisParts>;

/// One record through the estimate and the diagnosis beside it.
struct TruckPass {
  std::unique_ptr<SampleFeed> feed;
  std::unique_ptr<ExplainRun> run;
  std::unique_ptr<DiagnosisRun> aligned;  ///< where samples were set right; else null
  [[nodiscard]] const effect::Diagnosis& diagnosis() const noexcept {
    return aligned ? aligned->effects() : run->core().effects();
  }
};

struct TruckPassOptions {
  effect::Grids grids{};       ///< of candidates; their scale is learnt where it is 0
  ChannelLateness lateness{};  ///< of channels that are set right for the diagnosis
  bool show_progress{false};
  /// Sees every sample that the diagnosis took.
  std::function<void(const Sample&, const UpdateResult&, const effect::Diagnosis&)> watch{};
  const OtherTruck* other{nullptr};  ///< whose frame moves as it says; null: none is known
};

/// Throws RunError when the record holds no sample, UsageError when it is no truck's.
[[nodiscard]] TruckPass pass_of(const Config& config, const SourceOptions& source,
                                const TruckPassOptions& options);

}  // namespace dampline::app
