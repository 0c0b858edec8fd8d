// SPDX-License-Identifier: MIT
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "app/run/faults.hpp"

namespace dampline::app {

/// The members "faults", "inputs", "repair", "alarms" and, where there is one, "time_drift" of
/// parameters.json.
void write_faults(const DataFaults& faults, nlohmann::ordered_json& json);
/// Throws nlohmann::json::exception where a member has not the shape that write_faults() gives it;
/// members that are missing leave the defaults.
[[nodiscard]] DataFaults read_faults(const nlohmann::ordered_json& json);

}  // namespace dampline::app
