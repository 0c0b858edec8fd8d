// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/diagnosis/common/explanation.hpp"
#include "app/diagnosis/truck/explain.hpp"

namespace dampline::app {

/// Puts the final law and the explanation into what identify says of the record, and judges both.
/// Base and final law are as identify states them where nothing was added.
Explanation conclude(const Explained& explained, RunResult& result);

/// Judged, as conclude() does.
[[nodiscard]] Explanation told(const Explained& explained);

[[nodiscard]] inline std::string to_json(const Explained& e) { return to_json(told(e)); }
[[nodiscard]] inline std::string summarize(const Explained& e) { return summarize(told(e)); }

}  // namespace dampline::app
