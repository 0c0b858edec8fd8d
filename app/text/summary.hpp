// SPDX-License-Identifier: MIT
#pragma once
#include <string>

#include "app/run/result.hpp"

namespace dampline::app {

/// A result as a short table for a terminal: parameters with deviation and unit, the fit, what was
/// left out.
[[nodiscard]] std::string summarize(const RunResult& result);

}  // namespace dampline::app
