// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "dampline/phase/view.hpp"

namespace dampline::app {

/// phase.json: the three planes of (y, y', y'') with their occupied cells [i, j, density], the
/// period that was found, and the section points of every phase. SI units; densities to five
/// digits.
[[nodiscard]] std::string to_json(const PhaseSnapshot& phase);

/// Throws RunError naming `origin` when the text is not what to_json() writes.
[[nodiscard]] std::shared_ptr<const PhaseSnapshot> read_phase(std::string_view text,
                                                              const std::string& origin);

}  // namespace dampline::app
