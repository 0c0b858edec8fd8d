// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "dampline/effect/explainer.hpp"
#include "dampline/faults.hpp"
#include "dampline/guard/parameter_drift.hpp"

namespace dampline::effect {

/// What is known of a record beside its sums, and what that forbids to say.
struct Circumstances {
  FaultView faults;
  ParameterDrift drift;
};

/// What faults do to the parameters is no change of theirs: hold_against_faults().
[[nodiscard]] Circumstances circumstances_of(const FaultView& faults,
                                             const ParameterDrift& drift) noexcept;

/// An explanation that faults of the data and parameters that changed have been held against.
struct Judgement {
  Explanation explanation;
  bool withheld{false};  ///< faults of the data forbid to name an effect
  bool drifts{false};    ///< a parameter that changed explains more than any effect
};

/// Whether a fault that the guards found makes the naming of an effect worthless. Samples that all
/// channels lost or repeated, a stuck channel (left out) and a wrong rate do not; nor do spikes, a
/// jump of the zero and a burst of noise where they were replaced or left out.
[[nodiscard]] bool forbids_naming(const FaultView& faults) noexcept;

/// Takes from the candidates what the faults can look like although most of them was left out:
/// impulses that nobody measured.
void disallow_mimics(const FaultView& faults, ExplainerConfig& config) noexcept;

/// Whether a parameter that changed explains more than the first effect does, by 2 % of the
/// held-out error.
[[nodiscard]] bool drift_explains_more(const ParameterDrift& drift,
                                       const Explanation& explanation) noexcept;

/// Takes back the effects that were added: what is left is unexplained.
void withhold_effects(Explanation& explanation) noexcept;

/// Where friction or spring come out negative with the effects, these are no finding.
void name_nothing_impossible(Explanation& explanation) noexcept;

/// Judges a record's sums: of a file, and of a live run at any moment. Where the circumstances
/// forbid it no effect is named, and what is left is unexplained. Mimics leave the candidates.
void judge(const Sums& sums, ExplainerConfig config, const Circumstances& circumstances,
           Explainer& explainer, Judgement& out) noexcept;

}  // namespace dampline::effect
