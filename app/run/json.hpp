// SPDX-License-Identifier: MIT
#pragma once
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "app/run/result.hpp"

namespace dampline::app {

/// As every JSON file of a run is written: two blanks a level, a trailing newline. A number that is
/// not finite becomes null.
[[nodiscard]] std::string json_text(const nlohmann::ordered_json& json);

/// {"name", "value", "std", "unit"}, as parameters stand in all of them.
[[nodiscard]] nlohmann::ordered_json parameter_json(std::string_view name, const Estimate& estimate,
                                                    std::string_view unit);

/// parameters.json: everything of a result but its tables.
[[nodiscard]] std::string to_json(const RunResult& result);
/// The inverse. Throws RunError naming `origin` and the field that is missing or of a wrong kind.
[[nodiscard]] RunResult from_json(std::string_view text, const std::string& origin);

/// phase.json, on one line: the three planes of (y, y', y'') with their occupied cells
/// [i, j, density], the period that was found, and the section points of every phase. SI units;
/// densities to five digits.
[[nodiscard]] std::string to_json(const PhaseSnapshot& phase);
/// Throws RunError naming `origin` when the text is not what to_json() writes.
[[nodiscard]] std::shared_ptr<const PhaseSnapshot> read_phase(std::string_view text,
                                                              const std::string& origin);

}  // namespace dampline::app
