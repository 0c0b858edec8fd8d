// SPDX-License-Identifier: MIT
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/diagnosis/common/explanation.hpp"
#include "app/diagnosis/truck/other_truck.hpp"
#include "app/identify/truck_run.hpp"
#include "app/record/feed.hpp"
#include "app/run/provenance.hpp"
#include "app/run/result.hpp"
#include "dampline/effect/conclusion.hpp"
#include "dampline/effect/judgement.hpp"
#include "dampline/motion/fractional_delay.hpp"

namespace dampline::app {

/// What looked like an effect at first and was none, and is no candidate any more.
struct Needless {
  std::array<bool, effect::kEffects> effect{};
  bool second_late{false};  ///< of two late channels
};

/// A truck record explained.
struct Explained : effect::Judgement {
  effect::Circumstances circumstances;  ///< of the record
  ChannelLateness lateness{};           ///< of channels that were set right for the explanation
  /// The truck under the other end of the body, where the explanation takes it in; or null.
  std::shared_ptr<const OtherTruck> other;
  double without_other_nmse{0.0};  ///< held-out error of the base without it
  Needless needless;
  /// By which share the frame's sensor tells too much by its own motion, where no step has it.
  std::optional<Estimate> frame_gain;
  std::vector<Validated> validation;
  Signature signature;  ///< of what the final model leaves; rms 0: the record was read only once
  Convergence convergence;         ///< of the final model; where the record was read again
  RunResult identified;            ///< what identify says of the same record
  std::vector<std::string> notes;  ///< of what was found, a sentence each
  std::shared_ptr<const Statistics> sums;
  std::vector<InputFile> inputs;
};

/// What `search` saw of a record that was explained `without` it: the other truck, where one may be
/// told and what is left tells of it; or null.
[[nodiscard]] std::shared_ptr<const OtherTruck> other_in(const Config& config,
                                                         const OtherTruckSearch& search,
                                                         double velocity_rms_mps,
                                                         const Explained& without);
/// Whether an explanation `with` it is the better one.
[[nodiscard]] bool other_leaves_less(const Explained& with, const Explained& without) noexcept;

/// Sensors that do not tell this truck's motion join the faults that identify found.
void take_misplaced(TruckView view, double rate_hz, Explained& out);

struct ExplainOptions {
  SourceOptions source;
  std::vector<std::string> validation;  ///< records that are never fitted
  bool show_progress{false};
  bool refine{true};  ///< a spring that is not straight by the frame's own motion
};

/// Explains a truck's record. Throws RunError or UsageError; there is no partial result.
[[nodiscard]] Explained explain_truck(const Config& config, const ExplainOptions& options);

}  // namespace dampline::app
