// SPDX-License-Identifier: MIT
#pragma once
#include <string>
#include <vector>

#include "app/diagnosis/truck/explain.hpp"

namespace dampline::app {

/// An explanation as explanation.json holds it: valid JSON, a trailing newline.
[[nodiscard]] std::string to_json(const Explained& explained);

/// The same for a terminal: verdict, error before and after, each step with its parameters.
[[nodiscard]] std::string summarize(const Explained& explained);

/// The terms of a model: base and the first `steps` of an explanation.
[[nodiscard]] std::vector<std::string> terms_of(const effect::Explanation& explanation,
                                                std::size_t steps);

}  // namespace dampline::app
