// SPDX-License-Identifier: MIT
#pragma once
#include <span>

#include "app/run/faults.hpp"
#include "dampline/effect/conclusion.hpp"
#include "dampline/effect/explainer.hpp"
#include "dampline/faults.hpp"

namespace dampline::app {

/// Whether a fault that the guards found makes the naming of an effect worthless. Samples that all
/// channels lost or repeated, a stuck channel (left out) and a wrong rate do not; nor do spikes, a
/// jump of the zero and a burst of noise where they were replaced or left out.
[[nodiscard]] bool forbids_naming(const DataFaults& faults) noexcept;

/// The same of the guards' own list while a run goes on, without the heap; what passes forbids,
/// too, since it is not known yet how much of it will be left out.
[[nodiscard]] bool faults_forbid_naming(std::span<const Fault> faults) noexcept;

/// Takes from the candidates what the faults can look like although most of them was left out:
/// impulses that nobody measured.
void disallow_mimics(const DataFaults& faults, effect::ExplainerConfig& config) noexcept;

/// Whether a parameter that changed explains more than the first effect does, by 2 % of the
/// held-out error.
[[nodiscard]] bool drift_explains_more(const DataFaults& faults,
                                       const effect::Explanation& explanation) noexcept;

/// Takes back the effects that were added: what is left is unexplained.
void withhold_effects(effect::Explanation& explanation) noexcept;

}  // namespace dampline::app
