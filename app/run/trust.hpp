// SPDX-License-Identifier: MIT
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "app/run/result.hpp"
#include "dampline/snapshot.hpp"

namespace dampline::app {

/// As parameters.json, explanation.json and the terminal call it.
[[nodiscard]] const char* name_of(Trust trust) noexcept;
/// The value of that name; not_identified where there is none.
[[nodiscard]] Trust trust_of(const std::string& name) noexcept;

/// What an explanation knows of the model, beside what the numbers themselves tell.
struct Explaining {
  bool judged{false};      ///< what a complete model would leave is known
  bool incomplete{false};  ///< something real is left
  bool withheld{false};    ///< faults of the data forbid to name an effect
  bool impossible{false};  ///< friction or spring come out negative: no law of a truck
  bool unsteady{false};    ///< a parameter changed beside what explains
  /// By which share a truck's frame sensor tells too much.
  std::optional<Estimate> frame_gain{};
};

/// Of the wheelsets, rms: a running car shakes more, in g it seems to shake less.
inline constexpr double kLeastShakingMps2 = 0.7;
/// Nmse (rrse 0.3) that neither a rig's model nor what errors of its motion make may leave.
inline constexpr double kRigMisfit = 0.09;

/// The one rule, for trucks and rigs, files and live runs: sets trust and its reasons, the gravest
/// first, whether deviations are lower bounds, and the headline, which states numbers only where
/// they are trusted. Without an explanation (null) the fit alone is judged.
void judge_trust(const Explaining* explaining, RunResult& result);

}  // namespace dampline::app
