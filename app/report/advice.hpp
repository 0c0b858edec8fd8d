// SPDX-License-Identifier: MIT
#pragma once
#include <span>
#include <string>
#include <string_view>

#include "app/run/result.hpp"

namespace dampline::app {

/// What a finding means and where a fitter looks, in a fitter's words.
struct Advice {
  std::string_view name;   ///< of the fault or the effect, as in the files of a run
  std::string_view title;  ///< begins a line
  std::string_view truck;  ///< what to check on the car
  std::string_view rig;    ///< on a rig; empty: cannot be found there
};

/// Of every fault, in the order of FaultKind, then those of a rig's record.
[[nodiscard]] std::span<const Advice> fault_advice() noexcept;
/// Of every effect that a model may be said to lack.
[[nodiscard]] std::span<const Advice> effect_advice() noexcept;

/// What to check for all that was found, as HTML: faults first, then effects with their size, then
/// what changed over the record. Says so where nothing was found, and where nobody looked.
[[nodiscard]] std::string advice_section(const RunResult& result);

}  // namespace dampline::app
